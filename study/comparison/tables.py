"""Columns of the comparison's own kinds, planners and intervals, and its number formats."""

from __future__ import annotations

from collections.abc import Mapping

from markupsafe import Markup, escape

from study.analysis.formatting import DASH, percent
from study.analysis.tables import Cell, Column, Record, Row, bare
from study.comparison.statistics import Interval
from study.runs.selections import YARDSTICKS

FLAG = "⚑"


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
