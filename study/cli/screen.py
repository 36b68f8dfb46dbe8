"""Text on the screen: names are other people's own, so nothing in them may steer the terminal."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

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


def make_console() -> Console:
    """Build the console: as wide as the terminal, or wide enough for all tables where there is none.

    Square brackets and colons in names of joints and cases mean nothing special.
    """
    plain: dict[str, Any] = {"markup": False, "emoji": False}
    console = SafeConsole(**plain)
    return console if console.is_terminal else SafeConsole(width=180, **plain)


def complain(sentence: object) -> None:
    """Say one sentence on standard error; of a very long one both ends."""
    text = clean(str(sentence))
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
    print(f"study: {text}", file=sys.stderr)
