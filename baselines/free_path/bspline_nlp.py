"""Kinematic trajectory optimisation on a uniform B-spline through the waypoints, limits held on control points.

The path q(s), s in [0, 1], is a clamped uniform B-spline of degree 5, so its fourth derivative is continuous; the
motion is q(t / T). Variables are the control points, the duration T and the parameters s_i at which the waypoints are
passed. The k-th derivative of the spline is a B-spline too and stays in the convex hull of its own control points, so
keeping these within the limit times T^k keeps the limit everywhere, without a single sample. The hull is wider than the
curve; what it gives away is measured exactly afterwards, and the motion is run faster until it touches a limit.

For fixed s_i a motion that is feasible for T is feasible for every longer one, and for a fixed T all rows are linear:
no local optimum is worse than another. With free s_i that is lost; the start decides, and is the best clamped cubic
spline. The range of positions is left to the judge.

References
----------
R. Tedrake and the Drake developers, Drake, 2019: its kinematic trajectory optimisation holds limits so, with s_i given.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.special import factorial

from baselines.base import Deterministic, where_something_moves
from baselines.ipopt import Ipopt, Solution, alone, ca
from baselines.segment_times.model import COLD
from baselines.segment_times.nlp import optimise
from baselines.units import dimensionless
from study.curves import curve_named
from study.deadline import Deadline
from study.judge import judge
from study.planning import Plan, RunSettings, Status
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Trajectory

DEGREE = 5
OPTIONS = COLD | {"tol": 1e-8, "constr_viol_tol": 1e-10, "max_iter": 300}
SHORTEST = 1e-3
"""Shortest step between passage parameters, as a share of an even one."""

ROUNDS, ENOUGH = 4, 1e-5
"""Solves with one number of spans at most, and the relative gain below which no other follows."""

STEP = 1.0
"""Trust region of a passage parameter in one solve, as a share of an even step; the next starts at its result."""

MERGED = 1e-10
"""A knot this near to a passage parameter is left out of the motion's knots: the spline has no kink to show there."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A spline: control points (n_control_points, n_joints), parameters of the waypoints, and duration, s."""

    control: Floats
    passed: Floats
    duration: float

    def motion(self) -> Trajectory:
        """Make the exact trajectory, with a knot wherever a waypoint is passed."""
        knots = knots_of(len(self.control) - DEGREE)
        distance = np.abs(np.unique(knots)[:, None] - self.passed).min(axis=1)
        cuts = np.sort(np.concatenate([np.unique(knots)[distance > MERGED], self.passed]))
        spline = BSpline(knots, self.control, DEGREE)
        rates = [spline.derivative(k)(cuts[:-1]) / factorial(k) for k in range(1, DEGREE + 1)]
        coefficients = np.stack([spline(cuts[:-1]), *rates], axis=1)
        return Trajectory(cuts, coefficients, self.passed).scaled(self.duration)

    def finer(self, spans: int) -> Shape:
        """The same motion, nearly, with more spans."""
        spline = BSpline(knots_of(len(self.control) - DEGREE), self.control, DEGREE)
        return Shape(spline(_greville(spans)), self.passed, self.duration)


def knots_of(spans: int) -> Floats:
    """Clamped uniform knots on [0, 1]."""
    return np.concatenate([np.zeros(DEGREE), np.linspace(0.0, 1.0, spans + 1), np.ones(DEGREE)])


def _greville(spans: int) -> Floats:
    """Parameters that belong to the control points: means of their inner knots."""
    windows = np.lib.stride_tricks.sliding_window_view(knots_of(spans)[1:-1], DEGREE)
    return np.asarray(windows.mean(axis=1), dtype=float)


def derivative_matrix(spans: int, order: int) -> Floats:
    """Matrix that makes the control points of a derivative of the control points."""
    derivative = BSpline(knots_of(spans), np.eye(spans + DEGREE), DEGREE).derivative(order)
    return np.asarray(derivative.c, dtype=float)[: spans + DEGREE - order]


