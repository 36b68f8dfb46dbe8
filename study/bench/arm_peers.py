"""Other packages on the problems of real arms, each set up as its own users would: thin references, each an extra.

A peer's call is what a user of the package would pay for; its motion is made exact afterwards and put to the judge,
who knows no peers. Splines are the package's own or SciPy's. Where a package follows a path, its parameter grows by the
distance between waypoints or, centripetal, by its root.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from study import polynomial
from study.bench.peers import installed
from study.bench.spline_peers import (
    Ends,
    at_constant_acceleration,
    by_quintics,
    with_copp,
    with_copp_third,
    with_toppra,
)
from study.problem import Floats, Problem
from study.trajectory import Trajectory


@dataclass(frozen=True)
class Peer:
    """Another package's way to plan.

    Attributes
    ----------
    name, package : str
    jerk : tuple of bool
        Whether it plans with jerk limits, without, or both.
    most : int
        Waypoints up to which it is asked.
    solve : callable (problem) -> anything
        What is measured.
    motion : callable (problem, answer) -> Trajectory
        The answer as an exact motion.
    """

    name: str
    package: str
    jerk: tuple[bool, ...]
    solve: Callable[[Problem], Any]
    motion: Callable[[Problem, Any], Trajectory]
    most: int = 200

    def plans(self, problem: Problem) -> bool:
        """Whether the package is there and made for such a problem."""
        jerky = bool(np.isfinite(problem.limits.jerk).any())
        return jerky in self.jerk and problem.n_waypoints <= self.most and installed(self.package.split(".")[0])


def with_ruckig(problem: Problem) -> list[Any]:
    """Chain Ruckig's moves from stop to stop."""
    ruckig: Any = importlib.import_module("ruckig")
    given, solver = ruckig.InputParameter(problem.n_joints), ruckig.Ruckig(problem.n_joints)
    given.max_velocity, given.max_acceleration, given.max_jerk = (rate.tolist() for rate in problem.limits.rates)
    moves = []
    for start, end in zip(problem.waypoints[:-1].tolist(), problem.waypoints[1:].tolist(), strict=True):
        move = ruckig.Trajectory(problem.n_joints)
        given.current_position, given.target_position = start, end
        solver.calculate(given, move)
        moves.append(move)
    return moves


def chained(problem: Problem, moves: list[Any]) -> Trajectory:
    """Ruckig's phases of all joints as one exact motion."""
    widths, coefficients, counts = [], [], []
    for move in moves:
        profiles = move.profiles[0]
        starts = [np.append(0.0, np.cumsum(profile.t)) for profile in profiles]
        knots = np.unique(np.concatenate([*starts, [0.0, move.duration]]))
        knots = knots[np.append(True, np.diff(knots) > 1e-9)]
        knots[-1] = move.duration
        states = [move.at_time(t) for t in knots[:-1]]
        middles = [move.at_time(t) for t in (knots[:-1] + knots[1:]) / 2]
        width = np.diff(knots)
        jerk = (np.array([m[2] for m in middles]) - np.array([s[2] for s in states])) / (width[:, None] / 2)
        rows = np.stack([*(np.array([s[k] for s in states]) / (1, 1, 2)[k] for k in range(3)), jerk / 6], axis=1)
        if not np.isfinite(problem.limits.jerk).all():  # acceleration steps at the knots
            rows[:, 2], rows[:, 3] = np.array([m[2] for m in middles]) / 2, 0.0
        widths.append(width)
        coefficients.append(rows)
        counts.append(len(width))
    return Trajectory.from_pieces(np.concatenate(widths), np.concatenate(coefficients), np.array(counts))


def with_drake(problem: Problem) -> Any:
    """Drake's KinematicTrajectoryOptimization: a B-spline, waypoints at the path times of TOPP-RA."""
    drake: Any = importlib.import_module("pydrake.planning")
    solvers: Any = importlib.import_module("pydrake.solvers")
    jerky = bool(np.isfinite(problem.limits.jerk).all())
    spline, points, speeds = with_toppra(problem, 0.5, "natural")
    times = np.append(0.0, np.cumsum(2 * np.diff(points) / (speeds[:-1] + speeds[1:])))
    at = times[np.searchsorted(points, spline.x)] / times[-1]
    order = 5 if jerky else 4
    control = max(2 * problem.n_waypoints + 2 * order, 16)
    guess = 1.3 * times[-1]
    program = drake.KinematicTrajectoryOptimization(problem.n_joints, control, order, guess)
    program.AddDurationCost(1.0)
    program.AddDurationConstraint(0.3 * times[-1], 30 * times[-1])
    limits = problem.limits
    program.AddPositionBounds(np.maximum(limits.lower, -1e3), np.minimum(limits.upper, 1e3))
    program.AddVelocityBounds(-limits.velocity, limits.velocity)
    program.AddAccelerationBounds(-limits.acceleration, limits.acceleration)
    if jerky:
        program.AddJerkBounds(-limits.jerk, limits.jerk)
    zero = np.zeros(problem.n_joints)
    for s in (0, 1):
        program.AddPathVelocityConstraint(zero, zero, s)
        if jerky:
            program.AddPathAccelerationConstraint(zero, zero, s)
    for s, point in zip(at, problem.waypoints, strict=True):
        program.AddPathPositionConstraint(point, point, s)
    bspline = program.basis()
    greville = np.array([np.mean(bspline.knots()[k + 1 : k + order]) for k in range(control)])
    seconds = np.interp(greville, np.linspace(0, 1, 200), np.linspace(0, times[-1], 200))
    start = spline(np.interp(seconds, times, points)).T
    trajectories: Any = importlib.import_module("pydrake.trajectories")
    program.SetInitialGuess(trajectories.BsplineTrajectory(bspline, [start[:, [k]] for k in range(control)]))
    answer = solvers.SnoptSolver().Solve(program.prog())
    return (program.ReconstructTrajectory(answer), at) if answer.is_success() else None


