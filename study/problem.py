"""The question put to every planner: waypoints, joint limits and end conditions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study.errors import StudyError

Floats = NDArray[np.float64]


class EndCondition(Enum):
    """What a motion must do at its first and last instant."""

    FREE = "may start and end in motion"
    REST = "starts and ends at rest"
    SMOOTH = "starts and ends at rest with zero acceleration"


def frozen_array(values: ArrayLike, what: str) -> Floats:
    """Copy numbers into a read-only float array, or say which of them is not a number."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise StudyError(f"{what} must be a rectangular table of numbers: {error}") from None
    if np.isnan(array).any():
        where = ", ".join(str(i + 1) for i in np.argwhere(np.isnan(array))[0])
        raise StudyError(f"{what} holds a value that is not a number (NaN) at position {where}; give a number there")
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Symmetric limits on the rates of every joint; infinity means that the joint has no such limit.

    Parameters
    ----------
    velocity : array of shape (n_joints,), rad/s or m/s
    acceleration : array of shape (n_joints,), rad/s^2 or m/s^2, optional
    jerk : array of shape (n_joints,), rad/s^3 or m/s^3, optional
    lower, upper : arrays of shape (n_joints,), rad or m, optional
        The range of positions.

    Raises
    ------
    StudyError
        If lengths differ, a limit is zero, negative or not a number, or a range of positions is empty.
    """

    velocity: Floats
    acceleration: Floats = field(default_factory=lambda: np.array(np.inf))
    jerk: Floats = field(default_factory=lambda: np.array(np.inf))
    lower: Floats = field(default_factory=lambda: np.array(-np.inf))
    upper: Floats = field(default_factory=lambda: np.array(np.inf))

    def __post_init__(self) -> None:
        shape = np.shape(self.velocity)
        if len(shape) != 1 or not shape[0]:
            raise StudyError(f"velocity limits must be a list with one number per joint, got shape {shape}")
        for name in ("velocity", "acceleration", "jerk", "lower", "upper"):
            array = frozen_array(getattr(self, name), f"{name} limits")
            if array.shape not in (shape, ()):
                raise StudyError(f"{name} limits must have one number for each of {shape[0]} joints, got {array.size}")
            object.__setattr__(self, name, frozen_array(np.broadcast_to(array, shape), name))
        for name, rates in zip(("velocity", "acceleration", "jerk"), self.rates, strict=True):
            for joint, value in enumerate(rates):
                if value <= 0:
                    raise StudyError(
                        f"{name} limit of joint {joint + 1} must be positive, got {value:g}; leave it out for no limit"
                    )
        if (self.lower >= self.upper).any():
            joint = int(np.argmax(self.lower >= self.upper))
            raise StudyError(
                f"position limits of joint {joint + 1} are empty: lower {self.lower[joint]:g}, upper {self.upper[joint]:g}"
            )

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self.velocity)

    @property
    def rates(self) -> Floats:
        """Velocity, acceleration and jerk limits as one array of shape (3, n_joints)."""
        return np.stack([self.velocity, self.acceleration, self.jerk])

    def joint(self, index: int) -> JointLimits:
        """Limits of one joint alone."""
        pick = slice(index, index + 1)
        return JointLimits(
            self.velocity[pick], self.acceleration[pick], self.jerk[pick], self.lower[pick], self.upper[pick]
        )

    def scaled(self, factor: float) -> JointLimits:
        """Limits under which every motion takes exactly `factor` times as long: divided by factor, its square, its cube."""
        return replace(
            self,
            velocity=self.velocity / factor,
            acceleration=self.acceleration / factor**2,
            jerk=self.jerk / factor**3,
        )


FROM_LIMITS = (0.0, 0.0)
"""Duration bounds that nobody gave."""


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
    duration_bounds: tuple[float, float] = FROM_LIMITS
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
        if self.duration_bounds == FROM_LIMITS:
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
