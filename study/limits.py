"""Limits of the joints: velocity, acceleration and jerk in each direction, and the range of positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from study.arrays import Floats, at_least_zero, frozen_array, index_in, positive
from study.errors import StudyError, joint_error

RATES = ("velocity", "acceleration", "jerk")

LARGEST = 1e60
"""Largest position or limit, and the inverse of the smallest limit, whose products double precision can hold."""

OPTIONAL: Any = None
"""Default of a field that may be left out, and that the object fills in; `Any`, because the filled field is no `None`."""


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Limits on the rates and positions of every joint; infinity, or None for a whole field, means no limit.

    Parameters
    ----------
    velocity : array of shape (n_joints,), rad/s or m/s
        In the positive direction, and in the negative one unless `min_velocity` says otherwise.
    acceleration : array of shape (n_joints,), rad/s^2 or m/s^2, optional
    jerk : array of shape (n_joints,), rad/s^3 or m/s^3, optional
    lower, upper : arrays of shape (n_joints,), rad or m, optional
        The range of positions.
    min_velocity, min_acceleration, min_jerk : arrays of shape (n_joints,), same units, optional
        Negative limits in the negative direction; by default the opposite of the positive ones.

    Raises
    ------
    StudyError
        If lengths differ, a limit has the wrong sign or is not a number, or a range of positions is empty.
    """

    velocity: Floats
    acceleration: Floats = OPTIONAL
    jerk: Floats = OPTIONAL
    lower: Floats = OPTIONAL
    upper: Floats = OPTIONAL
    min_velocity: Floats | None = None
    min_acceleration: Floats | None = None
    min_jerk: Floats | None = None

    def __post_init__(self) -> None:
        shape = self._shape()
        for name in RATES:
            self._set(name, getattr(self, name), np.inf, shape)
            if getattr(self, f"min_{name}") is not None:  # else the opposite of the positive one, also after `replace`
                self._set(f"min_{name}", getattr(self, f"min_{name}"), -np.inf, shape)
            self._check_signs(name)
        self._set("lower", self.lower, -np.inf, shape)
        self._set("upper", self.upper, np.inf, shape)
        if (self.lower >= self.upper).any():
            joint = int(np.argmax(self.lower >= self.upper))
            ends = self.lower[joint], self.upper[joint]
            raise joint_error("position limits of {joint} are empty: lower {0}, upper {1}", joint, *ends)

    def _shape(self) -> tuple[int]:
        shape = np.shape(frozen_array([] if self.velocity is None else self.velocity, "velocity limits"))
        if len(shape) != 1 or not shape[0]:
            raise StudyError(f"velocity limits must be a list with one number per joint, got shape {shape}")
        return (shape[0],)

    def _set(self, name: str, given: ArrayLike | None, default: ArrayLike, shape: tuple[int]) -> None:
        array = frozen_array(default if given is None else given, f"{name} limits")
        if array.shape not in (shape, ()):
            raise StudyError(f"{name} limits must have one number for each of {shape[0]} joints, got {array.size}")
        object.__setattr__(self, name, frozen_array(np.broadcast_to(array, shape), name))

    def _check_signs(self, name: str) -> None:
        order = 1 + RATES.index(name)
        for joint, (value, least) in enumerate(zip(getattr(self, name), self._lowest(name), strict=True)):
            if value <= 0:
                said = f"{name} limit of {{joint}} must be positive, got {{0}}; leave it out for no limit"
                raise joint_error(said, joint, value, order=order)
            if least >= 0:
                raise joint_error(
                    f"min_{name} limit of {{joint}} must be negative, got {{0}}", joint, least, order=order
                )
            for size in (value, -least):
                if np.isfinite(size) and not 1 / LARGEST <= size <= LARGEST:
                    raise StudyError(
                        f"{name} limit of joint {joint + 1} must be between {1 / LARGEST:g} and {LARGEST:g}, got {size:g}; "
                        "take other units"
                    )

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self.velocity)

    @property
    def highest_rates(self) -> Floats:
        """Limits in the positive direction, shape (3, n_joints), positive."""
        return np.stack([self.velocity, self.acceleration, self.jerk])

    @property
    def lowest_rates(self) -> Floats:
        """Limits in the negative direction, shape (3, n_joints), negative."""
        return np.stack([self._lowest(name) for name in RATES])

    def _lowest(self, name: str) -> Floats:
        least: Floats | None = getattr(self, f"min_{name}")
        return -np.asarray(getattr(self, name)) if least is None else least

    @property
    def rates(self) -> Floats:
        """Velocity, acceleration and jerk that both directions allow, shape (3, n_joints)."""
        return np.minimum(self.highest_rates, -self.lowest_rates)

    @property
    def symmetric(self) -> bool:
        """Whether both directions have the same limits."""
        return bool((self.highest_rates == -self.lowest_rates).all())

    def joint(self, index: int) -> JointLimits:
        """Limits of one joint alone."""
        pick = slice(index_in(index, range(self.n_joints), "joint"), index + 1)
        given = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return replace(self, **{name: limits[pick] for name, limits in given.items() if limits is not None})

    def scaled(self, factor: float) -> JointLimits:
        """Limits under which every motion takes exactly `factor` times as long: divided by factor, its square, its cube."""
        factor, changes = positive(factor, "the factor on all times"), {}
        for order, name in enumerate(RATES, start=1):
            for each in (name, f"min_{name}"):
                if (limit := getattr(self, each)) is not None:
                    with np.errstate(over="ignore", divide="ignore", under="ignore", invalid="ignore"):
                        changes[each] = limit / np.float64(factor) ** order
                    if not np.isfinite(changes[each][np.isfinite(limit)]).all() or not changes[each].all():
                        raise StudyError(
                            f"a factor of {factor:g} on all times leaves no {name} limits that numbers can hold"
                        )
        return replace(self, **changes)

    def widened(self, share: float) -> JointLimits:
        """Limits whose rates are wider by a share of themselves; ranges of positions stay."""
        at_least_zero(share, "the share by which limits are wider")
        given = {name: getattr(self, name) for name in (*RATES, *(f"min_{rate}" for rate in RATES))}
        with np.errstate(over="ignore"):  # a limit that no number can hold is none
            return replace(self, **{name: rate * (1.0 + share) for name, rate in given.items() if rate is not None})


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
    steps = np.diff(waypoints, axis=0)
    steps = steps[steps.any(axis=1)]
    if not len(steps):
        return 1e-3, 10.0
    at_full_speed = np.maximum(steps / limits.velocity, steps / limits.lowest_rates[0]).max(axis=1)
    moved = np.abs(steps)
    each = [at_full_speed, np.sqrt(4 * moved / limits.rates[1]).max(axis=1)]
    stops = np.sum([*each, np.cbrt(32 * moved / limits.rates[2]).max(axis=1)], axis=0)
    lower = float(at_full_speed.min() or 0.01 * stops.min() or 1e-3)
    return lower, 10 * max(float(stops.max()), lower)
