"""Text on the screen: names are other people's own, so nothing in them may steer the terminal."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import Any, Literal

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderableType
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.segment import Segment
from rich.table import Column, Table
from rich.text import Text

from study.runs.job import Job

UNSAFE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters, marks that turn the direction of writing, and halves of characters."""

LONGEST = 1500
"""Characters of a sentence about an error that are shown."""


def clean(text: str) -> str:
    """Put a replacement character in the place of everything that is not plain text."""
    return UNSAFE.sub("\N{REPLACEMENT CHARACTER}", text)


class SafeConsole(Console):
    """A console that shows other people's texts without obeying them."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Render an object to pieces of text, each cleaned; the console's own control codes stay."""
        for segment in super().render(renderable, options):
            if segment.control or not UNSAFE.search(segment.text):
                yield segment
            else:
                yield Segment(clean(segment.text), segment.style)

    def print(self, *objects: Any, **options: Any) -> None:
        """Print; sentences break between words at the end of a line, or not at all where no width is set."""
        endless = self.endless and all(isinstance(thing, str) for thing in objects)
        super().print(*objects, **{"soft_wrap": endless, **options})

    @property
    def endless(self) -> bool:
        """Whether the output goes to a file or a program, for which nobody has set a width."""
        return not (self.is_terminal or os.environ.get("COLUMNS"))

    @contextmanager
    def paged(self) -> Iterator[None]:
        """Show what is printed meanwhile page by page, where it goes to a terminal and does not fit on it."""
        if not self.is_terminal:
            yield
            return
        with self.capture() as captured:
            yield
        text = captured.get()
        if text.count("\n") < self.height:
            self.file.write(text)
            return
        os.environ.setdefault("LESS", "FRX")  # colours, and no page where all fits
        with self.pager(styles=True):
            super().print(Text.from_ansi(text), soft_wrap=True)


def make_console() -> SafeConsole:
    """Build the console: as wide as the terminal or as COLUMNS says, or wide enough for all tables where neither is set.

    Square brackets and colons in names of joints and cases mean nothing special.
    """
    plain: dict[str, Any] = {"markup": False, "emoji": False, "highlight": False}
    console = SafeConsole(**plain)
    return SafeConsole(width=180, **plain) if console.endless else console


def fitted(
    console: Console,
    title: str,
    heads: Sequence[str],
    rows: Sequence[Sequence[str | Text]],
    left: Sequence[str] = (),
    wraps: Sequence[str] = (),
    gives_way: Sequence[str] = (),
    styles: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> Table:
    """Build a table that is no wider than the console, in which no number is cut.

    Parameters
    ----------
    console : Console
    title : str
    heads : sequence of str
        Names of the columns.
    rows : sequence of sequence of str or Text
    left, wraps : sequence of str
        Columns that stand on the left side, and those among them whose words may go on in the next line.
    gives_way : sequence of str
        Columns that are left out, one after the other, until the table fits; a line below names them.
    styles : sequence of str
        Of the rows; plain by default.
    notes : sequence of str
        Stand below the table.
    """
    heads, cells = [clean(name) for name in heads], [[_cleaned(cell) for cell in row] for row in rows]
    hidden = list[str]()
    for name in gives_way:
        if _least_width(heads, cells, wraps, hidden) <= console.width:
            break
        hidden.append(name)
    notes = [*notes, f"Not shown in {console.width} columns: {', '.join(hidden)}."] if hidden else notes
    table = Table(title=title, title_justify="left", header_style="bold", caption_justify="left", box=SIMPLE_HEAD)
    table.caption = "\n".join(notes) or None
    for name in heads:
        if name not in hidden:
            justify: Literal["left", "right"] = "left" if name in left or name in wraps else "right"
            table.add_column(_head(name), justify=justify, no_wrap=name not in wraps, overflow="fold")
    for row, style in zip(cells, styles or [""] * len(rows), strict=True):
        table.add_row(*(cell for name, cell in zip(heads, row, strict=True) if name not in hidden), style=style)
    return table


WORD = 14
"""Characters that a column whose words may wrap is given at least, if it needs them."""


def _cleaned(cell: str | Text) -> Text:
    """A cell as it will be shown, so that its width is known."""
    return Text(clean(cell)) if isinstance(cell, str) else Text(clean(cell.plain), cell.style)


def _head(name: str) -> str:
    """A heading with every long word on a line of its own."""
    return name.replace(" ", "\n") if len(name) > 9 else name


def _least_width(
    heads: Sequence[str], table: Sequence[Sequence[Text]], wraps: Sequence[str], hidden: Sequence[str]
) -> int:
    total = 1
    for index, name in enumerate(heads):
        if name not in hidden:
            cells = (Text(_head(name)), *(row[index] for row in table))
            width = max(line.cell_len for text in cells for line in text.split())
            total += 3 + (min(width, WORD) if name in wraps else width)
    return total


def progress_bar(console: Console) -> Progress:
    """Build the live display of a run; what is named gives way to figures."""
    named = Column(no_wrap=True, overflow="ellipsis", max_width=max(console.width - 42, 8))
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False, table_column=named),
        BarColumn(),
        MofNCompleteColumn(table_column=Column(no_wrap=True)),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=console,
        transient=False,
    )


def running(waiting: Collection[Job[Any]], at_once: int) -> str:
    """Name two of the jobs that run now and count the others: the first so many that wait, as they are taken in order."""
    names = [f"{job.subject}: {job.label}" for job in islice(waiting, min(at_once, 2))]
    more = min(at_once, len(waiting)) - len(names)
    return ", ".join(names) + (f" and {more} more" if more > 0 else "")


def complain(sentence: object) -> None:
    """Say one sentence on standard error; of a very long one both ends."""
    text = clean(str(sentence))
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
    print(f"study: {text}", file=sys.stderr)