def from_bspline(problem: Problem, answer: Any) -> Trajectory:
    """A B-spline of Drake's as an exact motion, cut at the waypoints."""
    curve, at = answer
    knots = np.array(curve.basis().knots())
    marks = at * (knots[-1] - knots[0]) + knots[0]
    return _cut(problem, curve, marks, knots, curve.basis().order() - 1)


def _cut(problem: Problem, curve: Any, marks: Floats, knots: Floats, degree: int) -> Trajectory:
    """A curve of Drake's between knots, cut at the times of the waypoints as well."""
    cuts = np.unique(np.concatenate([knots, marks]))
    cuts = cuts[np.append(True, np.diff(cuts) > 1e-9 * knots[-1])]
    cuts[-1] = knots[-1]
    middles = (cuts[:-1] + cuts[1:]) / 2
    factorials = np.cumprod(np.append(1.0, np.arange(1, degree + 1)))
    taylor = np.array([[curve.EvalDerivative(t, k)[:, 0] / factorials[k] for k in range(degree + 1)] for t in middles])
    taylor = polynomial.shifted(np.moveaxis(taylor, 1, 2), (cuts[:-1] - middles)[:, None])
    segment = np.clip(np.searchsorted(marks, middles) - 1, 0, problem.n_segments - 1)
    return Trajectory.from_pieces(
        np.diff(cuts), np.moveaxis(taylor, 2, 1), np.bincount(segment, minlength=problem.n_segments)
    )


def with_gcs(problem: Problem) -> Any:
    """Drake's GcsTrajectoryOptimization: a Bezier curve for each segment, waypoints between them, limits nonlinear."""
    drake: Any = importlib.import_module("pydrake.planning")
    sets: Any = importlib.import_module("pydrake.geometry.optimization")
    solvers: Any = importlib.import_module("pydrake.solvers")
    limits, points, jerky = problem.limits, problem.waypoints, bool(np.isfinite(problem.limits.jerk).all())
    box = sets.HPolyhedron.MakeBox(np.maximum(limits.lower, -10.0), np.minimum(limits.upper, 10.0))
    order, smooth = (9, 2) if jerky else (7, 1)
    program = drake.GcsTrajectoryOptimization(problem.n_joints)
    parts = [program.AddRegions([box], order, 1e-3, 20.0, name=f"s{k}") for k in range(problem.n_segments)]
    for before, after, point in zip(parts[:-1], parts[1:], points[1:-1], strict=True):
        edges = program.AddEdges(before, after, sets.Point(point))
        for derivative in range(1, smooth + 1):
            edges.AddContinuityConstraints(derivative)
    start = program.AddRegions([sets.Point(points[0])], 0, name="start")
    end = program.AddRegions([sets.Point(points[-1])], 0, name="end")
    first, last = program.AddEdges(start, parts[0]), program.AddEdges(parts[-1], end)
    for edges in (first, last):
        for derivative in range(1, smooth + 1):
            edges.AddZeroDerivativeConstraints(derivative)
    program.AddTimeCost()
    program.AddVelocityBounds(-limits.velocity, limits.velocity)
    program.AddNonlinearDerivativeBounds(-limits.acceleration, limits.acceleration, 2)
    if jerky:
        program.AddNonlinearDerivativeBounds(-limits.jerk, limits.jerk, 3)
    options = sets.GraphOfConvexSetsOptions()
    options.convex_relaxation, options.max_rounded_paths = True, 1
    options.restriction_solver = solvers.SnoptSolver()
    curve, answer = program.SolvePath(start, end, options)
    return curve if answer.is_success() else None


def from_beziers(problem: Problem, curve: Any) -> Trajectory:
    """A composite curve of Drake's, one part for each segment, as an exact motion."""
    parts = [curve.segment(k) for k in range(curve.get_number_of_segments())]
    parts = [part for part in parts if part.order()]  # the ends are regions of their own
    marks = np.array([parts[0].start_time(), *(part.end_time() for part in parts)])
    return _cut(problem, curve, marks, marks, max(part.order() for part in parts))


def _splined(name: str, package: str, jerk: bool, solve: Any, motion: Any) -> list[Peer]:
    """One peer for every way to lay a spline."""
    ways: dict[str, tuple[float, Ends]] = {
        "natural": (1.0, "natural"),
        "centripetal": (0.5, "natural"),
        "clamped": (1.0, "clamped"),
    }
    if not jerk:
        del ways["clamped"]
    return [
        Peer(f"{name}-{way}", package, (jerk,), partial(solve, power=power, ends=ends), motion)
        for way, (power, ends) in ways.items()
    ]


PEERS = (
    *_splined("toppra", "toppra", False, with_toppra, at_constant_acceleration),
    *_splined("copp-topp2", "copp_py", False, with_copp, at_constant_acceleration),
    *_splined("copp-topp3", "copp_py", True, with_copp_third, by_quintics),
    Peer("ruckig-chain", "ruckig", (True, False), with_ruckig, chained),
    Peer("drake-kto", "pydrake", (True, False), with_drake, from_bspline, most=50),
    Peer("drake-gcs", "pydrake", (True, False), with_gcs, from_beziers, most=10),
)
"""Every way of every package that is asked."""
