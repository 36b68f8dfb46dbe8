"""The commands `study suite ...`: look after the suites of problems and their records."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from study.cases.suite_file import suites_folder
from study.cases.suites import suite_named
from study.cli.folder import DEFAULT_OUT
from study.cli.shared import INFEASIBLE, Out
from study.errors import plural
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
    print(f"{plural(len(drawn.problems), 'problem')}, checksum {drawn.checksum}, written to {path}")


@suite_app.command()
def submit(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A trajectory in any format that `study check` judges.")],
    problem: Annotated[str, typer.Option(metavar="PROBLEM", help="SUITE:NAME of the problem that it solves.")],
    by: Annotated[str, typer.Option(metavar="NAME", help="Who found it, and how, in a few words.")],
    units: Annotated[str | None, typer.Option(help="As for `study check`.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Record to write; named after the problem by default.")
    ] = None,
) -> None:
    """Judge a trajectory against the best known one of its problem, and write a record to contribute; ends with 3 if it fails."""
    from study.cli.suite_run import submitted  # here: its measures are slow to import

    if not submitted(file, problem, by, units, out):
        raise typer.Exit(INFEASIBLE)


@suite_app.command()
def records(name: Name) -> None:
    """Print the best known times of a suite, who found them and what is proved, as a table in Markdown."""
    from study.suites.records import records_table  # here: its packages are slow to import

    print(records_table(suite_named(name)))


@suite_app.command()
def law(name: Annotated[str, typer.Argument(metavar="SUITE", help="A suite of growing problems.")] = "scaling") -> None:
    """Tell in numbers how methods fall behind as problems grow, from the committed runs."""
    from study.suites.law import committed_law  # here: its packages are slow to import

    print(committed_law(suite_named(name)))


@suite_app.command()
def results(name: Name) -> None:
    """Print the committed results of a suite as tables in Markdown: scores, the cost to come near, and effect sizes."""
    from study.suites.tables import results_in_markdown  # here: its packages are slow to import

    print(results_in_markdown(suite_named(name)))


@suite_app.command()
def export(
    name: Name,
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Where to write; made if need be.")],
    to: Annotated[
        str,
        typer.Option(metavar="PLATFORM", help="ioh: IOHprofiler's files; coco: a COCO archive; parquet: one table."),
    ],
    own: Annotated[
        Path | None,
        typer.Option(metavar="OUT", help="Output folder of your own run, in the place of the committed runs."),
    ] = None,
) -> None:
    """Write the runs of a suite as other benchmarking platforms read them."""
    from study.cli.suite_run import exported  # here: its measures are slow to import

    print(exported(name, to, folder, own))


@suite_app.command()
def keep(out: Out = DEFAULT_OUT) -> None:
    """Add the last run of a suite to the data: its runs to a Parquet file, and what is better than the records."""
    from study.cli.suite_run import kept_run  # here: its measures are slow to import

    for path, said in kept_run(out):
        print(f"{said}: {path}")