def pinned(problem: Problem) -> NDArray[np.intp]:
    """Number of every joint's control points fixed to the waypoint at either end, shape (n_joints,)."""
    # One passes it, two rest, three rest without acceleration; as for the judge, what no higher limit forbids may step.
    limited = np.isfinite(problem.limits.rates)
    demanded = {EndCondition.FREE: 0, EndCondition.REST: 1, EndCondition.SMOOTH: 2}[problem.end]
    return 1 + np.minimum(np.where(limited[2], 2, np.where(limited[1], 1, 0)), demanded)


def first_shape(problem: Problem, spans: int, time_limit: float) -> Shape:
    """Start near the best clamped cubic spline, stretched until it is feasible."""
    best = optimise(problem, "cubic-spline", time_limit=time_limit).durations
    durations = best if np.isfinite(best).all() else np.ones(problem.n_segments)
    motion = curve_named("cubic-spline").motion(problem.waypoints, durations)
    duration = motion.duration * judge(problem, motion).least_scale
    return Shape(motion(_greville(spans) * motion.duration), motion.waypoint_times / motion.duration, duration)


class SplineProgram:
    """Nonlinear program of one dimensionless problem and one number of spans of the whole spline."""

    def __init__(self, problem: Problem, spans: int) -> None:
        self.problem, self.spans = problem, spans
        self.moving = np.flatnonzero(np.ptp(problem.waypoints, axis=0) > 0)
        self.origin = problem.waypoints[0, self.moving]

    def _rows(self, x: Any, unit: float, box: tuple[Floats, Floats]) -> tuple[Any, Floats]:
        """Rows and their upper bounds, where the lower ones are zero: waypoints, order of passage, limits."""
        problem, n_joints = self.problem, len(self.moving)
        count = (self.spans + DEGREE) * n_joints
        flat, inner, duration = x[:count], x[count:-1], x[-1]
        points = problem.waypoints[1:-1, self.moving] - self.origin
        least = SHORTEST / problem.n_segments
        steps = ca.vertcat(inner, 1.0) - ca.vertcat(0.0, inner) - least
        control = ca.reshape(flat, n_joints, self.spans + DEGREE)
        passing = [
            self._at(control, inner[i], *sides) - point
            for i, (*sides, point) in enumerate(zip(*box, points, strict=True))
        ]
        slack = []
        for order, limits in enumerate(problem.limits.rates[:, self.moving], start=1):
            held = np.flatnonzero(np.isfinite(limits)).tolist()
            weight = ca.diag(ca.DM((1 / limits)[held] / unit**order))
            rates = weight @ control[held, :] @ ca.sparsify(ca.DM(derivative_matrix(self.spans, order))).T
            slack += [duration**order - ca.vec(rates), duration**order + ca.vec(rates)]
        rows = ca.vertcat(*passing, steps, *slack)
        upper = np.full(rows.numel(), np.inf)
        upper[: points.size] = 0.0
        return rows, upper

    def _at(self, control: Any, s: Any, low: float, high: float) -> Any:
        """Position at a parameter between two numbers, from the control points that count there."""
        first = int(np.floor(low * self.spans))
        last = min(int(np.ceil(high * self.spans)), self.spans) + DEGREE
        every = np.eye(self.spans + DEGREE)[:, first:last]
        weights = ca.bspline(s, every.ravel(), [knots_of(self.spans).tolist()], [DEGREE], last - first)
        return control[:, first:last] @ weights

    def _bounds(self, box: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
        """Bounds of the variables: the ends are pinned, all else is free."""
        low = np.full((self.spans + DEGREE, len(self.moving)), -np.inf)
        high = -low
        goal = self.problem.waypoints[-1, self.moving] - self.origin
        for column, count in enumerate(pinned(self.problem)[self.moving]):
            for side in (low, high):
                side[:count, column], side[-count:, column] = 0.0, goal[column]
        return np.concatenate([low.ravel(), box[0], [0.0]]), np.concatenate([high.ravel(), box[1], [np.inf]])

    @alone()
    def solve(self, start: Shape, seconds: float) -> tuple[Shape, Solution]:
        """Run IPOPT once."""
        unit = start.duration
        guess = start.control[:, self.moving] - self.origin
        x = ca.MX.sym("x", guess.size + self.problem.n_segments)
        near = STEP / self.problem.n_segments
        box = np.maximum(start.passed[1:-1] - near, 0.0), np.minimum(start.passed[1:-1] + near, 1.0)
        rows, upper = self._rows(x, unit, box)
        solver = Ipopt({"x": x, "f": x[-1], "g": rows}, OPTIONS, seconds)
        low, high = self._bounds(box)
        x0 = np.concatenate([guess.ravel(), start.passed[1:-1], [1.0]])
        solution = solver.solve(x0=x0, lbx=low, ubx=high, lbg=0.0, ubg=upper)
        control = np.repeat(self.problem.waypoints[:1], self.spans + DEGREE, axis=0)
        control[:, self.moving] += solution.x[: guess.size].reshape(guess.shape)
        passed = np.concatenate([[0.0], solution.x[guess.size : -1], [1.0]])
        return Shape(control, passed, solution.x[-1] * unit), solution


@dataclass(frozen=True)
class BSplineNlp(Deterministic):
    """Planner `bspline-nlp`.

    Parameters
    ----------
    spans : int
        Spans per segment at first.
    most : int
        Spans of the whole spline at most; their number is doubled, each time from the solution before, while it allows.
    """

    spans: int = 3
    most: int = 120
    set_up: ClassVar[float] = 0.004
    about: ClassVar[str] = "one B-spline through the waypoints, its control points optimised by IPOPT"

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Solve the program with more and more spans; only the settings' time limit matters."""
        if not np.isfinite(problem.limits.rates[1:]).any():
            reason = "no joint has an acceleration or jerk limit, and a smooth curve cannot be the fastest then"
            return Plan(Status.NOT_APPLICABLE, message=reason)
        scaled, units = dimensionless(problem, 1.0, np.ptp(problem.waypoints, axis=0))
        best = self._best(scaled, Deadline.after(settings.time_limit), settings.time_limit)
        return replace(best, motion=units.motion(best.motion)) if isinstance(best.motion, Trajectory) else best

    def _best(self, problem: Problem, deadline: Deadline, time_limit: float) -> Plan:
        spans = self.spans * problem.n_segments
        shape, best = first_shape(problem, spans, time_limit / 4), Plan(Status.FAILED, message="no time left")
        while spans <= max(self.most, self.spans * problem.n_segments):
            program = SplineProgram(problem, spans)
            for _ in range(ROUNDS):
                if deadline.passed():
                    return replace(best, status=Status.FAILED if best.motion is None else Status.NOT_CONVERGED)
                shape, solution = program.solve(shape.finer(spans), deadline.left())
                before, best = best, _better(problem, best, shape, solution)
                if not solution.success:
                    return best
                if _gain(before, best) < ENOUGH:
                    break
            spans *= 2
        return best


def _gain(before: Plan, after: Plan) -> float:
    """Relative decrease of the best duration; infinite for the first motion."""
    if before.motion is None or after.motion is None:
        return np.inf
    return 1.0 - after.motion.duration / before.motion.duration


def _better(problem: Problem, best: Plan, shape: Shape, solution: Solution) -> Plan:
    """Take the new motion where it is feasible and faster, exactly at its limits, and the account of its solve."""
    motion = shape.motion()
    factor = judge(problem, motion).least_scale
    motion = motion.scaled(factor)
    better = replace(best, iterations=best.iterations + solution.iterations, message=f"IPOPT: {solution.status}")
    if best.motion is None or motion.duration < best.motion.duration:
        verdict = judge(problem, motion)
        if verdict.feasible:
            better = replace(better, motion=motion, details={"stretch": factor})
        elif best.motion is None:
            better = replace(better, message=f"{better.message}, but {verdict.reasons[0]}")
    if better.motion is None:
        return better
    return replace(better, status=Status.FINISHED if solution.success else Status.NOT_CONVERGED)
