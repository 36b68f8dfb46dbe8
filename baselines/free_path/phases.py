"""The free-path planner's phases: graded widths first, then widths of every joint's own, then a finish.

With widths that are fixed shares of the duration the problem is nearly convex, so that the first phase finds the right
valley from a plain start. The second one frees the widths, so that every joint can place its phases of full jerk and
full acceleration exactly. The third fixes the widths again where they came to be, which converges in a few iterations
and leaves nothing of the equations.

A range of positions is held only where a motion comes near it: the rows are added when it does, and the phase is run
again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from baselines.free_path.interior_point import Ending, Goal, Outcome, continued, frame_of, resumed, solve, started
from baselines.free_path.model import Model, model_of
from baselines.free_path.newton import Frame
from baselines.free_path.pieces import Point
from baselines.free_path.question import Flags, FreePathProblem
from baselines.free_path.realise import closed, leaves_range, realise, stretch
from baselines.free_path.start import graded, spline_start, swelling
from study.deadline import NEVER, Deadline
from study.trajectory import Trajectory

ROUNDS = 6
"""Number of rounds that add rows for the range of positions."""

USUAL, NO_JERK, MIDDLING, FEW, FEWEST = 8, 6, 5, 4, 3
"""Pieces per segment: usually, without jerk limits, for many waypoints, and for waypoints in close order, of which four
are for jerk limits and up to `CLOSE` segments."""

CLOSE, MANY = 100, 500
"""Numbers of segments from which waypoints count as in close order, and from which eight pieces cost too much."""

SWIFT, HOPEFUL = 0.3, 1.0
"""Share of the time from stop to stop below which waypoints stand in close order, and below which a spline that swells
and ebbs makes it worth while to look."""

NEAR = 1e-3
"""Distance to the end of a range, as a share of the joint's span, at which it counts once a motion leaves its range."""

OUTSIDE = 5e-7
"""Distance beyond the end of a range, as a share of the joint's span, that counts as leaving it."""

CLOSINGS = (1e-2, 1e-4)
"""Shares of a phase's error to which the equations are closed where a range is left by what is left of them."""

Begin = Outcome | Point | None
"""A first phase that is done, a motion to begin one with, or nothing."""


