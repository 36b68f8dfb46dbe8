"""Figures as data: marks in named rows, drawn by the figures' own file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Mark:
    """A point of a row.

    Attributes
    ----------
    row : str
    x : float
    shape : str
        Marker of matplotlib.
    filled : bool
    offset : float
        Place below the middle of the row, in rows.
    """

    row: str
    x: float
    shape: str
    filled: bool = True
    offset: float = 0.0


@dataclass(frozen=True)
class Marks:
    """A figure of marks in rows.

    Attributes
    ----------
    key : str
        Beginning of the identifiers in the page.
    title, description : str
        For readers who do not see the figure.
    marks : sequence of Mark
    label : str
        Of the horizontal axis.
    heading : str
    line : float, optional
        Place of the bold vertical line.
    edges : tuple of float
        Places of the thin vertical lines.
    logarithmic : bool
    span : tuple of float, optional
        Ends of the horizontal axis.
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
