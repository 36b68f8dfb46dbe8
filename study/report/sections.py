"""Sections of a page beside the report's own: texts, figures with their legend, and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from study.analysis.tables import Grid


@dataclass(frozen=True)
class Section:
    """One part of a page; the macro `shown` writes it.

    Attributes
    ----------
    title : str
    texts : sequence of str
    figures : sequence of Markup
    grids : sequence of Grid
    legend : sequence of (slot, name)
        Lines of the figures, for those that do not answer to the pointer.
    folded : bool
        Whether the tables are folded away at first.
    data : Markup, optional
        Element of data before the tables, for `report.js`.
    """

    title: str
    texts: Sequence[str] = ()
    figures: Sequence[Markup] = ()
    grids: Sequence[Grid] = ()
    legend: Sequence[tuple[int, str]] = ()
    folded: bool = False
    data: Markup | None = None
