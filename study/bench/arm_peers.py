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
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from scipy.interpolate import CubicSpline

from study import polynomial
from study.bench.peers import installed
from study.problem import Floats, Problem
from study.trajectory import Trajectory

STATIONS, FEWEST, MOST = 400, 4, 100
"""Gridpoints of a whole path, and the least and the most for each segment."""


Ends = Literal["natural", "clamped"]


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


def spline_of(problem: Problem, power: float, ends: Ends) -> CubicSpline:
    """Lay a cubic spline; its parameter grows by a power of the distance in units of the velocity limits."""
    chords = np.linalg.norm(np.diff(problem.waypoints, axis=0) / problem.limits.velocity, axis=1) ** power
    return CubicSpline(np.append(0.0, np.cumsum(chords)), problem.waypoints, bc_type=ends)


def stations_of(knots: Floats) -> Floats:
    """Gridpoints with every knot among them."""
    count = int(np.clip(STATIONS // (len(knots) - 1), FEWEST, MOST))
    inner = [np.linspace(a, b, count, endpoint=False) for a, b in pairwise(knots)]
    return np.append(np.concatenate(inner), knots[-1])


def with_toppra(problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Floats]:
    """Ask TOPP-RA for path speeds at gridpoints."""
    toppra, constraint = importlib.import_module("toppra"), importlib.import_module("toppra.constraint")
    algorithm: Any = importlib.import_module("toppra.algorithm")
    spline = spline_of(problem, power, ends)
    path = toppra.SplineInterpolator(spline.x, problem.waypoints, bc_type=ends)
    velocity, acceleration = problem.limits.rates[:2]
    limits = [
        constraint.JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    points = stations_of(spline.x)
    instance = algorithm.TOPPRA(limits, path, gridpoints=points, parametrizer="ParametrizeConstAccel")
    _, speeds, _ = instance.compute_parameterization(0.0, 0.0)
    return spline, points, speeds


def with_copp(problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Floats]:
    """Ask COPP's TOPP2-RA for path speeds at stations."""
    copp: Any = importlib.import_module("copp_py")
    spline, points, robot = _robot(copp, problem, power, ends)
    return spline, points, np.sqrt(np.maximum(_second_order(copp, robot, len(points)), 0.0))


def with_copp_third(problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Floats]:
    """Ask COPP's TOPP3-SOCP, one round about TOPP2-RA's profile; times and (parameter, speed, acceleration)."""
    copp: Any = importlib.import_module("copp_py")
    spline, points, robot = _robot(copp, problem, power, ends)
    reference, jerk = _second_order(copp, robot, len(points)), problem.limits.jerk
    robot.add_jerk_limits(jerk, -jerk, start_idx_s=0, length=len(points))
    third = copp.solver.topp3_socp
    profile = third.solve(third.Problem(robot.constraints, reference))
    _, times = copp.interpolation.s_to_t_topp3(points, profile)
    return spline, np.asarray(times), np.stack([points, np.sqrt(np.maximum(profile.a, 0.0)), profile.b], axis=1)


def _robot(copp: Any, problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Any]:
    spline = spline_of(problem, power, ends)
    points = stations_of(spline.x)
    robot = copp.Robot(problem.n_joints, capacity=len(points))
    robot.append_s(points)
    robot.set_q(spline(points), spline(points, 1), spline(points, 2), 0, dddq=spline(points, 3))
    for add, limit in zip(
        (robot.add_velocity_limits, robot.add_acceleration_limits), problem.limits.rates, strict=False
    ):
        add(limit, -limit, start_idx_s=0, length=len(points))
    return spline, points, robot


def _second_order(copp: Any, robot: Any, count: int) -> Floats:
    second = copp.solver.topp2_ra
    given = second.Problem(robot.constraints, idx_s_interval=(0, count - 1), a_boundary=(0.0, 0.0))
    return np.asarray(second.solve(given, second.Options()))


def at_constant_acceleration(problem: Problem, answer: tuple[CubicSpline, Floats, Floats]) -> Trajectory:
    """Drive a spline with constant path acceleration between gridpoints: exact, degree 6."""
    spline, points, speeds = answer
    steps = np.diff(points)
    times = 2 * steps / (speeds[:-1] + speeds[1:])
    along = np.stack([np.zeros_like(steps), speeds[:-1], np.diff(speeds) / times / 2], axis=1)
    return _driven(spline, points, times, along)


def by_quintics(problem: Problem, answer: tuple[CubicSpline, Floats, Floats]) -> Trajectory:
    """Drive a spline through path states at stations, quintic in time between them: exact, degree 15."""
    spline, times, states = answer
    h = np.diff(times)
    (s0, v0, a0), (s1, v1, a1) = states[:-1].T, states[1:].T
    quintic = polynomial.hermite_quintic(s1 - s0, v0 * h, v1 * h, a0 * h**2, a1 * h**2)
    along = np.stack([np.zeros_like(h), *quintic], axis=1) / h[:, None] ** np.arange(6)
    return _driven(spline, states[:, 0], h, along)


def _driven(spline: CubicSpline, points: Floats, times: Floats, along: Floats) -> Trajectory:
    about = np.stack([spline(points[:-1], k) / (1, 1, 2, 6)[k] for k in range(4)], axis=2)
    segment = np.searchsorted(spline.x, (points[:-1] + points[1:]) / 2) - 1
    about[:, :, 3] = spline.c[0, segment]
    driven = np.moveaxis(polynomial.composed(about, along[:, None]), 1, 2)
    return Trajectory.from_pieces(times, driven, np.bincount(segment, minlength=len(spline.x) - 1))


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
