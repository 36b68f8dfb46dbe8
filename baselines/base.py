"""Steps that the deterministic planners share: problems in which nothing moves, joints alone or together."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import wraps
from typing import ClassVar, TypeVar

import numpy as np

from study.demands import refusal
from study.errors import StudyError
from study.planning import RATE_LIMITS, Freedom, Plan, Planner, RunSettings, Status, Synchronisation
from study.problem import Demand, Floats, Problem

P = TypeVar("P", bound=Planner)
GRACE = 0.5
"""Time by which a planner may miss its limit where a fifth of it is less, s."""

NOTHING_MOVES = "all waypoints are equal, so there is nothing to move"


class Deterministic:
    """Usual description of a deterministic planner.

    Attributes
    ----------
    set_up : float, s
        Processor time for each segment of each joint, rounded up, of a preparation that nothing can stop.
    """

    set_up: ClassVar[float] = 0.0

    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS
    stochastic: ClassVar[bool] = False


def where_something_moves(
    plan: Callable[[P, Problem, RunSettings], Plan],
) -> Callable[[P, Problem, RunSettings], Plan]:
    """Decorate `plan`: a demand that the planner does not know, or a problem of still joints, does not apply.

    Nor does one whose preparation alone would miss the time limit by far. Still joints are held still, and an
    error is a reason.
    """

    @wraps(plan)
    def careful(planner: P, problem: Problem, settings: RunSettings) -> Plan:
        if reason := refusal(problem.planner_demands, planner.knows):
            return Plan(Status.NOT_APPLICABLE, message=reason)
        if not problem.moving.any():
            return Plan(Status.NOT_APPLICABLE, message=NOTHING_MOVES)
        needed = getattr(planner, "set_up", 0.0) * problem.n_segments * problem.n_joints
        if needed > settings.time_limit + max(GRACE, 0.2 * settings.time_limit):
            reason = (
                f"its preparation, which nothing can stop, takes about {needed:.2g} s here, more than the time limit"
            )
            return Plan(Status.NOT_APPLICABLE, message=reason)
        try:
            return plan(planner, held_still(problem), settings)
        except StudyError as error:
            return Plan(Status.FAILED, message=str(error))

    return careful


def held_still(problem: Problem) -> Problem:
    """Take the noise from joints that do not move, so that no planner takes it for a motion."""
    noisy = ~problem.moving & np.ptp(problem.waypoints, axis=0).astype(bool)
    if not noisy.any():
        return problem
    still = np.where(noisy, problem.waypoints[0], problem.waypoints)
    return replace(problem, waypoints=still, allow_dwell=True)


def segment_rates(problem: Problem) -> tuple[Floats, Floats]:
    """Lowest and highest rates on every segment, those of single segments among them, (3, n_segments, n_joints)."""
    shape = (3, problem.n_segments, problem.n_joints)
    lowest = np.broadcast_to(problem.limits.lowest_rates[:, None], shape).copy()
    highest = np.broadcast_to(problem.limits.highest_rates[:, None], shape).copy()
    for segment, limits in problem.segment_limits.items():
        lowest[:, segment] = np.maximum(lowest[:, segment], limits.lowest_rates)
        highest[:, segment] = np.minimum(highest[:, segment], limits.highest_rates)
    return lowest, highest


def along(vectors: Floats, lowest: Floats, highest: Floats) -> Floats:
    """Largest multiple of each vector within limits by direction, all of shape (..., n_joints)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(vectors > 0, highest / vectors, np.where(vectors < 0, lowest / vectors, np.inf))
    return np.asarray(most.min(axis=-1))


def parts(problem: Problem, settings: RunSettings) -> list[Problem]:
    """Split a problem into its joints where every joint plans alone; else it stays whole."""
    if settings.synchronisation is Synchronisation.PER_JOINT:
        return [problem.joint(j) for j in range(problem.n_joints)]
    return [problem]


def longest(durations: Iterable[Floats]) -> Floats:
    """Longest duration of every segment over all parts, shape (n_segments,), s."""
    return np.asarray(np.max(list(durations), axis=0), dtype=float)
