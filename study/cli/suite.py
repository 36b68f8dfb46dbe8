"""The commands `study suite ...`: look after the suites of problems and their records."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from study.cases.suite_file import suites_folder
from study.cli.shared import DEFAULT_OUT, Out
from study.files import write_file

suite_app = typer.Typer(
    help="Look after the suites of problems and their records.", no_args_is_help=True, add_completion=False
)

Name = Annotated[str, typer.Argument(metavar="SUITE", help="Its name, as `study list --suites` prints it.")]


@suite_app.callback()
def suite() -> None:
    """Look after the suites of problems and their records."""


@suite_app.command()
def make(
    name: Name,
    seed: Annotated[int | None, typer.Option(help="Of the generators; the suite's own by default.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="File to write; the committed one by default.")
    ] = None,
) -> None:
    """Draw a suite anew and write its file."""
    from study.suites import make as making  # here: the generators are slow to import

    drawn = making.make(name, seed)
    path = write_file(out or suites_folder() / f"{name}.json", making.text_of(drawn))
    print(f"{len(drawn.problems)} problems, checksum {drawn.checksum}, written to {path}")


@suite_app.command()
def keep(out: Out = DEFAULT_OUT) -> None:
    """Take the last run of a suite into the data: its runs as a Parquet file, and what is better than the records."""
    from study.cli.suite_run import kept_run  # here: its measures are slow to import

    for path, said in kept_run(out):
        print(f"{said}: {path}")
