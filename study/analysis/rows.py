"""What the report knows of every method on a case: its summary row, its place and the freedom it took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np

from study.analysis.methods import CURVE, FREE_PATH, Row, case_rows
from study.cases.library import Case
from study.curves import CURVES
from study.errors import StudyError
from study.planning import Freedom, Status
from study.problem import Problem
from study.store.results import Result
from study.trajectory import Motion

BOUND = "lower_bound"
"""Key of `Result.details` under which a planner proves how short a motion of its own kind can be at best, s; one that
has no motion to show speaks of any motion through the waypoints."""

MEANING = {freedom: freedom.meaning for freedom in Freedom}


@dataclass(frozen=True, eq=False)
class Entry:
    """One row of a case's table and what stands behind it.

    Attributes
    ----------
    row : Row
    path : str
        A key of `MEANING`, or empty where there is no motion.
    rank : int, optional
        Place among the feasible methods; None for an infeasible one and for single joints.
    gap : float, optional
        Median over the shortest feasible time known for the same kind of path, minus one.
    results : tuple of Result
        All runs, by seed; empty for a published row.
    gap_to_bound : float, optional
        Median over the proved lower bound of any motion through the waypoints, minus one.
    """

    row: Row
    path: str
    rank: int | None
    gap: float | None
    results: tuple[Result, ...]
    gap_to_bound: float | None = None

    @property
    def label(self) -> str:
        """Name in tables."""
        return self.row.label

    @property
    def planner(self) -> str:
        """Registry name, or `published`."""
        return self.row.representative.cell.planner if self.row.representative else "published"

    @property
    def motion(self) -> Motion | None:
        """Motion of the representative run."""
        return self.row.representative.motion if self.row.representative else None

    @property
    def bound(self) -> float | None:
        """Proved lower bound of this method's kind of motion, s."""
        shared = [one for one in self.results if one.cell.settings.synchronisation == "shared"]
        return max((one.details[BOUND] for one in shared if BOUND in one.details), default=None)

    @property
    def standing(self) -> str:
        """Group in the results table: feasible, infeasible, inapplicable, bound or unjudged."""
        if self.row.representative is None:
            return "unjudged"
        if self.motion is None and self.bound is not None:
            return "bound"
        if self.row.representative.status is Status.NOT_APPLICABLE:
            return "inapplicable"
        return "feasible" if self.row.feasible else "infeasible"

    @property
    def duration(self) -> float | None:
        """Duration to show, s: the feasible median, or that of an infeasible motion, or what the paper prints."""
        return self.row.claimed if self.row.duration is None else self.row.duration


def entries_of(case: Case, results: Sequence[Result]) -> tuple[Entry, ...]:
    """Give every summary row of a case its place, its freedom and its runs.

    Parameters
    ----------
    case : Case
    results : sequence of Result
        Those of other cases are passed over.
    """
    own = sorted((one for one in results if one.cell.case == case.name), key=lambda one: one.cell.settings.seed)
    rows = [(row, path_of(case, row)) for row in case_rows(case, own)]
    shortest: dict[str, float] = {}
    for row, path in rows:
        if row.best is not None and row.joint is None:
            shortest[path] = min(row.best, shortest.get(path, row.best))
    places = count(1)
    entries = tuple(
        Entry(
            row,
            path,
            rank=next(places) if row.feasible and row.joint is None else None,
            gap=row.median / shortest[path] - 1.0 if row.median is not None and row.joint is None else None,
            results=tuple(one for one in own if one.cell.label == row.label),
        )
        for row, path in rows
    )
    bound = lower_bound(entries)
    if bound is None:
        return entries
    return tuple(
        replace(one, gap_to_bound=one.row.median / bound - 1.0) if one.gap is not None and one.row.median else one
        for one in entries
    )


def lower_bound(entries: Sequence[Entry], path: str = "") -> float | None:
    """Highest proved lower bound, s: of any motion through the waypoints, or of motions of one kind of path.

    What holds for any motion holds for one kind too; a kind of which nothing else is proved has no bound of its own.
    """
    known = [one.bound for one in entries if one.path == path and (path or one.motion is None)]
    own = max((bound for bound in known if bound is not None), default=None)
    return own if own is None or not path else max(own, lower_bound(entries) or 0.0)


def known_times(entries: Sequence[Entry]) -> list[tuple[str, float, str]]:
    """Best feasible times and proved bounds of a case, path by path: what, seconds, by which method."""
    facts = []
    for path in MEANING:
        ranked = [entry for entry in entries if entry.rank is not None and entry.path == path and entry.row.best]
        times = [(float(f"{one.row.best:.6g}"), one.row.kind == "search", one.label) for one in ranked]
        if times:  # of those alike to six digits one that has no luck of the seed
            facts.append((f"best known, {path}", min(one.row.best or 0.0 for one in ranked), min(times)[2]))
        if (bound := lower_bound(entries, path)) is not None:
            facts.append((f"proved lower bound, {path}", bound, ""))
    if (bound := lower_bound(entries)) is not None:
        facts.append(("proved lower bound, any motion", bound, ""))
    return facts


def path_of(case: Case, row: Row) -> str:
    """Tell what a method was free to change; where the summary does not know, the motion itself is looked at."""
    motion = row.representative.motion if row.representative else None
    if row.representative and motion is None and BOUND in row.representative.details:
        return ""
    if row.path or motion is None:
        return row.path
    return CURVE if on_curve(case.problem, case.curve, motion) else FREE_PATH


def on_curve(problem: Problem, curve: str, motion: Motion) -> bool:
    """Rebuild the curve from the motion's own segment durations and compare the two."""
    try:
        rebuilt = CURVES[curve].motion(problem.waypoints, np.diff(motion.waypoint_times))
    except StudyError:
        return False
    times = np.linspace(0.0, motion.duration, 101)
    scale = max(float(np.ptp(problem.waypoints)), 1e-9)
    return bool(np.abs(rebuilt(times) - motion(times)).max() <= 1e-6 * scale)
