"""The commands `study store ...`: look after the file of results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from study.cli.folder import DEFAULT_OUT, STORE_NAME
from study.cli.screen import make_console
from study.cli.shared import Out
from study.errors import StudyError, plural
from study.store import maintenance as storekeeping

store_app = typer.Typer(help="Look after the file of results.", no_args_is_help=True, add_completion=False)

Target = Annotated[Path, typer.Argument(metavar="FILE", help="Ends in .csv or .parquet.")]
Others = Annotated[list[Path], typer.Argument(metavar="OTHER", help="Results files, or folders that hold one.")]


@store_app.command()
def verify(out: Out = DEFAULT_OUT) -> None:
    """Read the whole file and compare every result with its checksums; ends with 2 if one is damaged."""
    count, damaged = storekeeping.verify(out / STORE_NAME)
    if damaged:
        raise StudyError(
            f"damaged in {out / STORE_NAME}: {len(damaged)} of {plural(count, 'result')}, the first is {damaged[0]}; "
            "run the study again with --fresh, or restore the file"
        )
    print(f"{plural(count, 'result')}, all as they were stored")


@store_app.command()
def export(target: Target, out: Out = DEFAULT_OUT) -> None:
    """Write one line per result, motions left out."""
    print(f"{plural(storekeeping.export_columns(out / STORE_NAME, target), 'result')} written to {target}")


@store_app.command()
def merge(others: Others, out: Out = DEFAULT_OUT) -> None:
    """Take the results of other files in, such as those of other machines; what is there already stays as it is."""
    for other in others:
        file = other / STORE_NAME if other.is_dir() else other
        merged = storekeeping.merge(out / STORE_NAME, file)
        print(
            f"{file}: {plural(merged.added, 'result')} added, {merged.known} known, {merged.contrary} contrary and left out"
        )


@store_app.command()
def compact(
    out: Out = DEFAULT_OUT,
    drop_stale: Annotated[
        bool,
        typer.Option("--drop-stale", help="Drop results of code that has changed since."),
    ] = False,
) -> None:
    """Rewrite the file without gaps."""
    dropped, won = storekeeping.compact(out / STORE_NAME, drop_stale=drop_stale)
    print(f"{plural(dropped, 'result')} dropped, {won:,} bytes won")


@store_app.command()
def summary(out: Out = DEFAULT_OUT) -> None:
    """Count and average per case and planner, however large the sweep."""
    table = Table(title_justify="left", header_style="bold")
    for name in ("case", "planner"):
        table.add_column(name)
    for name in ("results", "feasible", "cut short", "best, s", "mean, s", "wall time, s"):
        table.add_column(name, justify="right")
    for row in storekeeping.tallies(out / STORE_NAME):
        durations = ("-" if value is None else f"{value:.4f}" for value in (row.best, row.mean))
        counts = (f"{count:,}" for count in (row.count, row.feasible, row.cut_short))
        table.add_row(row.subject or f"all of kind {row.kind}", row.label, *counts, *durations, f"{row.wall_time:.1f}")
    make_console().print(table)
