"""From results to table rows: one per method and case, feasible ones first, nothing hidden."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from study.cases.library import Case, Published
from study.curves import curve_named
from study.errors import StudyError
from study.judge import judge
from study.planning import Freedom, Plan, Status
from study.registry import planner_named
from study.store.results import Cell, Result

CURVE, FIXED_PATH, FREE_PATH = Freedom.CURVE, Freedom.PATH, Freedom.FREE


@dataclass(frozen=True, eq=False)
class Row:
    """What all runs of one method on one case came to.

    Attributes
    ----------
    case, label : str
    kind : str
        `search`, `deterministic` or `published`.
    path : str
        Whether the method keeps the case's curve family, retimes a fixed path or chooses its path freely; empty where
        that is not known.
    runs, feasible_runs : int
    best, median : float, optional, s
        Duration over the feasible runs; None where there is none.
    gap : float, optional
        Of the median to the shortest feasible duration known for the case, relative; None where the row is infeasible
        or speaks of one joint alone.
    worst_ratio : float, optional
        Largest ratio of a peak to its limit over the feasible runs, or over all where none is feasible.
    evaluations : int
        Median over the runs.
    wall_time : float, s
        Median over the runs.
    reason : str
        Why runs are infeasible; empty where all are feasible.
    joint : int, optional
        Counted from 0, where a published row speaks of one joint alone; such rows stand last and take no part in gaps.
    representative : Result, optional
        The median feasible run, or the least infeasible one; None where a paper prints too little to judge.
    claimed : float, optional, s
        Total time as the paper prints it.
    """

    case: str
    label: str
    kind: str
    path: str
    runs: int
    feasible_runs: int
    best: float | None
    median: float | None
    gap: float | None
    worst_ratio: float | None
    evaluations: int
    wall_time: float
    reason: str
    joint: int | None = None
    representative: Result | None = None
    claimed: float | None = None

    @property
    def feasible(self) -> bool:
        """Whether any run was feasible."""
        return self.feasible_runs > 0

    @property
    def duration(self) -> float | None:
        """Duration to show, s: the feasible runs' median, else that of the representative motion, feasible or not."""
        if self.median is not None:
            return self.median
        verdict = self.representative.verdict if self.representative else None
        return verdict.duration if verdict else None


def summarise(cases: Mapping[str, Case], results: Sequence[Result]) -> list[Row]:
    """Make the table of every case, cases in the order given, published rows included.

    Parameters
    ----------
    cases : mapping of str to Case
    results : sequence of Result

    Returns
    -------
    list of Row
        For every case the feasible rows by median duration, then the infeasible ones, then single joints.
    """
    return [row for case in cases.values() for row in case_rows(case, [r for r in results if r.cell.case == case.name])]


def case_rows(case: Case, results: Sequence[Result]) -> list[Row]:
    """Make the ranked table of one case, published rows included."""
    ordered = sorted(results, key=lambda result: result.cell.label)
    rows = [_run_row(list(runs)) for _, runs in groupby(ordered, key=lambda result: result.cell.label)]
    rows += published_rows(case)
    best = min((row.best for row in rows if row.best is not None and row.joint is None), default=None)
    return sorted((_with_gap(row, best) for row in rows), key=_rank)


def published_rows(case: Case) -> list[Row]:
    """Judge what the case's paper prints.

    Durations printed joint by joint give a row for each joint and one for their maximum per segment; totals without
    durations give a row that says that there is nothing to judge.
    """
    return [_published_row(case, entry) for entry in (*case.published, *_synchronised(case))]


def _published_row(case: Case, entry: Published) -> Row:
    joint = "" if entry.joint is None else f", {case.problem.joint_names[entry.joint]}"
    label = f"published: {entry.label}{joint}"
    if entry.durations is None:
        reason = f"the paper prints no segment durations ({entry.source}), so there is nothing to judge"
        return Row(
            case.name, label, "published", CURVE, 1, 0, None, None, None, None, 0, 0.0, reason, claimed=entry.total
        )
    row = _row([published_result(case, entry, label)], "published", CURVE)
    return replace(row, joint=entry.joint, claimed=entry.total)


