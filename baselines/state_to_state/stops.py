"""Minimum-time moves from rest to rest between neighbouring waypoints, as a controller drives them without planning.

References
----------
L. Berscheid, T. Kroeger, Jerk-limited real-time trajectory generation with arbitrary target states, RSS 2021.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise
from typing import ClassVar

import numpy as np

from baselines.base import NOTHING_MOVES, Deterministic, along, segment_rates, where_something_moves
from baselines.closed_forms import rest_to_rest_time
from baselines.state_to_state.moves import Mover, State, at_rest, in_own_time, stands_still
from study.errors import StudyError
from study.judge import judge
from study.planning import Plan, RunSettings, Status
from study.problem import Demand, Floats, JointLimits, Problem
from study.trajectory import Trajectory

Pieces = tuple[Floats, Floats]
ROUNDING = 1e-6
"""Share of a closed form that is left to rounding, more than Ruckig's own."""


def ruckig_stops(problem: Problem) -> Trajectory:
    """Stop at every waypoint, all joints synchronised, each move in minimum time.

    Where a joint has no jerk limit its acceleration may step; where it has no acceleration limit either, its velocity
    may step, also at both ends, and the move takes the distance over the velocity limit. Where the problem has a rule
    for the path, every move is straight.

    Raises
    ------
    StudyError
        If no joint moves, a joint that moves has no limit at all, or there is no way to last as long as demanded.
    """
    unit = in_own_time(problem)[1].time
    every = [problem.limits.scaled(1 / unit)] * problem.n_segments
    if problem.segment_limits:
        powers = unit ** np.arange(1, 4)[:, None, None]
        every = _limits(*(rates * powers for rates in segment_rates(problem)))
    move = partial(_moved, lru_cache(maxsize=1)(Mover)) if problem.path is None else _on_line
    moves = [
        None if stands_still(*ends) else move(*ends, limits)
        for ends, limits in zip(pairwise(_states(problem, unit)), every, strict=True)
    ]
    if not any(moves):
        raise StudyError(f"case {problem.name!r}: {NOTHING_MOVES}")
    dwells = np.array([problem.dwells.get(k, 0.0) for k in range(problem.n_waypoints)]) / unit
    motion = _joined(problem, moves, dwells)
    if problem.timing is not None and not problem.scalable:
        dwells[1] += _wait(problem, motion.duration * unit) / unit
        motion = _joined(problem, moves, dwells)
    return motion.scaled(unit)


def _states(problem: Problem, unit: float) -> list[State]:
    """Rest at every waypoint; at the ends the rates that are given."""
    states = [at_rest(row) for row in problem.waypoints]
    for place, end in zip((0, -1), problem.end_states, strict=True):
        rates = [0.0 * states[place].position if rate is None else rate for rate in end.rates]
        states[place] = State(states[place].position, rates[0] * unit, rates[1] * unit**2)
    return states


def _limits(lowest: Floats, highest: Floats) -> list[JointLimits]:
    """Limits of every segment from arrays of shape (3, n_segments, n_joints)."""
    names = ("min_velocity", "min_acceleration", "min_jerk")
    segments = zip(np.moveaxis(lowest, 1, 0), np.moveaxis(highest, 1, 0), strict=True)
    return [JointLimits(*high, **dict(zip(names, low, strict=True))) for low, high in segments]


def _moved(mover: Callable[[JointLimits], Mover], start: State, end: State, limits: JointLimits) -> Pieces:
    return mover(limits).pieces(start, end)


def _on_line(start: State, end: State, limits: JointLimits) -> Pieces:
    """Move one scalar, the distance along the line, and every joint with it."""
    step = end.position - start.position
    length = float(np.linalg.norm(step))
    direction = step / length
    rates = [rate @ direction for rate in (*start[1:], *end[1:])]
    if not np.allclose(np.outer(rates, direction), [*start[1:], *end[1:]], rtol=1e-9, atol=1e-12):
        raise StudyError("a given rate at an end does not point along the straight line there")
    both = (limits.lowest_rates, limits.highest_rates)
    scalar = _limits(-along(-direction, *both)[:, None, None], along(direction, *both)[:, None, None])[0]
    first, last = (
        State(np.array([x]), np.array([v]), np.array([a])) for x, v, a in ((0.0, *rates[:2]), (length, *rates[2:]))
    )
    widths, distances = Mover(scalar).pieces(first, last)
    cubics = distances * direction
    cubics[:, 0] += start.position
    return widths, cubics


def _joined(problem: Problem, moves: list[Pieces | None], dwells: Floats) -> Trajectory:
    """Join moves; the time at a waypoint, s, follows the arrival there."""
    widths, cubics, counts = [], [], []
    for segment, move in enumerate(moves):
        pieces = [] if move is None else [move]
        if dwells[segment] > 0:
            still = np.zeros((1, 4, problem.n_joints))
            still[0, 0] = problem.waypoints[segment]
            pieces.insert(0, (dwells[segment, None], still))
        counts.append(sum(len(width) for width, _ in pieces))
        widths += [width for width, _ in pieces]
        cubics += [cubic for _, cubic in pieces]
    return Trajectory.from_pieces(np.concatenate(widths), np.concatenate(cubics), np.array(counts))


def _wait(problem: Problem, duration: float) -> float:
    """Time to spend at the first stop, s, so that a motion lasts as long as demanded; it cannot be run more slowly."""
    longer = 0.0 if problem.timing is None else duration * (problem.timing.stretch(duration) - 1.0)
    if longer > 0 and problem.n_waypoints < 3:
        raise StudyError("the motion is in motion at its ends and has no stop at which it could wait")
    return longer


@dataclass(frozen=True)
class RuckigStops(Deterministic):
    """Planner `ruckig-stops`: rest to rest between neighbouring waypoints."""

    about: ClassVar[str] = "Ruckig from waypoint to waypoint, with a stop at each"
    knows: ClassVar[frozenset[Demand]] = frozenset(Demand)

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Move and stop, waypoint by waypoint; the settings do not matter."""
        motion = ruckig_stops(problem)
        if not problem.scalable and (reasons := judge(problem, motion).reasons):  # moving, it may leave its range
            return Plan(Status.FAILED, message=f"the move from or to the given rates {'; '.join(reasons)}")
        return Plan(Status.FINISHED, motion=motion)

    def least(self, problem: Problem) -> float:
        """Time that the motion takes at least, s, in closed form; moves from or to given rates count as nothing."""
        if problem.timing is not None:
            return 0.0
        rates = np.maximum(-segment_rates(problem)[0], segment_rates(problem)[1])
        moves = rest_to_rest_time(np.diff(problem.waypoints, axis=0), rates).max(axis=1)
        for place, end in zip((0, -1), problem.end_states, strict=True):
            moves[place] *= not end.moving
        return float(moves.sum() + sum(problem.dwells.values())) * (1 - ROUNDING)
