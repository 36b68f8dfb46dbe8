"""Columns of the comparison: one list for a finding serves CSV, Parquet and page."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from markupsafe import Markup, escape

from study.analysis.formatting import DASH, percent
from study.analysis.tables import Record, Value
from study.comparison.statistics import Interval
from study.runs.selections import YARDSTICKS

FLAG = "⚑"
Cell = str | Markup
Row = TypeVar("Row")


@dataclass(frozen=True)
class Grid:
    """A table of a page: caption, heads and rows; the first `names` columns hold names, the others numbers."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    names: int = 1


@dataclass(frozen=True)
class Column(Generic[Row]):
    """A column of a table of findings.

    Attributes
    ----------
    key : str
        Name in the files; empty for a column of the page alone.
    head : str
        Name on the page; empty for a column of the files alone.
    value : callable (row) -> value
    text : callable (value) -> str
        Form of the value on the page.
    """

    key: str
    head: str
    value: Callable[[Row], Any]
    text: Callable[[Any], Cell] = str

    def fields(self, row: Row, flags: Mapping[str, str]) -> Record:
        """Entries of a row in the files."""
        return {self.key: bare(self.value(row))}

    def cell(self, row: Row, flags: Mapping[str, str]) -> Cell:
        """Entry of a row on the page."""
        return self.text(self.value(row))


class PlannerColumn(Column[Row]):
    """A column of planners, each with its flag."""

    def fields(self, row: Row, flags: Mapping[str, str]) -> Record:
        """Name of the planner and reason of its flag."""
        name = self.value(row)
        return {self.key: name, "flag": flags.get(name, "")}

    def cell(self, row: Row, flags: Mapping[str, str]) -> Cell:
        """Name of the planner with its marks."""
        return name_of(self.value(row), flags)


class IntervalColumn(Column[Row]):
    """A column of intervals: three columns in the files, one on the page."""

    def fields(self, row: Row, flags: Mapping[str, str]) -> Record:
        """Estimate and both ends."""
        interval: Interval | None = self.value(row)
        ends = (interval.estimate, interval.lower, interval.upper) if interval else (None, None, None)
        return dict(zip((self.key, f"{self.key}_low", f"{self.key}_high"), map(bare, ends), strict=True))


def records(columns: Sequence[Column[Row]], rows: Iterable[Row], flags: Mapping[str, str]) -> list[Record]:
    """Rows as they stand in the files; a number that is not finite is left empty."""
    kept = [column for column in columns if column.key]
    return [{key: value for column in kept for key, value in column.fields(row, flags).items()} for row in rows]


def grid(
    caption: str, columns: Sequence[Column[Row]], rows: Iterable[Row], flags: Mapping[str, str], names: int = 1
) -> Grid:
    """Rows as they stand on the page."""
    shown = [column for column in columns if column.head]
    cells = [[column.cell(row, flags) for column in shown] for row in rows]
    return Grid(caption, [column.head for column in shown], cells, names)


def bare(value: Any) -> Value:
    """Plain Python value for the files."""
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, bool | np.bool_):
        return bool(value)
    return str(value) if isinstance(value, str) else value


def name_of(planner: str, flags: Mapping[str, str]) -> Cell:
    """Name of a planner; flagged with its reason where the audit found one, and marked where it is a trivial opponent."""
    mark = Markup(' <abbr title="{}">{}</abbr>').format(flags[planner], FLAG) if planner in flags else Markup("")
    note = Markup(' <span class="note">trivial</span>') if planner in YARDSTICKS else Markup("")
    return escape(planner) + mark + note


def p_value(p: float) -> str:
    """Write a p-value as people read it."""
    return f"{p:.2g}" if p >= 1e-4 else "below 0.0001"


def probability(a12: float) -> str:
    """Write an effect size A12."""
    return f"{a12:.2f}"


def interval_text(interval: Interval | None) -> str:
    """Write an interval of shares in percent."""
    if interval is None:
        return DASH
    return f"{percent(interval.estimate)} ({percent(interval.lower)} to {percent(interval.upper)})"