@dataclass(frozen=True, eq=False)
class Answer:
    """Solution after the last phase.

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


def free_path(
    question: FreePathProblem, pieces: int | None = None, deadline: Deadline = NEVER, freed: bool = True
) -> Answer:
    """Find a fastest motion; never slower than the one of the first phase alone.

    Parameters
    ----------
    question : FreePathProblem
        At least one joint moves and has a limit.
    pieces : int, optional
        Pieces per segment and joint, K, at least 3; by default `usual_pieces`.
    deadline : Deadline
    freed : bool
        Whether the widths are freed after the first phase.
    """
    begin: Begin = None
    if pieces is None:
        pieces, begin = usual_pieces(question, deadline)
    held, spent = np.zeros((question.n_segments, question.n_joints), dtype=bool), 0
    for _ in range(ROUNDS):
        model, first = _first_phase(question, pieces, held, begin, deadline)
        outcomes = [first]
        if first.ending is not Ending.LATE:
            outcomes += _freed(model, first, deadline) if freed else [_finished(model, first, deadline)]
        outcome = outcomes[-1]
        spent += outcome.iterations
        outside = leaves_range(model, outcome.state.point, -OUTSIDE)
        if not (outside & ~held).any() or outcome.ending is Ending.LATE:
            break
        held, begin = held | _with_neighbours(outside), outcome.state.point
    return _answer(model, outcomes, spent)


def _first_phase(
    question: FreePathProblem, pieces: int, held: Flags, begin: Begin, deadline: Deadline
) -> tuple[Model, Outcome]:
    """Solve with graded widths, and hold the range of positions, recorded in `held`, where the motion leaves it.

    The way around the end of a range is usually near the way through it, so the last motion is where to begin.
    """
    spent = 0
    while True:
        model = model_of(question, pieces, held)
        outcome = begin if isinstance(begin, Outcome) else _graded_from(model, begin, deadline)
        if outcome.ending not in (Ending.CONVERGED, Ending.LATE):
            outcome = _graded_from(model, None, deadline)
        spent += outcome.iterations
        near = leaves_range(model, outcome.state.point, NEAR) & ~held
        if not (leaves_range(model, outcome.state.point, 0.0) & ~held).any() or outcome.ending is Ending.LATE:
            return model, replace(outcome, iterations=spent)
        held |= _with_neighbours(near)
        begin = outcome.state.point


def _graded_from(model: Model, begin: Point | None, deadline: Deadline) -> Outcome:
    """Solve with graded widths from a motion, or from a spline."""
    shares = graded(model)
    point = spline_start(model, shares) if begin is None else begin
    point = point._replace(widths=shares * point.durations[:, None, None])
    frame = frame_of(model, False, shares)
    return solve(frame, started(frame, point, 0.1), _goals(deadline)[0])


def usual_pieces(question: FreePathProblem, deadline: Deadline = NEVER) -> tuple[int, Outcome | None]:
    """Choose the number of pieces per segment, with the first phase where that is done on the way.

    Waypoints in close order along a smooth path are passed in a small part of the time from stop to stop. There
    acceleration changes little within a segment, and few pieces are enough; a first phase with three pieces tells.
    """
    jerky, segments = bool((question.kinds == 3).any()), question.n_segments
    usual = (USUAL if segments < MANY else MIDDLING) if jerky else NO_JERK
    model = model_of(question, FEWEST)
    if segments < CLOSE and _share(model, spline_start(model, graded(model), swelling(model))) >= HOPEFUL:
        return usual, None
    first = _graded_from(model, None, deadline)
    if _share(model, first.state.point) >= SWIFT:
        return usual, None
    return (FEW, None) if jerky and segments < CLOSE else (FEWEST, first)


def _share(model: Model, point: Point) -> float:
    """Duration of a motion as a share of the time from stop to stop."""
    return float(point.durations @ model.tau / model.tau.sum())


def _goals(deadline: Deadline) -> tuple[Goal, Goal, Goal]:
    """Stopping criteria of each phase."""
    return (
        Goal(barrier=1e-4, error=1e-2, iterations=100, deadline=deadline),
        Goal(barrier=1.5e-7, error=1e-3, iterations=120, deadline=deadline, centring=0.3, level=3e-6, damping=1e-3),
        Goal(barrier=3e-8, error=3e-6, iterations=60, deadline=deadline, centring=0.3, level=1e-8),
    )


def _with_neighbours(flags: Flags) -> Flags:
    wide = flags.copy()
    wide[1:] |= flags[:-1]
    wide[:-1] |= flags[1:]
    return wide


def _finished(model: Model, first: Outcome, deadline: Deadline) -> Outcome:
    """Go on with the widths as they are, until little is left of the equations."""
    frame, finishing = frame_of(model, False, graded(model)), _goals(deadline)[2]
    goal = replace(finishing, barrier=1e-5, error=1e-4, level=1e-5)
    last = _within_range(model, frame, solve(frame, resumed(frame, first.state, 1e-4), goal), goal)
    return replace(last, iterations=first.iterations + last.iterations)


def _freed(model: Model, first: Outcome, deadline: Deadline) -> list[Outcome]:
    """Free the widths, then fix them where they came to be; with the state between where that does not converge."""
    _, freeing, finishing = _goals(deadline)
    frame = frame_of(model, True, first.state.point.widths)
    second = solve(frame, resumed(frame, first.state, 1e-3), freeing)
    widths = np.maximum(second.state.point.widths, 1e-12)
    frame = frame_of(model, False, widths / widths.sum(axis=2, keepdims=True))
    third = _within_range(model, frame, solve(frame, continued(frame, second.state), finishing), finishing)
    third = replace(third, iterations=first.iterations + second.iterations + third.iterations)
    return [second, third] if third.ending is not Ending.CONVERGED and model.question.scalable else [third]


def _within_range(model: Model, frame: Frame, outcome: Outcome, goal: Goal) -> Outcome:
    """Go on where a range of positions is held, but left because the equations are closed too loosely."""
    for closing in CLOSINGS if model.held.any() else ():
        outside = leaves_range(model, closed(model, outcome.state.point), -OUTSIDE)[:, model.joints]
        if not outside.any() or (outside & ~model.held).any():
            break
        again = solve(frame, outcome.state, replace(goal, closing=closing * goal.error, level=0.0))
        outcome = replace(again, iterations=outcome.iterations + again.iterations)
    return outcome


def _answer(model: Model, outcomes: list[Outcome], iterations: int) -> Answer:
    """Close the equations and slow to the limits; of the phases' motions and a late one's spline, the fastest."""
    last = outcomes[-1]
    points = [outcome.state.point for outcome in reversed(outcomes)]
    if last.ending is Ending.LATE and model.question.scalable:
        shares = graded(model)
        points.append(spline_start(model, shares, points[0].durations * model.tau))
        points.append(spline_start(model, shares, swelling(model)))
    candidates = [closed(model, point) for point in points]
    factors = [stretch(model, point) if model.question.scalable else 1.0 for point in candidates]
    times = [float(model.tau @ c.durations) * f for c, f in zip(candidates, factors, strict=True)]
    outside = [bool(leaves_range(model, point, -OUTSIDE).any()) for point in candidates]
    best = min(range(len(candidates)), key=lambda k: (outside[k], times[k]))
    motion, factor = realise(model, candidates[best]), factors[best]
    ending = last.ending if last.ending is Ending.LATE else outcomes[-1 - best].ending
    return Answer(motion.scaled(factor) if factor > 1 else motion, ending, iterations, model.pieces, factor)
