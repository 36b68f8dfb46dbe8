"""Summary of a case, computed once per run and handed to terminal, report, recording and README."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import count, groupby

import numpy as np

from study.analysis.featured import Featured, featured
from study.analysis.ladder import Rung, ladder_of
from study.analysis.methods import Kind, MethodSummary, lower_bound
from study.analysis.palette import method_slots
from study.analysis.published import published_methods
from study.analysis.sentences import answer
from study.bounds import Method, is_stochastic
from study.cases.library import Case
from study.cases.obstacles import DRIVEN, driving
from study.cases.papers import paper_of
from study.curves import CURVES
from study.errors import StudyError
from study.planning import Freedom
from study.problem import Problem
from study.registry import method_named
from study.store.results import Result
from study.trajectory import Motion

CONVERGING = 6
"""Searches in the figure of convergence."""


@dataclass(frozen=True, eq=False)
class CaseSummary:
    """A case and all that is known of its methods.

    Attributes
    ----------
    case : Case
    methods : tuple of MethodSummary
        Feasible ones by median duration, then the infeasible ones, then single joints.
    """

    case: Case
    methods: tuple[MethodSummary, ...]

    @property
    def whole(self) -> tuple[MethodSummary, ...]:
        """Methods that move the whole arm, without what a paper prints of single joints."""
        return tuple(method for method in self.methods if method.joint is None)

    @property
    def ran(self) -> bool:
        """True once a planner has run on the case; a stopped run may not have come to it."""
        return any(method.kind is not Kind.PUBLISHED for method in self.methods)

    @cached_property
    def best(self) -> Featured:
        """Best method of every role."""
        own = self.case.planner if paper_of(self.case.paper) else ""
        return featured(self.methods, self.case.velocity_only, own)

    @cached_property
    def driving(self) -> dict[str, str]:
        """Label of every method with a judged motion: whether that motion may be driven, see `study.cases.obstacles`."""
        runs = {method.label: method.representative for method in self.whole}
        return {
            label: driving(self.case, run.motion, run.verdict)
            for label, run in runs.items()
            if run is not None and run.motion is not None and run.verdict is not None
        }

    def clear(self, method: MethodSummary) -> bool:
        """Whether nothing speaks against driving the method's motion but what its feasibility says."""
        return not (method.feasible and self.driving.get(method.label, "").startswith(DRIVEN[False]))

    @cached_property
    def winner(self) -> MethodSummary | None:
        """Fastest method whose motion may be driven; None where there is none."""
        return next((method for method in self.whole if method.feasible and self.clear(method)), None)

    @cached_property
    def converging(self) -> tuple[MethodSummary, ...]:
        """Searches whose convergence is worth showing: the paper's own method and the best others, all with a history."""
        searches = [
            method
            for method in self.methods
            if method.kind is Kind.SEARCH
            and method.freedom is Freedom.CURVE
            and all(len(run.history) for run in method.results)
        ]
        return tuple(sorted(searches, key=lambda method: method.label != self.case.planner)[:CONVERGING])

    @cached_property
    def slots(self) -> dict[str, int]:
        """Colour of every method, see `study.analysis.palette`; those that figures show differ from one another."""
        shown = [method.label for _, _, method in self.best.present()] + [method.label for method in self.converging]
        shown += [name for rung in self.rungs for name in rung.method.split(", ")]
        return method_slots((method.label for method in self.whole), shown)

    @cached_property
    def rungs(self) -> tuple[Rung, ...]:
        """The ladder of lost time; empty where there is too little for one."""
        return ladder_of(self.case, self.methods, self.best)


def answer_of(summaries: Sequence[CaseSummary]) -> tuple[str, ...]:
    """Say what came out over all cases, with the papers' budgets beside ours."""
    return answer([each.best for each in summaries], [each.case.settings.evaluations for each in summaries])


