"""`study bench`: how fast the parts are, next to other packages."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from study.cli.run import DEFAULT_OUT, make_console


def bench(
    quick: Annotated[bool, typer.Option("--quick", help="Fewer repetitions; about two minutes.")] = False,
    out: Annotated[Path, typer.Option(metavar="FILE", help="JSON file for the measurements.")] = DEFAULT_OUT
    / "bench.json",
) -> None:
    """Measure kernels, searches and planners next to other packages, and write the report's performance page.

    Peers come with the extra `peers`, the compiled kernels with `fast`; what is not installed is said to be missing.
    """
    from study.cli.bench_command import bench_command  # here: it loads what it measures

    bench_command(quick, out, out.parent / "report", make_console())


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(bench)
