"""Free-path nonlinear program for IPOPT: an upper bound on the optimal time over all motions through the waypoints.

Nothing ties the motion to a curve family: every segment has a free duration and is cut into K equal pieces. A joint
with a jerk limit has an acceleration that is linear in every piece, one with an acceleration limit only has a constant
one, and one with a velocity limit only drives straight. The more pieces, the closer to widths of every joint's own.

The solver is run again with its inner points moved to where velocity peaks, until nothing is above a limit; what is
still above after the last round is removed by stretching the whole motion by its exact factor. The range of positions
is left to the judge.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from baselines.base import NOTHING_MOVES, Deterministic, where_something_moves
from baselines.closed_forms import rest_to_rest_time
from baselines.free_path.transcription import Kinds, Nodes, PieceProgram, realise
from baselines.units import dimensionless
from study.curves import CURVES
from study.deadline import NEVER, Deadline
from study.errors import StudyError
from study.judge import judge
from study.planning import Plan, RunSettings, Status
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Motion, Trajectory

ROUNDS = 5
ENOUGH = 1e-7
"""Excess over the limits, as a stretch, that ends the rounds."""

ABSURD = 3.0
"""A motion this many times as long as stopping at every waypoint shows that the solver went astray."""


@dataclass(frozen=True, eq=False)
class FreePath:
    """Solution of the NLP.

    Attributes
    ----------
    motion : Trajectory
        Exact, and stretched so that it keeps all limits of rates.
    stretch : float
        By how much, at least 1.
    feasible : bool
        The judge's word on the motion.
    iterations : int
        IPOPT iterations of all rounds.
    converged : bool
    message : str
        IPOPT's word on its last round.
    """

    motion: Trajectory
    stretch: float
    feasible: bool
    iterations: int
    converged: bool
    message: str

    @property
    def rank(self) -> tuple[bool, float]:
        """Feasible before infeasible, then by duration."""
        return not self.feasible, self.motion.duration


def stops_time(problem: Problem) -> float:
    """Duration of the motion that stops at every waypoint, s."""
    return float(rest_to_rest_time(np.diff(problem.waypoints, axis=0), problem.limits.rates).max(axis=1).sum())


def spline_start(problem: Problem, pieces: int) -> Nodes:
    """Start from the clamped cubic spline over the durations from stop to stop, stretched until it is feasible."""
    steps = np.diff(problem.waypoints, axis=0)
    durations = rest_to_rest_time(steps, problem.limits.rates).max(axis=1)
    durations = np.maximum(durations, 1e-3 * durations.max())
    motion = CURVES["cubic-spline"].motion(problem.waypoints, durations)
    factor = judge(problem, motion).stretch
    return _sample(motion.scaled(factor), durations * factor, pieces)


def stop_start(problem: Problem, pieces: int) -> Nodes:
    """Start from stop to stop: parabolas of velocity over one and a half times the minimum durations."""
    steps = np.diff(problem.waypoints, axis=0)
    durations = 1.5 * rest_to_rest_time(steps, problem.limits.rates).max(axis=1)
    durations = np.maximum(durations, 1e-3 * durations.max())
    mean = steps / durations[:, None]
    squares = 6 * mean / durations[:, None]
    zero = np.zeros_like(mean)
    bumps = np.stack([problem.waypoints[:-1], zero, squares / 2, -squares / durations[:, None] / 3], axis=1)
    return _sample(Trajectory.from_pieces(durations, bumps), durations, pieces)


def _sample(motion: Motion, durations: Floats, pieces: int) -> Nodes:
    knots = np.append(0.0, np.cumsum(np.repeat(durations / pieces, pieces)))
    return Nodes(durations, motion(knots, 1), motion(knots, 2))


def improve(program: PieceProgram, nodes: Nodes, deadline: Deadline) -> FreePath:
    """Solve from one start, round by round, and keep the best motion on the way.

    Parameters
    ----------
    program : PieceProgram
    nodes : Nodes
        Where to start.
    deadline : Deadline
        No round but the first begins after it.
    """
    peaks, iterations, results = program.middles, 0, []
    for _ in range(ROUNDS):
        nodes, solution = program.solve(nodes, peaks)
        iterations += solution.iterations
        results.append(_finished(program.problem, nodes, solution.success, solution.status))
        if not solution.success or results[-1].stretch <= 1 + ENOUGH or deadline.passed():
            break
        peaks = program.moved(peaks, nodes)
    return replace(min(results, key=lambda result: result.rank), iterations=iterations)


def _finished(problem: Problem, nodes: Nodes, converged: bool, message: str) -> FreePath:
    motion = realise(problem, nodes)
    stretch = judge(problem, motion).stretch
    motion = motion.scaled(stretch)
    return FreePath(motion, stretch, judge(problem, motion).feasible, 0, converged, message)


def surplus(problem: Problem, pieces: int) -> int:
    """Count unknowns of the NLP less its equations; below zero no motion with so few pieces meets them, but by luck.

    Every segment has a duration. A joint whose acceleration is linear in every piece has two unknowns at every node,
    one with constant accelerations one; per piece and per segment they must fit together, and the ends take some away.
    """
    kinds, n = Kinds.of(problem), problem.n_segments
    ends = {EndCondition.FREE: 0, EndCondition.REST: 2, EndCondition.SMOOTH: 4}[problem.end]
    cubic = n * (pieces - 1) + 2 - ends
    quadratic = n * (pieces - 1) + 1 - min(ends, 2)
    return n + len(kinds.cubic) * cubic + len(kinds.quadratic) * quadratic


def free_path(problem: Problem, pieces: int = 8, deadline: Deadline = NEVER) -> FreePath:
    """Solve the free-path NLP from two starts and keep the faster motion.

    Parameters
    ----------
    problem : Problem
    pieces : int
        Equal pieces per segment, K.
    deadline : Deadline
        No solve takes more than half of what is left; after it one start is enough.

    Raises
    ------
    StudyError
        If `pieces` is not positive or too few for the end condition, or no joint moves.
    """
    if pieces < 1:
        raise StudyError(f"free-path NLP: pieces per segment must be at least 1, got {pieces}")
    if not np.ptp(problem.waypoints, axis=0).any():
        raise StudyError(f"case {problem.name!r}: {NOTHING_MOVES}")
    if not Kinds.of(problem).optimised.size:
        return _straight(problem)
    if (lacking := -surplus(problem, pieces)) > 0:
        raise StudyError(
            f"free-path NLP: {pieces} pieces per segment leave {lacking} more equations than unknowns on case "
            f"{problem.name!r}, so that no motion meets them; take more pieces"
        )
    stops = rest_to_rest_time(np.diff(problem.waypoints, axis=0), problem.limits.rates).max(axis=1)
    scaled, units = dimensionless(problem, stops.mean(), np.ptp(problem.waypoints, axis=0))
    program = PieceProgram(scaled, pieces, deadline.left() / 2)
    results = [improve(program, spline_start(scaled, pieces), deadline)]
    if not deadline.passed():
        results.append(improve(program, stop_start(scaled, pieces), deadline))
    best = min(results, key=lambda result: result.rank)
    motion = units.motion(best.motion)
    return replace(best, motion=motion, feasible=judge(problem, motion).feasible)


def _straight(problem: Problem) -> FreePath:
    """Velocity limits only: the straight line at the velocity limit of the slowest joint is the optimum."""
    durations = rest_to_rest_time(np.diff(problem.waypoints, axis=0), problem.limits.rates).max(axis=1)
    moved = durations > 0
    steps = np.diff(problem.waypoints, axis=0)[moved] / durations[moved, None]
    lines = np.stack([problem.waypoints[:-1][moved], steps], axis=1)
    motion = Trajectory.from_pieces(durations[moved], lines, moved.astype(int))
    return FreePath(motion, 1.0, judge(problem, motion).feasible, 0, True, "closed form")


@dataclass(frozen=True)
class FreePathNlp(Deterministic):
    """Planner `free-path-nlp`: no curve family, only waypoints and limits.

    Parameters
    ----------
    pieces : int
        Equal pieces per segment, K.
    """

    pieces: int = 8
    set_up: ClassVar[float] = 0.005
    about: ClassVar[str] = "free path in short pieces of polynomials, optimised by IPOPT"

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Solve the program within the settings' time limit."""
        result = free_path(problem, self.pieces, Deadline.after(settings.time_limit))
        if result.motion.duration > ABSURD * stops_time(problem):
            excess = f"{result.motion.duration:g} s; stopping at every waypoint is far faster"
            return Plan(
                Status.FAILED, iterations=result.iterations, message=f"the solver ended with a motion of {excess}"
            )
        if not result.feasible and not result.converged:
            return Plan(Status.FAILED, iterations=result.iterations, message=f"IPOPT: {result.message}")
        return Plan(
            Status.FINISHED if result.converged else Status.NOT_CONVERGED,
            motion=result.motion,
            iterations=result.iterations,
            message=f"IPOPT: {result.message}",
            details={"stretch": result.stretch, "pieces": float(self.pieces)},
        )
