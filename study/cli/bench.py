"""Command `study bench`: speed of the parts next to other packages, as ratios."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from study.bench import wording
from study.bench.parts import PARTS, measured
from study.bench.run import measure, write
from study.cli.folder import DEFAULT_OUT, audit_flags, write_pages
from study.cli.screen import fitted, make_console
from study.errors import StudyError


def bench(
    quick: Annotated[bool, typer.Option("--quick", help="Fewer repetitions; about two minutes.")] = False,
    out: Annotated[Path, typer.Option(metavar="FILE", help="JSON file for the measurements.")] = DEFAULT_OUT
    / "bench.json",
    part: Annotated[str | None, typer.Option(help=f"Measure the planner alone: {', '.join(PARTS)}.")] = None,
    seed: Annotated[int, typer.Option(help="Of the problems of a part.")] = 0,
    page: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Write the page of the part `torque` there.")
    ] = None,
) -> None:
    """Measure kernels, searches and planners next to other packages, and write the report's performance page.

    Peers come with the extra `peers`, the compiled kernels with `fast`; what is not installed is said to be missing.
    """
    console = make_console()
    if page is not None:
        return _write_torques(part, page, console)
    if part is not None:
        return _print_part(part, seed, console)
    with telling(console) as told:
        bench = measure(quick, told)
    for topic, rows in wording.topics(bench.rows):
        left = [head for head in wording.HEAD if head not in ("ours", "times as fast")]
        console.print(fitted(console, topic, wording.HEAD, [*map(wording.cells, rows)], left=left, wraps=left))
    for sentence in wording.summary(bench):
        console.print(sentence)
    write(bench, out)
    from study.bench.page import write_page  # here: matplotlib is slow to import

    console.print(f"measurements: {out}")
    page = write_page(out, out.parent / "report")
    write_pages(out.parent, audit_flags(out.parent))
    console.print(f"page: {page}")


@contextmanager
def telling(console: Console) -> Iterator[Callable[[str], None]]:
    """Give who is told what is about to be measured: a line that changes on a terminal, else lines on standard error."""
    with console.status("measuring") as status:

        def told(part: str) -> None:
            status.update(f"measuring: {part}")
            if not console.is_terminal:
                print(f"measuring: {part}", file=sys.stderr, flush=True)

        yield told


def _write_torques(part: str | None, folder: Path, console: Console) -> None:
    if part != "torque":
        raise StudyError("only the part 'torque' has a page of its own; write --part torque --page FOLDER")
    from study.bench.torque import loaded, write_page  # here: matplotlib is slow to import

    with telling(console) as told:
        rows = list(loaded(told))
    for path in write_page(rows, folder):
        console.print(f"written: {path}")


def _print_part(name: str, seed: int, console: Console) -> None:
    with telling(console) as told:
        part = measured(name, seed, told)
    console.print(fitted(console, part.title, part.head, part.rows, left=part.head[:1], wraps=part.head[:1]))
    for sentence in part.sentences:
        console.print(sentence)
