"""Published motions, driven on the curve of their paper and judged like any other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from study.analysis.methods import Kind, MethodSummary
from study.cases.library import Case, Published
from study.curves import curve_named
from study.errors import StudyError
from study.judge import judge
from study.planning import Freedom, Status
from study.store.results import Cell, Result


def published_methods(case: Case) -> tuple[MethodSummary, ...]:
    """Judge the motions that the case's paper prints.

    Durations printed joint by joint give a motion for each joint and one for their maximum per segment; totals without
    durations say that there is nothing to judge.
    """
    return tuple(_summary(case, published) for published in (*case.published, *_synchronised(case)))


def _summary(case: Case, published: Published) -> MethodSummary:
    joint = "" if published.joint is None else f", {case.problem.joint_names[published.joint]}"
    label, judged = f"published: {published.label}{joint}", published.durations is not None
    return MethodSummary(
        case=case.name,
        label=label,
        kind=Kind.PUBLISHED,
        freedom=Freedom.CURVE,
        results=(published_result(case, published, label),) if judged else (),
        joint=published.joint if judged else None,
        claimed=published.total,
        remark=""
        if judged
        else f"the paper prints no segment durations ({published.source}), so there is nothing to judge",
    )


def published_result(case: Case, published: Published, label: str) -> Result:
    """Drive a paper's printed segment durations on its curve and judge the motion."""
    problem = case.problem if published.joint is None else case.problem.joint(published.joint)
    cell = Cell(case.name, Kind.PUBLISHED, label, replace(case.settings, curve=case.curve))
    result = Result(Status.FINISHED, durations=published.durations, message=published.source, cell=cell)
    try:
        motion = curve_named(case.curve).motion(problem.waypoints, np.asarray(published.durations))
        return replace(result, motion=motion, verdict=judge(problem, motion))
    except StudyError as error:
        return replace(result, status=Status.FAILED, message=str(error))


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