def summarise(cases: Mapping[str, Case], results: Iterable[Result]) -> tuple[CaseSummary, ...]:
    """Summarise every case, in the order given.

    Parameters
    ----------
    cases : mapping of str to Case
    results : iterable of Result
    """
    results = tuple(results)
    return tuple(summarise_case(case, results) for case in cases.values())


def summarise_case(
    case: Case, results: Iterable[Result], published: Sequence[MethodSummary] | None = None
) -> CaseSummary:
    """Summarise every method of a case, and what its paper prints.

    Parameters
    ----------
    case : Case
    results : iterable of Result
        Those of other cases are passed over.
    published : sequence of MethodSummary, optional
        Judged published motions of the case, where they are known already.
    """
    own = sorted((r for r in results if r.cell.case == case.name), key=lambda r: (r.cell.label, r.cell.settings.seed))
    methods = [_of_runs(case, tuple(runs)) for _, runs in groupby(own, key=lambda run: run.cell.label)]
    methods += published_methods(case) if published is None else published
    return CaseSummary(case, _placed(sorted(methods, key=_order)))


def _of_runs(case: Case, runs: tuple[Result, ...]) -> MethodSummary:
    method = _installed(runs[0].cell.planner)
    moving = next((run.motion for run in runs if run.motion is not None), None)
    if moving is None and any(run.lower_bound is not None for run in runs):
        kind: Kind = Kind.BOUND
    else:
        stochastic = is_stochastic(method) if method else runs[0].evaluations > 0
        kind = Kind.SEARCH if stochastic else Kind.DETERMINISTIC
    freedom = method.freedom if method else _freedom_seen(case, moving)
    return MethodSummary(
        case=case.name,
        label=runs[0].cell.label,
        kind=kind,
        freedom=None if kind is Kind.BOUND and freedom is not Freedom.CURVE else freedom,
        about=method.about if method else "",
        results=runs,
    )


def _installed(name: str) -> Method | None:
    """Planner or bound of a stored run; None where it is no longer installed."""
    try:
        return method_named(name)
    except StudyError:
        return None


def _freedom_seen(case: Case, motion: Motion | None) -> Freedom | None:
    """Tell from a motion what a planner that is no longer installed was free to change."""
    if motion is None:
        return None
    return Freedom.CURVE if on_curve(case.problem, case.curve, motion) else Freedom.FREE


def on_curve(problem: Problem, curve: str, motion: Motion) -> bool:
    """Rebuild the curve from the motion's own segment durations and compare the two."""
    try:
        rebuilt = CURVES[curve].motion(problem.waypoints, np.diff(motion.waypoint_times))
    except StudyError:
        return False
    times = np.linspace(0.0, motion.duration, 101)
    scale = max(float(np.ptp(problem.waypoints)), 1e-9)
    return bool(np.abs(rebuilt(times) - motion(times)).max() <= 1e-6 * scale)


def _placed(methods: Sequence[MethodSummary]) -> tuple[MethodSummary, ...]:
    """Give ordered methods their ranks and gaps."""
    places, bound = count(1), lower_bound(methods)
    whole = [method for method in methods if method.median is not None and method.joint is None]
    shortest = {freedom: _shortest(m for m in whole if m.freedom is freedom) for freedom in (*Freedom, None)}
    overall = _shortest(whole)
    return tuple(
        replace(
            method,
            rank=next(places),
            gap=_above(method, overall),
            behind_same_kind=_above(method, shortest[method.freedom]),
            above_bound=_above(method, bound),
        )
        if method in whole
        else method
        for method in methods
    )


def _shortest(methods: Iterable[MethodSummary]) -> float | None:
    return min((method.best for method in methods if method.best is not None), default=None)


def _above(method: MethodSummary, least: float | None) -> float | None:
    return None if method.median is None or least is None else method.median / least - 1.0


def _order(method: MethodSummary) -> tuple[bool, bool, float, str]:
    duration = np.inf if method.judged_duration is None else method.judged_duration
    return method.joint is not None, not method.feasible, duration, method.label
