"""The question put to every planner: waypoints, joint limits and end conditions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from study.arrays import Floats, frozen_array
from study.demands import Demand, EndCondition
from study.errors import StudyError
from study.limits import OPTIONAL, JointLimits

__all__ = ["Demand", "EndCondition", "Floats", "JointLimits", "Problem", "frozen_array", "usual_bounds"]


def usual_bounds(waypoints: Floats, limits: JointLimits) -> tuple[float, float]:
    """Choose a box of segment durations that suits any scale of waypoints and limits.

    From stop to stop a joint takes no less than d/V, sqrt(4d/A) and cbrt(32d/J), and little more than their sum. The lower
    bound is what no motion can beat, the shortest d/V of any segment, or a hundredth of the shortest stop to stop
    where no velocity is limited; the upper bound is ten times the longest stop to stop.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    limits : JointLimits

    Returns
    -------
    tuple of two floats, s
    """
    steps = np.abs(np.diff(waypoints, axis=0))
    moved = steps[(steps > 0).any(axis=1)]
    if not len(moved):
        return 1e-3, 10.0
    at_full_speed = (moved / limits.velocity).max(axis=1)
    each = [at_full_speed, np.sqrt(4 * moved / limits.acceleration).max(axis=1)]
    stops = np.sum([*each, np.cbrt(32 * moved / limits.jerk).max(axis=1)], axis=0)
    lower = float(at_full_speed.min() or 0.01 * stops.min() or 1e-3)
    return lower, 10 * max(float(stops.max()), lower)


@dataclass(frozen=True, eq=False)
class Problem:
    """Pass through waypoints in order, as fast as the joint limits allow.

    Parameters
    ----------
    name : str
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    limits : JointLimits
    end : EndCondition
        What the judge demands of the first and last instant.
    duration_bounds : tuple of two floats, s, optional
        The box (lower, upper) in which segment-time searches look; the lower bound also holds for
        deterministic segment-time methods. The judge does not use it. Without it, `usual_bounds` of the waypoints and
        limits is taken.
    allow_dwell : bool
        Whether neighbouring waypoints may be equal, as they may when one joint is taken alone.
    joint_names : tuple of str, optional

    Raises
    ------
    StudyError
        If the waypoints are not a table of at least two distinct neighbouring rows of finite numbers that
        matches the limits, or the duration bounds are not 0 <= lower < upper.
    """

    name: str
    waypoints: Floats
    limits: JointLimits
    end: EndCondition = EndCondition.REST
    duration_bounds: tuple[float, float] = OPTIONAL
    allow_dwell: bool = False
    joint_names: Sequence[str] = ()

    def __post_init__(self) -> None:
        where = f"case {self.name!r}"
        points = frozen_array(self.waypoints, f"{where}: waypoints")
        object.__setattr__(self, "waypoints", points)
        n_joints = self.limits.n_joints
        if points.ndim != 2 or points.shape[1] != n_joints or len(points) < 2:
            raise StudyError(
                f"{where}: waypoints must have shape (n_waypoints >= 2, {n_joints}) to match the limits, got {points.shape}"
            )
        if not np.isfinite(points).all():
            row = int(np.argmax(~np.isfinite(points).all(axis=1)))
            raise StudyError(f"{where}: waypoint {row + 1} holds an infinite value; give finite numbers")
        if not np.isfinite(self.limits.rates).any() and not self.allow_dwell:
            raise StudyError(
                f"{where}: no joint has a finite limit, so there is no shortest time; give a velocity limit"
            )
        self._check_neighbours(where)
        self._check_positions(where)
        if self.duration_bounds is None:
            object.__setattr__(self, "duration_bounds", usual_bounds(points, self.limits))
        lower, upper = self.duration_bounds
        if not 0 <= lower < upper < np.inf:
            raise StudyError(f"{where}: duration bounds must satisfy 0 <= lower < upper, got ({lower:g}, {upper:g}) s")
        names = tuple(self.joint_names) or tuple(f"joint {j + 1}" for j in range(n_joints))
        if len(names) != n_joints:
            raise StudyError(f"{where}: {len(names)} joint names for {n_joints} joints")
        object.__setattr__(self, "joint_names", names)

    def _check_neighbours(self, where: str) -> None:
        repeated = (self.waypoints[1:] == self.waypoints[:-1]).all(axis=1)
        if repeated.any() and not self.allow_dwell:
            row = int(np.argmax(repeated)) + 1
            raise StudyError(
                f"{where}: waypoints {row} and {row + 1} are equal, so the segment between them has no length; remove one"
            )

    def _check_positions(self, where: str) -> None:
        outside = (self.waypoints < self.limits.lower) | (self.waypoints > self.limits.upper)
        if outside.any():
            row, joint = np.argwhere(outside)[0]
            raise StudyError(
                f"{where}: waypoint {row + 1} puts joint {joint + 1} at {self.waypoints[row, joint]:g}, outside its range "
                f"[{self.limits.lower[joint]:g}, {self.limits.upper[joint]:g}]"
            )

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return int(self.waypoints.shape[1])

    @property
    def n_waypoints(self) -> int:
        """Number of waypoints."""
        return len(self.waypoints)

    @property
    def n_segments(self) -> int:
        """Number of segments between waypoints."""
        return len(self.waypoints) - 1

    @property
    def demands(self) -> frozenset[Demand]:
        """Everything that the problem asks of a motion beyond passing the waypoints."""
        limits = self.limits
        asked = {
            Demand.VELOCITY: np.isfinite(limits.velocity).any(),
            Demand.ACCELERATION: np.isfinite(limits.acceleration).any(),
            Demand.JERK: np.isfinite(limits.jerk).any(),
            Demand.POSITION_RANGE: np.isfinite([limits.lower, limits.upper]).any(),
            Demand.DIRECTIONAL_LIMITS: not limits.symmetric,
        }
        return frozenset(demand for demand, holds in asked.items() if holds)

    def joint(self, index: int) -> Problem:
        """Take the problem of one joint alone; its neighbouring waypoints may then be equal."""
        return replace(
            self,
            name=f"{self.name}, {self.joint_names[index]}",
            waypoints=self.waypoints[:, index : index + 1],
            limits=self.limits.joint(index),
            joint_names=(self.joint_names[index],),
            allow_dwell=True,
        )
