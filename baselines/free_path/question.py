"""The question as the interior-point method takes it: plain arrays, one row per segment or waypoint."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from study.errors import StudyError
from study.problem import EndCondition, Floats, Problem

STILL = 1e-9
"""Absolute span, rad or m, below which a joint stands still and stays where it is."""

Flags = NDArray[np.bool_]
Integers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class FreePathProblem:
    """Pass through waypoints as fast as limits allow, with everything that may differ by direction or segment given apart.

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
        Waypoints at which all joints stand, with zero acceleration where jerk is limited.
    dwells : array of shape (n_waypoints,), s
        How long the joints stand there; only at stops and at ends at rest.
    tolerance : array of shape (n_waypoints, n_joints), rad or m
        How far from a waypoint the joint may pass.
    shortest : float, s
        Duration below which the motion need not be.

    Raises
    ------
    StudyError
        If an upper limit is not positive or a lower one not negative, or a dwell is asked for where nothing stops.
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
    shortest: float = 0.0

    def __post_init__(self) -> None:
        if (self.upper <= 0).any() or (self.lower >= 0).any():
            raise StudyError("free path: every limit must leave some room in both directions")
        passing = np.where(self.stops, 0.0, self.dwells)[1:-1]
        if np.any(passing > 0):
            raise StudyError("free path: a dwell is only possible at a waypoint where all joints stop")

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
        """Highest limited rate of every joint, shape (n_joints,): 3 jerk, 2 acceleration, 1 velocity, 0 none or still."""
        limited = np.isfinite(np.minimum(-self.lower, self.upper)).any(axis=1)
        highest = (limited * np.arange(1, 4)[:, None]).max(axis=0)
        return np.where(np.ptp(self.waypoints, axis=0) > STILL, highest, 0)

    @property
    def rates(self) -> Floats:
        """Limits that hold in both directions, shape (3, n_segments, n_joints)."""
        return np.minimum(-self.lower, self.upper)

    def between(self, first: int, last: int, start: Floats, end: Floats) -> FreePathProblem:
        """Take the waypoints from first to last alone, with other states at both ends."""
        segments, points = slice(first, last), slice(first, last + 1)
        return replace(
            self,
            waypoints=self.waypoints[points],
            lower=self.lower[:, segments],
            upper=self.upper[:, segments],
            range_lower=self.range_lower[segments],
            range_upper=self.range_upper[segments],
            start=start,
            end=end,
            stops=self.stops[points],
            dwells=self.dwells[points],
            tolerance=self.tolerance[points],
        )


def of(problem: Problem) -> FreePathProblem:
    """Express a problem of the study."""
    points, limits = problem.waypoints, problem.limits
    n_points, n_joints = points.shape
    state = np.full((2, n_joints), np.nan)
    state[: {EndCondition.FREE: 0, EndCondition.REST: 1, EndCondition.SMOOTH: 2}[problem.end]] = 0.0
    return FreePathProblem(
        waypoints=points,
        lower=np.repeat(limits.lowest_rates[:, None], n_points - 1, axis=1),
        upper=np.repeat(limits.highest_rates[:, None], n_points - 1, axis=1),
        range_lower=np.tile(limits.lower, (n_points - 1, 1)),
        range_upper=np.tile(limits.upper, (n_points - 1, 1)),
        start=state,
        end=state,
        stops=np.zeros(n_points, dtype=bool),
        dwells=np.zeros(n_points),
        tolerance=np.zeros((n_points, n_joints)),
    )
