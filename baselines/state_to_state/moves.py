"""Ruckig between two states: the minimum time of one synchronised move, and its profiles as exact cubic pieces.

Only the local, state-to-state part of Ruckig is used. Its way of passing several points in one call belongs to a remote
service and has no place in this project.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import ruckig

from study.errors import StudyError
from study.problem import Floats, JointLimits, Problem, usual_bounds
from study.trajectory import Trajectory

MERGE = 1e-12
"""Knots of different joints that are closer than this part of the move count as one."""


class State(NamedTuple):
    """Where all joints are and how they move; arrays of shape (n_joints,)."""

    position: Floats
    velocity: Floats
    acceleration: Floats


def at_rest(position: Floats) -> State:
    """Stand still at a position, shape (n_joints,)."""
    return State(position, np.zeros_like(position), np.zeros_like(position))


class Mover:
    """Minimum-time moves of all joints together between two states under fixed limits.

    An infinite limit is passed on as it stands: Ruckig then solves a joint with infinite jerk by pieces of constant
    acceleration, and one with infinite acceleration by pieces of constant velocity.

    Parameters
    ----------
    limits : JointLimits
        The range of positions is not used; the judge looks at it.
    """

    def __init__(self, limits: JointLimits) -> None:
        self._input = ruckig.InputParameter(limits.n_joints)
        self._output = ruckig.Trajectory(limits.n_joints)
        self._solver = ruckig.Ruckig(limits.n_joints)
        self._solved, self._error = (ruckig.Result.Working, ruckig.Result.Finished), ruckig.RuckigError
        self._input.max_velocity = limits.velocity.tolist()
        self._input.max_acceleration = limits.acceleration.tolist()
        self._input.max_jerk = limits.jerk.tolist()

    def solve(self, start: State, end: State) -> bool:
        """Solve one move; False where Ruckig finds none, as for a move of more than its 7600 s."""
        given = self._input
        given.current_position, given.target_position = start.position.tolist(), end.position.tolist()
        given.current_velocity, given.target_velocity = start.velocity.tolist(), end.velocity.tolist()
        given.current_acceleration, given.target_acceleration = start.acceleration.tolist(), end.acceleration.tolist()
        try:
            return self._solver.calculate(given, self._output) in self._solved
        except (self._error, ValueError):  # ValueError: a result code that its Python enumeration lacks
            return False

    def times(self, start: State, end: State) -> tuple[float, Floats]:
        """Minimum time of one move and of every joint alone, shape (n_joints,), s; infinite where Ruckig finds none."""
        if not self.solve(start, end):
            return np.inf, np.full(len(start.position), np.inf)
        return float(self._output.duration), np.array(self._output.independent_min_durations)

    def pieces(self, start: State, end: State) -> tuple[Floats, Floats]:
        """Solve one move and read it as cubic pieces.

        Returns
        -------
        widths : array of shape (n_pieces,), s
        coefficients : array of shape (n_pieces, 4, n_joints)
            Ascending powers of the time since the piece's own start.

        Raises
        ------
        StudyError
            If Ruckig finds no move.
        """
        if not self.solve(start, end):
            raise StudyError(f"Ruckig finds no move from {start.position.tolist()} to {end.position.tolist()}")
        return merge([_phases(profile) for profile in self._output.profiles[0]], float(self._output.duration))


@dataclass(frozen=True, eq=False)
class _Phases:
    """One joint's phases of constant jerk: start times (n_phases,), s, and cubic coefficients (n_phases, 4)."""

    starts: Floats
    coefficients: Floats


def _phases(profile: Any) -> _Phases:
    """Read a joint's brake phases, its seven phases and what follows them."""
    brake = profile.brake
    widths = np.array([*brake.t, *profile.t])
    rows = ([*brake.p, *profile.p], [*brake.v, *profile.v], [*brake.a, *profile.a], [*brake.j, *profile.j, 0.0])
    starts = np.concatenate([[0.0], np.cumsum(widths)])
    used = np.append(widths > 0, True)
    return _Phases(starts[used], np.array(rows).T[used] / np.array([1.0, 1.0, 2.0, 6.0]))


def merge(phases: Sequence[_Phases], duration: float) -> tuple[Floats, Floats]:
    """Cut all joints' phases at the union of their knots."""
    inner = np.sort(np.concatenate([joint.starts for joint in phases]))
    gap = MERGE * duration
    inner = inner[(inner > gap) & (inner < duration - gap)]
    inner = inner[np.diff(inner, prepend=0.0) > gap]
    knots = np.concatenate([[0.0], inner, [duration]])
    middles = (knots[1:] + knots[:-1]) / 2
    columns = []
    for joint in phases:
        index = np.searchsorted(joint.starts, middles, side="right") - 1
        columns.append(shifted(joint.coefficients[index], knots[:-1] - joint.starts[index]))
    return np.diff(knots), np.stack(columns, axis=2)


def shifted(cubic: Floats, by: Floats) -> Floats:
    """Cubics, shape (n, 4), rewritten about a later origin, shape (n,): Taylor's formula."""
    c0, c1, c2, c3 = cubic.T
    return np.stack(
        [c0 + by * (c1 + by * (c2 + by * c3)), c1 + by * (2 * c2 + 3 * by * c3), c2 + 3 * by * c3, c3], axis=1
    )


def chain(problem: Problem, states: Sequence[State]) -> Trajectory:
    """Join the minimum-time moves between consecutive states, one state at every waypoint.

    Every move starts from its own waypoint, so rounding does not add up. A move between two equal states at rest takes
    no time and has no piece.

    Raises
    ------
    StudyError
        If Ruckig finds no move between two states, or nothing moves at all.
    """
    mover = Mover(problem.limits)
    widths, coefficients, counts = [], [], []
    for start, end in pairwise(states):
        if _stands_still(start, end):
            counts.append(0)
            continue
        width, cubic = mover.pieces(start, end)
        widths.append(width)
        coefficients.append(cubic)
        counts.append(len(width))
    if not widths:
        raise StudyError(f"case {problem.name!r}: all waypoints are equal, so there is nothing to move")
    return Trajectory.from_pieces(np.concatenate(widths), np.concatenate(coefficients), np.array(counts))


def in_own_time(problem: Problem) -> tuple[Problem, float]:
    """Measure time in a unit in which moves take seconds: Ruckig's tolerances are absolute, and it refuses hours.

    Returns
    -------
    problem : Problem
        The same one with limits per unit; its motions, scaled by the unit, are the given problem's.
    unit : float, s
        A power of two, so that scaling is exact; 1 for moves between hundredths of a second and a quarter of an hour.
    """
    longest = usual_bounds(problem.waypoints, problem.limits)[1] / 10
    if 1e-2 < longest < 1e3:
        return problem, 1.0
    unit = float(2.0 ** np.round(np.log2(longest)))
    low, high = problem.duration_bounds
    return replace(problem, limits=problem.limits.scaled(1 / unit), duration_bounds=(low / unit, high / unit)), unit


def _stands_still(start: State, end: State) -> bool:
    return np.array_equal(start.position, end.position) and not any(a.any() for a in (*start[1:], *end[1:]))
