"""Summary of every method on a case: one per method, ranked, nothing hidden; tables, pages and recordings show it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from study.planning import Freedom, Status, Synchronisation
from study.store.results import Result
from study.trajectory import Motion


class Kind(StrEnum):
    """Kind of method; a bound proves a time that no motion can undercut, and has no motion of its own."""

    SEARCH = "search"
    DETERMINISTIC = "deterministic"
    PUBLISHED = "published"
    BOUND = "bound"


class Standing(StrEnum):
    """Group in the results table."""

    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    INAPPLICABLE = "inapplicable"
    BOUND = "bound"
    UNJUDGED = "unjudged"


@dataclass(frozen=True, eq=False)
class MethodSummary:
    """All runs of one method on one case, and its place among the others.

    Attributes
    ----------
    case, label : str
    kind : Kind
    freedom : Freedom, optional
        Part of the motion that the method may change; None for a bound, and where that is not known.
    about : str
        One line that says how the method works; empty for a published motion and for a planner that is not installed.
    results : tuple of Result
        All runs, by seed; of a published motion its one judged run, or nothing where too little is printed to judge.
    joint : int, optional
        Counted from 0, where a published motion is of one joint alone; it stands last and takes no part in gaps.
    claimed : float, optional, s
        Total time as the paper prints it.
    remark : str
        Reason why a published motion could not be judged.
    rank : int, optional
        Place among the feasible methods; None for an infeasible one and for single joints.
    gap : float, optional
        Median over the shortest feasible duration known for the case, minus one.
    behind_same_kind : float, optional
        Median over the shortest feasible duration known for the same freedom, minus one.
    above_bound : float, optional
        Median over the proved lower bound of any motion through the waypoints, minus one.
    """

    case: str
    label: str
    kind: Kind
    freedom: Freedom | None
    about: str = ""
    results: tuple[Result, ...] = ()
    joint: int | None = None
    claimed: float | None = None
    remark: str = ""
    rank: int | None = None
    gap: float | None = None
    behind_same_kind: float | None = None
    above_bound: float | None = None

    @property
    def planner(self) -> str:
        """Registry name, or `published`."""
        return self.results[0].cell.planner if self.results else Kind.PUBLISHED

    @property
    def runs(self) -> int:
        """Number of runs, one for each seed."""
        return len(self.results) or 1

    @cached_property
    def _feasible(self) -> list[Result]:
        return sorted((run for run in self.results if run.feasible), key=lambda run: run.duration)

    @property
    def feasible_runs(self) -> int:
        """Number of runs that the judge passed."""
        return len(self._feasible)

    @property
    def feasible(self) -> bool:
        """True where a run was feasible."""
        return bool(self._feasible)

    @property
    def best(self) -> float | None:
        """Shortest duration of a feasible run, s."""
        return self._feasible[0].duration if self._feasible else None

    @cached_property
    def median(self) -> float | None:
        """Median duration of the feasible runs, s."""
        return float(np.median([run.duration for run in self._feasible])) if self._feasible else None

    @cached_property
    def representative(self) -> Result | None:
        """The median feasible run, or else the one that breaks the limits least; None where nothing was judged."""
        if self._feasible:
            return self._feasible[(len(self._feasible) - 1) // 2]
        return min(self.results, key=_violation, default=None)

    def durations_of(self, half: int) -> list[float]:
        """Durations of the feasible runs with even seeds (0) or odd ones (1), s."""
        return [run.duration for run in self._feasible if run.cell.settings.seed % 2 == half]

    @property
    def motion(self) -> Motion | None:
        """Motion of the representative run."""
        return self.representative.motion if self.representative else None

    @property
    def judged_duration(self) -> float | None:
        """Median of the feasible runs, else the duration of the representative motion, s."""
        verdict = self.representative.verdict if self.representative else None
        return self.median if self.median is not None else verdict.duration if verdict else None

    @property
    def duration(self) -> float | None:
        """Duration to show, s: the judged one, else what the paper prints."""
        return self.claimed if self.judged_duration is None else self.judged_duration

    @cached_property
    def worst_ratio(self) -> float | None:
        """Largest ratio of a peak to its limit over the feasible runs, or over all where none is feasible."""
        judged = self._feasible or self.results
        return max((run.verdict.worst_ratio for run in judged if run.verdict), default=None)

    @cached_property
    def evaluations(self) -> int:
        """Curve evaluations of a run, median over the runs."""
        return round(float(np.median([run.evaluations for run in self.results]))) if self.results else 0

    @cached_property
    def wall_time(self) -> float:
        """Computing time of a run, median over the runs, s."""
        return float(np.median([run.wall_time for run in self.results])) if self.results else 0.0

    @cached_property
    def reason(self) -> str:
        """Most common reason why runs are infeasible; empty where all are feasible."""
        infeasible = sorted((run for run in self.results if not run.feasible), key=_violation)
        if not infeasible:
            return self.remark
        sentences = [r.verdict.reasons[0] if r.verdict else r.message or r.status.value for r in infeasible]
        share = f"{len(infeasible)} of {self.runs} runs: " if self.runs > 1 else ""
        return share + Counter(sentences).most_common(1)[0][0]

    @property
    def bound(self) -> float | None:
        """Proved lower bound of this method's kind of motion, or of any motion where it is a bound, s."""
        shared = [run for run in self.results if run.cell.settings.synchronisation is Synchronisation.SHARED]
        return max((run.lower_bound for run in shared if run.lower_bound is not None), default=None)

    @property
    def standing(self) -> Standing:
        """Group in the results table."""
        if self.representative is None:
            return Standing.UNJUDGED
        if self.kind is Kind.BOUND:
            return Standing.BOUND
        if self.representative.status is Status.NOT_APPLICABLE:
            return Standing.INAPPLICABLE
        return Standing.FEASIBLE if self.feasible else Standing.INFEASIBLE


def lower_bound(methods: Iterable[MethodSummary], freedom: Freedom | None = None) -> float | None:
    """Highest proved lower bound, s: of any motion through the waypoints, or of motions of one freedom.

    A bound on any motion holds for one freedom too; a freedom of which nothing else is proved has no bound of its own.
    """
    methods = tuple(methods)
    known = [method.bound for method in methods if method.freedom is freedom]
    own = max((bound for bound in known if bound is not None), default=None)
    return own if own is None or freedom is None else max(own, lower_bound(methods) or 0.0)


def known_times(methods: Sequence[MethodSummary]) -> list[tuple[str, float, str]]:
    """Best feasible times and proved bounds of a case, freedom by freedom: description, seconds, method."""
    facts = []
    for freedom in Freedom:
        ranked = [method for method in methods if method.rank is not None and method.freedom is freedom and method.best]
        times = [(float(f"{method.best:.6g}"), method.kind is Kind.SEARCH, method.label) for method in ranked]
        if times:  # of those alike to six digits one that has no luck of the seed
            facts.append((f"best known, {freedom}", min(method.best or 0.0 for method in ranked), min(times)[2]))
        if (bound := lower_bound(methods, freedom)) is not None:
            facts.append((f"proved lower bound, {freedom}", bound, ""))
    if (bound := lower_bound(methods)) is not None:
        facts.append(("proved lower bound, any motion", bound, ""))
    return facts


def names_explained(methods: Iterable[MethodSummary]) -> dict[str, str]:
    """Lines with which the planners describe themselves, by name."""
    return dict(sorted((method.planner, method.about) for method in methods if method.about))


def _violation(result: Result) -> float:
    return result.verdict.violation if result.verdict else np.inf
