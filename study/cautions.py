"""Cautions about a problem whose demands are so weak that a motion which meets them cannot be driven."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from study.errors import StudyError, listed
from study.problem import EndCondition, Problem

UNFIT = "no arm can follow such a motion"


def unbounded_joints(problem: Problem) -> NDArray[np.bool_]:
    """Joints whose speed may change in an instant, shape (n_joints,): no acceleration, jerk or torque is limited."""
    if problem.arm is not None and problem.arm.forbids_steps:
        return np.zeros(problem.n_joints, dtype=bool)
    return problem.moving & ~np.isfinite(problem.limits.rates[1:]).any(axis=0)


def cautions(problem: Problem) -> tuple[str, ...]:
    """Say what a reader must know before a motion that meets the problem's demands is driven, one sentence each."""
    unbounded = unbounded_joints(problem)
    if not unbounded.any():
        return ()
    every = bool(unbounded[problem.moving].all())
    names = "no joint has" if every else f"{_names(problem)} {'has' if unbounded.sum() == 1 else 'have'} no"
    limit = "an acceleration limit" if every else "acceleration limit"
    return (f"{names} {limit}, so speed may change in an instant, also at the start and at the end: {UNFIT}",)


def ends_said(problem: Problem) -> str:
    """Say how the motion begins and ends, as far as the judge holds it to that."""
    unbounded = unbounded_joints(problem)
    if problem.end is EndCondition.FREE or not unbounded.any():
        return problem.end.value
    if unbounded[problem.moving].all():
        return "may start and end at full speed, because no joint has an acceleration limit"
    return f"{problem.end.value}, but {_names(problem)} may start and end at full speed without an acceleration limit"


def require_bounded(problem: Problem, accepted: bool) -> None:
    """Refuse to write a motion that no arm can follow, unless that is accepted in so many words.

    Raises
    ------
    StudyError
        If a joint that moves has no acceleration limit, and that is not accepted.
    """
    if not accepted and (said := cautions(problem)):
        raise StudyError(
            f"case {problem.name!r}: {said[0]}; nothing is written for a controller. Give acceleration limits, or accept "
            "it by accept_unbounded_acceleration=True or --accept-unbounded-acceleration"
        )


def _names(problem: Problem) -> str:
    return listed(
        [name for name, unbounded in zip(problem.joint_names, unbounded_joints(problem), strict=True) if unbounded]
    )
