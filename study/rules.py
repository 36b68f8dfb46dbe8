"""Rules that a motion may have to follow besides limits: states at its ends, the shape of its path, its duration."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from study.arrays import Floats, frozen_array, positive
from study.errors import StudyError, joint_error, listed, short
from study.limits import OPTIONAL, RATES, JointLimits


class EndCondition(Enum):
    """Conditions at the first and last instant."""

    FREE = "may start and end in motion"
    REST = "starts and ends at rest"
    SMOOTH = "starts and ends at rest with zero acceleration"

    @classmethod
    def _missing_(cls, value: object) -> None:
        """Refuse anything else.

        Raises
        ------
        StudyError
            Naming the conditions.
        """
        raise StudyError(f"an end condition is {listed([str(each) for each in cls])}, got {short(value)}")


@dataclass(frozen=True, eq=False)
class State:
    """Rates that a motion must have at its first or last instant; a rate that is left out is free.

    Parameters
    ----------
    velocity : array of shape (n_joints,), rad/s or m/s, optional
    acceleration : array of shape (n_joints,), rad/s^2 or m/s^2, optional

    Raises
    ------
    StudyError
        If a rate is not a list of finite numbers.
    """

    velocity: Floats | None = None
    acceleration: Floats | None = None

    def __post_init__(self) -> None:
        for name in ("velocity", "acceleration"):
            if getattr(self, name) is not None:
                array = frozen_array(getattr(self, name), f"end state: {name}")
                if array.ndim != 1 or not np.isfinite(array).all():
                    raise StudyError(f"end state: {name} must be a list with one finite number per joint")
                object.__setattr__(self, name, array)

    @classmethod
    def under(cls, condition: EndCondition, n_joints: int) -> Self:
        """State that a plain end condition stands for."""
        zero = np.zeros(n_joints)
        held = list(EndCondition).index(condition)
        return cls(zero if held >= 1 else None, zero if held >= 2 else None)

    @property
    def condition(self) -> EndCondition | None:
        """Plain end condition that says the same; None where a rate is given and not zero, or only acceleration is."""
        if self.moving or (self.velocity is None and self.acceleration is not None):
            return None
        return list(EndCondition)[(self.velocity is not None) + (self.acceleration is not None)]

    @property
    def moving(self) -> bool:
        """Whether a given rate is not zero."""
        return any(rate is not None and bool(rate.any()) for rate in self.rates)

    @property
    def rates(self) -> tuple[Floats | None, Floats | None]:
        """Velocity and acceleration."""
        return self.velocity, self.acceleration

    def check(self, limits: JointLimits, where: str) -> None:
        """Refuse rates of another number of joints, or beyond the limits."""
        for order, (name, rate) in enumerate(zip(RATES, self.rates, strict=False)):
            if rate is None:
                continue
            if len(rate) != limits.n_joints:
                raise StudyError(
                    f"{where}: end {name} must have one number for each of {limits.n_joints} joints, got {len(rate)}"
                )
            beyond = (rate > limits.highest_rates[order]) | (rate < limits.lowest_rates[order])
            if beyond.any():
                joint = int(np.argmax(beyond))
                values = rate[joint], limits.lowest_rates[order][joint], limits.highest_rates[order][joint]
                said = f"end {name} of {{joint}}, {{0}}, is beyond its limits {{1}} and {{2}}"
                raise joint_error(said, joint, *values, order=order + 1, where=where)

    def joint(self, index: int) -> State:
        """State of one joint alone."""
        return State(*(None if rate is None else rate[index : index + 1] for rate in self.rates))


def alone(state: State | EndCondition | None, joint: int) -> State | EndCondition | None:
    """End condition of one joint alone."""
    return state.joint(joint) if isinstance(state, State) else state


@dataclass(frozen=True, eq=False)
class _Radius:
    """One positive radius for all joints, or one for each."""

    radius: Floats = OPTIONAL

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", frozen_array(0.0 if self.radius is None else self.radius, self._words))
        if self.radius.ndim > 1 or not (self.radius >= 0).all() or not np.isfinite(self.radius).all():
            raise StudyError(f"{self._words} must be one number that is not negative, or one for each joint")

    @property
    def _words(self) -> str:
        return f"the radius of a {type(self).__name__}"

    def joint(self, index: int) -> Self:
        """Rule of one joint alone."""
        return type(self)(self.radius if self.radius.ndim == 0 else self.radius[index : index + 1])

    def of(self, n_joints: int) -> Floats:
        """Radius of every joint, shape (n_joints,), rad or m."""
        if self.radius.ndim and len(self.radius) != n_joints:
            raise StudyError(
                f"{self._words} must have one number for each of {n_joints} joints, got {len(self.radius)}"
            )
        return np.broadcast_to(self.radius, (n_joints,))


class StraightPath(_Radius):
    """Straight from waypoint to waypoint in the joints' space; near an inner waypoint the corner may be cut.

    Parameters
    ----------
    radius : float or array of shape (n_joints,), rad or m, optional
        Where every joint is at most so far from an inner waypoint, the motion may leave the straight lines and pass the
        waypoint at that distance. By default 0: it must then stop at every corner.
    """


class Tube(_Radius):
    """A path that stays near the straight lines from waypoint to waypoint.

    Parameters
    ----------
    radius : float or array of shape (n_joints,), rad or m
        While the motion is between two waypoints, some point of the straight line between the two has every joint
        within so much of the motion.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (self.radius > 0).all():
            raise StudyError(f"{self._words} must be positive; a path without any room is a StraightPath")


