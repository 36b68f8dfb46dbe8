"""Times of Ruckig's moves through the waypoints as a function of the states there, and their linear model."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baselines.state_to_state.moves import Mover, State
from study.problem import EndCondition, Floats, Problem

STEP = 1e-6
"""Step of the finite differences, as a part of the variables' units."""

BEYOND = 100.0
"""Bound of a variable, in units, whose rate has no limit."""

BLOCKED = 1e-9
"""Relative excess of a move's time over all its joints' own times from which on it counts as blocked."""


@dataclass(frozen=True, eq=False)
class ViaStates:
    """Decision variables: velocity and acceleration at the waypoints, shape (2 rates, n_waypoints, n_joints).

    Attributes
    ----------
    problem : Problem
    scale : array of shape (2, n_joints)
        Units of velocity and acceleration: the limits, or what the other limits allow over the joint's range.
    bound : array of shape (2, n_joints)
        Largest absolute value: 1 where the rate has a limit, much more where it has none.
    free : bool array of shape (2, n_waypoints, n_joints)
        Velocities of joints with an acceleration or jerk limit, accelerations of joints with a jerk limit; at both ends
        what the end condition leaves free. A joint that does not move stays at rest.
    """

    problem: Problem
    scale: Floats
    bound: Floats
    free: NDArray[np.bool_]

    @classmethod
    def of(cls, problem: Problem) -> ViaStates:
        """Choose the variables that the limits and the end condition leave free."""
        limited = np.isfinite(problem.limits.rates)
        free = np.zeros((2, *problem.waypoints.shape), dtype=bool)
        moves = np.ptp(problem.waypoints, axis=0) > 0
        free[0], free[1] = limited[1:].any(axis=0) & moves, limited[2] & moves
        if problem.end is not EndCondition.FREE:
            free[0, [0, -1]] = False
        if problem.end is EndCondition.SMOOTH:
            free[1, [0, -1]] = False
        return cls(problem, _units(problem), np.where(limited[:2], 1.0, BEYOND), free)

    def states(self, x: Floats, which: slice = slice(None)) -> list[State]:
        """States at the waypoints, or at some of them, for variables x.

        Where |v| + a^2 / (2 J) > V the velocity limit is broken before or after the waypoint: the acceleration gives
        way.
        """
        velocity, acceleration, jerk = self.problem.limits.rates
        v = np.clip(x[0] * self.scale[0], -velocity, velocity)
        with np.errstate(invalid="ignore"):
            room = np.where(np.isinf(jerk) | np.isinf(velocity), np.inf, np.sqrt(2 * jerk * (velocity - np.abs(v))))
        most = np.minimum(acceleration, room) * (1 - 1e-9)  # Ruckig refuses a state beyond a limit by rounding
        a = np.clip(x[1] * self.scale[1], -most, most)
        return [State(*row) for row in zip(self.problem.waypoints[which], v, a, strict=True)]

    def variables(self, velocity: Floats, acceleration: Floats) -> Floats:
        """Variables of given velocities and accelerations, both of shape (n_waypoints, n_joints)."""
        rates = np.stack([velocity, acceleration])
        x = np.divide(rates, self.scale[:, None], out=np.zeros_like(rates), where=self.scale[:, None] > 0)
        return np.where(self.free, np.clip(x, -self.bound[:, None], self.bound[:, None]), 0.0)


def _units(problem: Problem) -> Floats:
    """Limits of velocity and acceleration; without one, what the higher limits allow over the joint's range."""
    velocity, acceleration, jerk = problem.limits.rates
    span = np.ptp(problem.waypoints, axis=0)
    limited = np.isfinite(jerk)
    by_jerk = np.where(limited, np.cbrt(span * np.square(np.where(limited, jerk, 0.0))), np.inf)
    a = np.where(np.isfinite(acceleration), acceleration, by_jerk)
    a = np.where(np.isfinite(a), a, 0.0)
    return np.stack([np.where(np.isfinite(velocity), velocity, np.sqrt(span * a)), a])


class Model(NamedTuple):
    """Times of all moves around some via states.

    Attributes
    ----------
    times : array of shape (n_segments,), s
    own : array of shape (n_segments, n_joints), s
        What each joint would need alone.
    slopes : array of shape (2 sides, 2 rates, n_segments, n_joints), s
        Derivatives of the joints' own times by the variables at either side of a segment.
    blocked : list of pairs (segment, array of shape (2 rates, 2 sides, n_joints))
        Moves that take longer than every joint alone, with the derivatives of their time. A joint may be able to arrive
        early and much later but not in between; if another joint is late, it has to take the later time.
    """

    times: Floats
    own: Floats
    slopes: Floats
    blocked: list[tuple[int, Floats]]


class Timing:
    """Ask Ruckig for the times of all moves.

    Parameters
    ----------
    via : ViaStates
    """

    def __init__(self, via: ViaStates) -> None:
        self.via = via
        self._mover = Mover(via.problem.limits)

    def moves(self, x: Floats) -> tuple[Floats, Floats]:
        """Time of every move, shape (n_segments,), and every joint's own, shape (n_segments, n_joints), s."""
        totals, own = zip(*(self._mover.times(*ends) for ends in pairwise(self.via.states(x))), strict=True)
        return np.array(totals), np.array(own)

    def model(self, x: Floats, times: Floats, own: Floats) -> Model:
        """Linear model of all times around variables x, by differences that step into the box."""
        return Model(times, own, self._slopes(x, own), self._blocked(x, times, own))

    def _slopes(self, x: Floats, own: Floats) -> Floats:
        """As no joint changes another's own time, one look at all moves differentiates for every second waypoint."""
        result = np.zeros((2, 2, *own.shape))
        segments = np.arange(len(own))
        for parity, rate in np.ndindex(2, 2):
            if not self.via.free[rate].any():
                continue
            inward = np.where(x[rate] > 0, -STEP, STEP)
            moved = x.copy()
            moved[rate, parity::2] += inward[parity::2]
            with np.errstate(invalid="ignore"):
                change = self.moves(moved)[1] - own
            for side in range(2):
                mine = (segments + side) % 2 == parity
                result[side, rate, mine] = change[mine] / inward[segments[mine] + side]
        return np.nan_to_num(result, posinf=0.0, neginf=0.0)

    def _blocked(self, x: Floats, times: Floats, own: Floats) -> list[tuple[int, Floats]]:
        blocked = []
        for i in np.flatnonzero(times > own.max(axis=1) * (1 + BLOCKED)):
            slope = np.zeros((2, 2, own.shape[1]))
            for rate, side, joint in np.argwhere(self.via.free[:, i : i + 2]):
                near = x[:, i : i + 2].copy()
                step = -STEP if near[rate, side, joint] > 0 else STEP
                near[rate, side, joint] += step
                start, end = self.via.states(near, slice(i, i + 2))
                slope[rate, side, joint] = (self._mover.times(start, end)[0] - times[i]) / step
            blocked.append((int(i), np.nan_to_num(slope, posinf=0.0, neginf=0.0)))
        return blocked
