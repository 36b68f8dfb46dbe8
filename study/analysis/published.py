"""Published motions, driven on the curve of their paper and judged like any other."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from study.cases.library import Case, Published
from study.curves import curve_named
from study.errors import StudyError
from study.judge import judge
from study.planning import Plan, Status
from study.store.results import Cell, Result

PUBLISHED = "published"
"""Stands for the planner of a published motion."""


@dataclass(frozen=True, eq=False)
class Printed:
    """A motion as the paper prints it.

    Attributes
    ----------
    label : str
    result : Result, optional
        The judged motion; None where the paper prints too little to judge.
    joint : int, optional
        Counted from 0, where it is of one joint alone.
    total : float, optional, s
        Total time as printed.
    remark : str
        Reason why it cannot be judged.
    """

    label: str
    result: Result | None
    joint: int | None
    total: float | None
    remark: str = ""


def printed_motions(case: Case) -> tuple[Printed, ...]:
    """Judge the motions that the case's paper prints.

    Durations printed joint by joint give a motion for each joint and one for their maximum per segment; totals without
    durations say that there is nothing to judge.
    """
    return tuple(_printed(case, published) for published in (*case.published, *_synchronised(case)))


def _printed(case: Case, published: Published) -> Printed:
    joint = "" if published.joint is None else f", {case.problem.joint_names[published.joint]}"
    label = f"published: {published.label}{joint}"
    if published.durations is None:
        remark = f"the paper prints no segment durations ({published.source}), so there is nothing to judge"
        return Printed(label, None, None, published.total, remark)
    return Printed(label, published_result(case, published, label), published.joint, published.total)


def published_result(case: Case, published: Published, label: str) -> Result:
    """Drive a paper's printed segment durations on its curve and judge the motion."""
    problem = case.problem if published.joint is None else case.problem.joint(published.joint)
    plan, verdict = Plan(Status.FINISHED, durations=published.durations, message=published.source), None
    try:
        motion = curve_named(case.curve).motion(problem.waypoints, np.asarray(published.durations))
        plan, verdict = replace(plan, motion=motion), judge(problem, motion)
    except StudyError as error:
        plan = replace(plan, status=Status.FAILED, message=str(error))
    return Result(
        cell=Cell(case.name, PUBLISHED, label, replace(case.settings, curve=case.curve)),
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
    printed = [motion for motion in case.published if motion.joint is not None and motion.durations is not None]
    whole = {motion.label for motion in case.published if motion.joint is None and motion.durations is not None}
    for label in dict.fromkeys(motion.label for motion in printed):
        parts = {m.joint: np.asarray(m.durations, dtype=float) for m in printed if m.label == label}
        if len(parts) == case.problem.n_joints and label not in whole:
            durations = np.max(list(parts.values()), axis=0)
            together.append(Published(label, None, durations, None, "longest printed duration of every segment"))
    return together