PathRule = StraightPath | Tube

UNCOUNTED = 2.0**53
"""Cycles from which on a duration has no digits for one more: every duration is a whole number of them."""


@dataclass(frozen=True)
class Timing:
    """Constraint on the duration of a motion.

    Parameters
    ----------
    exactly : float, s, optional
    at_least : float, s, optional
    cycle : float, s, optional
        The duration must be a whole number of control cycles of this length.

    Raises
    ------
    StudyError
        If a time is not a positive number, or the demands contradict each other.
    """

    exactly: float | None = None
    at_least: float | None = None
    cycle: float | None = None

    def __post_init__(self) -> None:
        for name in ("exactly", "at_least", "cycle"):
            given: Any = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, positive(given, f"timing: {name}"))
        if self.exactly is not None and self.excess(self.exactly) > 1e-9:
            raise StudyError(f"timing: a duration of exactly {self.exactly:g} s contradicts the other demands on it")

    def excess(self, duration: float) -> float:
        """Largest relative error of a duration; 0 or negative where every demand is met."""
        errors = [0.0]
        if self.exactly is not None:
            errors.append(abs(duration - self.exactly) / self.exactly)
        if self.at_least is not None:
            errors.append((self.at_least - duration) / self.at_least)
        if self.cycle is not None and duration / self.cycle < UNCOUNTED:
            errors.append(abs(duration - max(round(duration / self.cycle), 1) * self.cycle) / self.cycle)
        return max(errors)

    def stretch(self, duration: float) -> float:
        """Smallest slow-down factor, at least 1, after which a motion of this duration meets every demand.

        Raises
        ------
        StudyError
            If the motion takes longer than the duration that is demanded exactly.
        """
        if self.exactly is not None:
            if duration > self.exactly * (1 + 1e-9):
                raise StudyError(f"the motion takes {duration:.6g} s, longer than the {self.exactly:g} s it must take")
            return self.exactly / duration
        longer = max(duration, self.at_least or 0.0)
        if self.cycle is not None and longer / self.cycle < UNCOUNTED:
            longer = float(np.ceil(longer / self.cycle * (1 - 1e-12))) * self.cycle
        return max(1.0, float(longer) / duration)


def radii(values: ArrayLike, n_waypoints: int, n_joints: int, where: str) -> Floats:
    """Spread a tolerance over waypoints and joints.

    Parameters
    ----------
    values : float, array of shape (n_waypoints,) or array of shape (n_waypoints, n_joints), rad or m
    n_waypoints, n_joints : int
    where : str
        How a message begins.

    Returns
    -------
    array of shape (n_waypoints, n_joints)

    Raises
    ------
    StudyError
        If the shape is another one, or an entry is negative or infinite.
    """
    given = frozen_array(values, f"{where}: tolerance")
    if given.ndim == 1:
        given = given[:, None]
    if given.ndim == 2 and (len(given) != n_waypoints or given.shape[1] not in (1, n_joints)):
        raise StudyError(
            f"{where}: tolerance must be one number, one for each of {n_waypoints} waypoints, or a table of "
            f"{n_waypoints} rows and {n_joints} columns, got shape {np.shape(values)}"
        )
    if given.ndim > 2 or (given < 0).any() or not np.isfinite(given).all():
        raise StudyError(f"{where}: tolerance must hold finite numbers that are not negative")
    return frozen_array(np.broadcast_to(given, (n_waypoints, n_joints)), "tolerance")
