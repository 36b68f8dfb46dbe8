"""The question as the interior-point method takes it: plain arrays, one row per segment or waypoint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baselines.base import segment_rates
from study.errors import StudyError
from study.problem import Floats, Problem
from study.tolerances import floors

Flags = NDArray[np.bool_]
Integers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class FreePathProblem:
    """Time-optimal motion through waypoints, with everything that may differ by direction or segment given apart.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    lower, upper : arrays of shape (3, n_segments, n_joints), rad/s^k or m/s^k
        Limits of velocity, acceleration and jerk in either direction; infinite where there is none.
    range_lower, range_upper : arrays of shape (n_segments, n_joints), rad or m
        Range of positions on every segment.
    start, end : arrays of shape (2, n_joints), rad/s^k or m/s^k
        Velocity and acceleration at the first and the last instant; NaN where free.
    stops : bool array of shape (n_waypoints,)
        Waypoints at which no joint has velocity.
    dwells : array of shape (n_waypoints,), s
        How long all joints stand at a waypoint, from their arrival on; not at the ends.
    tolerance : array of shape (n_waypoints, n_joints), rad or m
        How far from a waypoint the joint may pass.

    Raises
    ------
    StudyError
        If an upper limit is not positive or a lower one not negative.
    """

    waypoints: Floats
    lower: Floats
    upper: Floats
    range_lower: Floats
    range_upper: Floats
    start: Floats
    end: Floats
    stops: Flags
    dwells: Floats
    tolerance: Floats

    def __post_init__(self) -> None:
        if (self.upper <= 0).any() or (self.lower >= 0).any():
            raise StudyError("free path: every limit must leave some room in both directions")

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return int(self.waypoints.shape[1])

    @property
    def n_segments(self) -> int:
        """Number of segments between waypoints."""
        return len(self.waypoints) - 1

    @property
    def kinds(self) -> Integers:
        """Highest limited rate by joint, shape (n_joints,): 3 jerk, 2 acceleration, 1 velocity, 0 none or still.

        A joint between equal waypoints moves where an end gives it a rate.
        """
        limited = np.isfinite(np.minimum(-self.lower, self.upper)).any(axis=1)
        highest = (limited * np.arange(1, 4)[:, None]).max(axis=0)
        pushed = np.nan_to_num([self.start, self.end]).any(axis=(0, 1))
        return np.where(pushed | (np.ptp(self.waypoints, axis=0) > floors(self.waypoints)), highest, 0)

    @property
    def scalable(self) -> bool:
        """Whether a slower run of a motion meets the demands at both ends: their rates are zero or free."""
        return not np.nan_to_num([self.start, self.end]).any()

    @property
    def rates(self) -> Floats:
        """Limits that hold in both directions, shape (3, n_segments, n_joints)."""
        return np.minimum(-self.lower, self.upper)


def of(problem: Problem, within: float = 1.0) -> FreePathProblem:
    """Express a problem of the study, with that part of the tolerances at waypoints."""
    lowest, highest = segment_rates(problem)
    below, above = _range(problem)
    points = np.arange(problem.n_waypoints)
    return FreePathProblem(
        waypoints=problem.waypoints,
        lower=lowest,
        upper=highest,
        range_lower=below,
        range_upper=above,
        start=_state(problem, 0),
        end=_state(problem, 1),
        stops=np.isin(points, list(problem.stops)),
        dwells=np.array([problem.dwells.get(int(k), 0.0) for k in points]),
        tolerance=within * problem.tolerances,
    )


def _range(problem: Problem) -> tuple[Floats, Floats]:
    """Range of positions on every segment, each of shape (n_segments, n_joints)."""
    below = np.tile(problem.limits.lower, (problem.n_segments, 1))
    above = np.tile(problem.limits.upper, (problem.n_segments, 1))
    for segment, limits in problem.segment_limits.items():
        below[segment] = np.maximum(below[segment], limits.lower)
        above[segment] = np.minimum(above[segment], limits.upper)
    return below, above


def _state(problem: Problem, side: int) -> Floats:
    """Velocity and acceleration at an end, shape (2, n_joints), NaN where free."""
    free = np.full(problem.n_joints, np.nan)
    return np.stack([free if rate is None else rate for rate in problem.end_states[side].rates])
