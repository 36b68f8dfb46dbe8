"""`study bench`: measure, print, write."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.table import Table

from study.bench import wording
from study.bench.measuring import Limit, Ratio
from study.bench.run import measure, write


def bench_command(quick: bool, out: Path, page: Path, console: Console) -> None:
    """Measure everything, print tables and sentences, write the JSON and from it the performance page.

    Raises
    ------
    StudyError
        If a file cannot be written.
    """
    with console.status("measuring") as status:
        bench = measure(quick, lambda part: status.update(f"measuring: {part}"))
    for topic, rows in wording.topics(bench.rows):
        console.print(_table(topic, rows))
    for sentence in wording.summary(bench):
        console.print(sentence, soft_wrap=True, highlight=False)
    write(bench, out)
    from study.bench.page import write_page  # here: matplotlib is slow to import

    console.print(f"measurements: {out}", soft_wrap=True)
    console.print(f"page: {write_page(out, page)}", soft_wrap=True)


def _table(topic: str, rows: list[Ratio | Limit]) -> Table:
    table = Table(title=topic, title_justify="left", header_style="bold")
    for text in wording.HEAD:
        table.add_column(text, justify="right" if text in ("ours", "times as fast") else "left")
    for row in rows:
        table.add_row(*wording.cells(row))
    return table