def published_result(case: Case, entry: Published, label: str) -> Result:
    """Drive a paper's printed segment durations on its curve and judge the motion."""
    problem = case.problem if entry.joint is None else case.problem.joint(entry.joint)
    settings = replace(case.settings, curve=case.curve)
    plan, verdict = Plan(Status.FINISHED, durations=entry.durations, message=entry.source), None
    try:
        motion = curve_named(case.curve).motion(problem.waypoints, np.asarray(entry.durations))
        plan, verdict = replace(plan, motion=motion), judge(problem, motion)
    except StudyError as error:
        plan = replace(plan, status=Status.FAILED, message=str(error))
    return Result(
        cell=Cell(case.name, "published", label, settings),
        status=plan.status,
        message=plan.message,
        motion=plan.motion,
        verdict=verdict,
        durations=plan.durations,
        evaluations=0,
        iterations=0,
        history=plan.history,
        details={},
        wall_time=0.0,
    )


def _synchronised(case: Case) -> list[Published]:
    """Printed per-joint durations put together by the papers' rule: the longest of every segment."""
    together = []
    printed = [entry for entry in case.published if entry.joint is not None and entry.durations is not None]
    whole = {entry.label for entry in case.published if entry.joint is None and entry.durations is not None}
    for label in dict.fromkeys(entry.label for entry in printed):
        parts = {e.joint: np.asarray(e.durations, dtype=float) for e in printed if e.label == label}
        if len(parts) == case.problem.n_joints and label not in whole:
            durations = np.max(list(parts.values()), axis=0)
            together.append(Published(label, None, durations, None, "longest printed duration of every segment"))
    return together


def _run_row(results: list[Result]) -> Row:
    name = results[0].cell.planner
    try:
        planner = planner_named(name)
    except StudyError:  # stored by a planner that is no longer installed
        return _row(results, "search" if results[0].evaluations else "deterministic", "")
    return _row(results, "search" if planner.stochastic else "deterministic", planner.freedom)


def _row(results: list[Result], kind: str, path: str) -> Row:
    feasible = sorted((r for r in results if _feasible(r)), key=_duration)
    judged = feasible or [r for r in results if r.verdict]
    durations = [_duration(r) for r in feasible]
    return Row(
        case=results[0].cell.case,
        label=results[0].cell.label,
        kind=kind,
        path=path,
        runs=len(results),
        feasible_runs=len(feasible),
        best=durations[0] if durations else None,
        median=float(np.median(durations)) if durations else None,
        gap=None,
        worst_ratio=max((r.verdict.worst_ratio for r in judged if r.verdict), default=None),
        evaluations=round(float(np.median([r.evaluations for r in results]))),
        wall_time=float(np.median([r.wall_time for r in results])),
        reason=_reason([r for r in results if not _feasible(r)], len(results)),
        representative=feasible[(len(feasible) - 1) // 2] if feasible else min(results, key=_violation),
    )


def _feasible(result: Result) -> bool:
    return result.verdict is not None and result.verdict.feasible


def _duration(result: Result) -> float:
    return result.verdict.duration if result.verdict else np.inf


def _violation(result: Result) -> float:
    return result.verdict.violation if result.verdict else np.inf


def _reason(infeasible: list[Result], runs: int) -> str:
    if not infeasible:
        return ""
    ordered = sorted(infeasible, key=_violation)
    sentences = [r.verdict.reasons[0] if r.verdict else r.message or r.status.value for r in ordered]
    share = f"{len(infeasible)} of {runs} runs: " if runs > 1 else ""
    return share + Counter(sentences).most_common(1)[0][0]


def _with_gap(row: Row, best: float | None) -> Row:
    if row.median is None or best is None or row.joint is not None:
        return row
    return replace(row, gap=row.median / best - 1.0)


def _rank(row: Row) -> tuple[bool, bool, float, str]:
    duration = np.inf if row.duration is None else row.duration
    return row.joint is not None, not row.feasible, duration, row.label
