"""Command `study bench`: speed of the parts next to other packages, as ratios."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from study.bench import wording
from study.bench.measuring import Limit, Ratio
from study.bench.parts import PARTS, measured
from study.bench.run import measure, write
from study.cli.screen import fitted, make_console
from study.cli.shared import DEFAULT_OUT


def bench(
    quick: Annotated[bool, typer.Option("--quick", help="Fewer repetitions; about two minutes.")] = False,
    out: Annotated[Path, typer.Option(metavar="FILE", help="JSON file for the measurements.")] = DEFAULT_OUT
    / "bench.json",
    part: Annotated[str | None, typer.Option(help=f"Measure the planner alone: {', '.join(PARTS)}.")] = None,
    seed: Annotated[int, typer.Option(help="Of the problems of a part.")] = 0,
) -> None:
    """Measure kernels, searches and planners next to other packages, and write the report's performance page.

    Peers come with the extra `peers`, the compiled kernels with `fast`; what is not installed is said to be missing.
    """
    console = make_console()
    if part is not None:
        return _print_part(part, seed, console)
    with console.status("measuring") as status:
        bench = measure(quick, lambda part: status.update(f"measuring: {part}"))
    for topic, rows in wording.topics(bench.rows):
        console.print(_table(topic, rows))
    for sentence in wording.summary(bench):
        console.print(sentence)
    write(bench, out)
    from study.bench.page import write_page  # here: matplotlib is slow to import

    console.print(f"measurements: {out}")
    console.print(f"page: {write_page(out, out.parent / 'report')}")


def _print_part(name: str, seed: int, console: Console) -> None:
    with console.status("measuring") as status:
        part = measured(name, seed, lambda problem: status.update(f"measuring: {problem}"))
    console.print(fitted(console, part.title, part.head, part.rows, left=part.head[:1], wraps=part.head[:1]))
    for sentence in part.sentences:
        console.print(sentence)


def _table(topic: str, rows: list[Ratio | Limit]) -> Table:
    table = Table(title=topic, title_justify="left", header_style="bold")
    for text in wording.HEAD:
        table.add_column(text, justify="right" if text in ("ours", "times as fast") else "left")
    for row in rows:
        table.add_row(*wording.cells(row))
    return table
