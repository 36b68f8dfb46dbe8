"""Figures as data: marks in named rows, drawn by the figures' own file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Mark:
    """A mark in a row: place on the axis, marker of matplotlib, offset below the row's middle in rows, and its note."""

    row: str
    x: float
    shape: str
    filled: bool = True
    offset: float = 0.0
    note: str = ""


@dataclass(frozen=True)
class Marks:
    """A figure of marks in rows.

    Attributes
    ----------
    key : str
        Beginning of the identifiers in the page.
    title, description : str
        For readers who do not see the figure.
    label : str
        Of the horizontal axis, whose ends are `span` where they are given.
    line, edges : float, tuple of float
        Places of the solid and the dashed vertical lines.
    """

    key: str
    title: str
    description: str
    marks: Sequence[Mark]
    label: str
    line: float | None = None
    heading: str = ""
    edges: tuple[float, ...] = ()
    logarithmic: bool = False
    span: tuple[float, float] | None = None

    @property
    def rows(self) -> list[str]:
        """Names of the rows from the top."""
        return list(dict.fromkeys(mark.row for mark in self.marks))
