"""Minimum-time moves between two states by Ruckig, their profiles as exact cubic pieces.

Only the local, state-to-state part of Ruckig is used. Its way of passing several points in one call belongs to a remote
service and has no place in this project.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import ruckig

from baselines.base import NOTHING_MOVES
from baselines.units import Units, dimensionless
from study import polynomial
from study.errors import StudyError
from study.problem import Floats, JointLimits, Problem, usual_bounds
from study.trajectory import Trajectory

MERGE = 1e-12
"""Knots of different joints that are closer than this part of the move count as one."""


class State(NamedTuple):
    """Position, velocity and acceleration of all joints; arrays of shape (n_joints,)."""

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
        self._input.max_jerk = limits.rates[2].tolist()  # Ruckig knows no other one backwards
        if not limits.symmetric:
            self._input.min_velocity, self._input.min_acceleration = limits.lowest_rates[:2].tolist()

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
        return merge(*_phases(self._output.profiles[0]), float(self._output.duration))


def _phases(profiles: Sequence[Any]) -> tuple[Floats, Floats]:
    """Phases of constant jerk of all joints: two brake phases, seven more, and what follows; some take no time.

    Returns
    -------
    starts : array of shape (n_joints, 10), s
    cubics : array of shape (n_joints, 10, 4)
    """
    widths = np.array([[*profile.brake.t, *profile.t] for profile in profiles])
    rows = [
        ([*brake.p, *profile.p], [*brake.v, *profile.v], [*brake.a, *profile.a], [*brake.j, *profile.j, 0.0])
        for brake, profile in ((profile.brake, profile) for profile in profiles)
    ]
    starts = np.concatenate([np.zeros((len(widths), 1)), np.cumsum(widths, axis=1)], axis=1)
    return starts, np.moveaxis(np.array(rows), 1, 2) / np.array([1.0, 1.0, 2.0, 6.0])


def merge(starts: Floats, cubics: Floats, duration: float) -> tuple[Floats, Floats]:
    """Cut all joints' phases at the union of their knots."""
    inner = np.sort(starts.ravel())
    gap = MERGE * duration
    inner = inner[(inner > gap) & (inner < duration - gap)]
    inner = inner[np.diff(inner, prepend=0.0) > gap]
    knots = np.concatenate([[0.0], inner, [duration]])
    middles = (knots[1:] + knots[:-1]) / 2
    joint = np.arange(len(starts))[:, None]
    phase = (starts[:, None] <= middles[:, None]).sum(axis=2) - 1
    pieces = polynomial.shifted(cubics[joint, phase], knots[:-1] - starts[joint, phase])
    return np.diff(knots), np.moveaxis(pieces, 0, 2)


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
        if stands_still(start, end):
            counts.append(0)
            continue
        width, cubic = mover.pieces(start, end)
        widths.append(width)
        coefficients.append(cubic)
        counts.append(len(width))
    if not widths:
        raise StudyError(f"case {problem.name!r}: {NOTHING_MOVES}")
    return Trajectory.from_pieces(np.concatenate(widths), np.concatenate(coefficients), np.array(counts))


def stop_everywhere(problem: Problem) -> Trajectory:
    """Join the minimum-time moves from rest to rest.

    Raises
    ------
    StudyError
        If Ruckig finds no move, or nothing moves at all.
    """
    return chain(problem, [at_rest(row) for row in problem.waypoints])


def in_own_time(problem: Problem) -> tuple[Problem, Units]:
    """Measure time in a unit in which moves take seconds: Ruckig's tolerances are absolute, and it refuses hours.

    The unit is a power of two, so that scaling is exact, and 1 s for moves between hundredths of a second and a quarter
    of an hour.
    """
    longest = usual_bounds(problem.waypoints, problem.limits)[1] / 10
    unit = 1.0 if 1e-2 < longest < 1e3 else float(2.0 ** np.round(np.log2(longest)))
    return dimensionless(problem, unit, np.ones(problem.n_joints))


def stands_still(start: State, end: State) -> bool:
    """Whether two states are one, at rest."""
    return np.array_equal(start.position, end.position) and not any(a.any() for a in (*start[1:], *end[1:]))
