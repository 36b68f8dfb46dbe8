"""The free-path planner's phases: graded widths first, then widths of every joint's own, then a finish.

With widths that are fixed shares of the duration the problem is nearly convex, so that the first phase finds the right
valley from a plain start. The second one frees the widths, so that every joint can place its phases of full jerk and full
acceleration exactly. The third fixes the widths again where they came to be, which converges in a few iterations and
leaves nothing of the equations.

A range of positions is held only where a motion comes near it: the rows are added when it does, and the phase is run again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from baselines.free_path.interior_point import Ending, Goal, Outcome, frame_of, resumed, solve, started
from baselines.free_path.model import Model, model_of
from baselines.free_path.pieces import Point
from baselines.free_path.question import Flags, FreePathProblem
from baselines.free_path.realise import closed, leaves_range, realise, stretch
from baselines.free_path.start import graded, spline_start
from study.problem import Floats
from study.trajectory import Trajectory

ROUNDS = 6
"""How often rows of the range of positions are added."""

USUAL, MIDDLING, FEWEST = 8, 5, 3
"""Pieces per segment: usually, for many waypoints, and for waypoints in close order."""

CLOSE, MANY = 100, 500
"""Numbers of segments from which waypoints may stand in close order, and from which eight pieces cost too much."""

SWIFT = 0.3
"""Share of the time from stop to stop below which waypoints stand in close order."""

NEAR = 1e-3
"""Distance to the end of a range, in units of length, at which it begins to count."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What the phases gave.

    Attributes
    ----------
    motion : Trajectory
    ending : Ending
    iterations : int
    pieces : int
        Per segment and joint.
    stretch : float
        By how much the motion had to be slowed down, at least 1.
    """

    motion: Trajectory
    ending: Ending
    iterations: int
    pieces: int
    stretch: float


def free_path(question: FreePathProblem, pieces: int | None = None, deadline: float = np.inf) -> Answer:
    """Find a fastest motion.

    Parameters
    ----------
    question : FreePathProblem
        At least one joint moves and has a limit.
    pieces : int, optional
        Pieces per segment and joint, K, at least 3; by default `usual_pieces`.
    deadline : float, s
        On the clock of `time.monotonic`.
    """
    pieces = usual_pieces(question, deadline) if pieces is None else pieces
    held = np.zeros((question.n_segments, question.n_joints), dtype=bool)
    model = model_of(question, pieces, held)
    shares = graded(model)
    point, spent = spline_start(model, shares), 0
    for _ in range(ROUNDS):
        outcome = _fixed_then_free(model, shares, point, deadline)
        spent += outcome.iterations
        near = leaves_range(model, outcome.state.point, NEAR) & ~held
        if not near.any() or outcome.ending is Ending.LATE:
            break
        held |= _with_neighbours(near)
        model = model_of(question, pieces, held)
        point = _regraded(outcome.state.point, shares)
    return _answer(model, outcome, spent)


def usual_pieces(question: FreePathProblem, deadline: float = np.inf) -> int:
    """Choose the number of pieces per segment.

    Waypoints in close order along a smooth path are passed in a small part of the time from stop to stop. There acceleration
    changes little within a segment, and three pieces are enough; a first phase with three pieces tells.
    """
    if question.n_segments < CLOSE:
        return USUAL
    model = model_of(question, FEWEST)
    frame = frame_of(model, False, graded(model))
    outcome = solve(frame, started(frame, spline_start(model, graded(model)), 0.1), _goals(deadline)[0])
    share = float(outcome.state.point.durations @ model.tau / model.tau.sum())
    if share < SWIFT:
        return FEWEST
    return USUAL if question.n_segments < MANY else MIDDLING


def _goals(deadline: float) -> tuple[Goal, Goal, Goal]:
    """What each phase must reach."""
    return (
        Goal(barrier=1e-4, error=1e-2, iterations=100, deadline=deadline),
        Goal(barrier=1e-7, error=1e-3, iterations=120, deadline=deadline, centring=0.3, level=3e-6, damping=1e-3),
        Goal(barrier=1e-9, error=1e-6, iterations=60, deadline=deadline),
    )


def _with_neighbours(flags: Flags) -> Flags:
    wide = flags.copy()
    wide[1:] |= flags[:-1]
    wide[:-1] |= flags[1:]
    return wide


def _regraded(point: Point, shares: Floats) -> Point:
    return point._replace(widths=shares * point.durations[:, None, None])


def _fixed_then_free(model: Model, shares: Floats, point: Point, deadline: float) -> Outcome:
    goals = _goals(deadline)
    frame = frame_of(model, False, shares)
    first = solve(frame, started(frame, point, 0.1), goals[0])
    frame = frame_of(model, True, shares)
    second = solve(frame, resumed(frame, first.state, 1e-3), goals[1])
    widths = np.maximum(second.state.point.widths, 1e-12)
    frame = frame_of(model, False, widths / widths.sum(axis=2, keepdims=True))
    third = solve(frame, resumed(frame, second.state, 1e-7), goals[2])
    return replace(third, iterations=first.iterations + second.iterations + third.iterations)


def _answer(model: Model, outcome: Outcome, iterations: int) -> Answer:
    point = closed(model, outcome.state.point)
    factor = stretch(model, point) if model.question.scalable else 1.0
    motion = realise(model, point)
    return Answer(motion.scaled(factor) if factor > 1 else motion, outcome.ending, iterations, model.pieces, factor)
