"""The parametric B-spline transcribed for CasADi, and the linear programme that bounds it from below.

What the curve gives away (all over one piece, u in [0, 1], a prime for d/du):

* q(u) does not depend on the durations: q', q'', q''' at a point are numbers.
* t'(u) is a quadratic B-spline in e_k = T_(k+1) - T_k, the steps of the time control points, of which the first and
  last are zero. Durations and e are tied by a tridiagonal matrix, so the steps serve as variables and every row is
  sparse.
* Velocity: |q'| <= V t' is linear in e, and of all joints only the largest |q'|/V counts at a point.
* Acceleration: |q'' t' - q' t''| <= A t'^3. With x = t', y = t'' and q' > 0 one side reads y >= (q'' x - A x^3)/q',
  whose right side is concave for x > 0: the *complement* of the feasible set is convex, so the problem is in general
  not convex. Nothing proves a local optimum global; hence the multi-start (in trials all starts agreed).
* Without acceleration and jerk limits what remains is a linear programme. At any finite set of points it is a
  relaxation (fewer rows, fewer limits), so its value is a proven lower bound, and it is the optimum where only velocity
  binds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import linprog

from baselines.ipopt import ca
from baselines.segment_times.critical_points import Critical, Slots, corrections_of, is_root
from baselines.segment_times.model import Rows
from baselines.segment_times.polynomial_curves import shortest_of, slot_symbols, slot_values, stacked
from study import polynomial
from study.curves import bspline
from study.parametric import rational_candidates, rational_rate
from study.problem import Floats, Problem

SLOWEST = 1e-9
"""Smallest t' allowed, in units of the mean duration: time must increase strictly."""


def slope_basis(u: Floats) -> Floats:
    """Weights of three neighbouring steps e in t'(u), shape (..., 3)."""
    return np.stack([(1 - u) ** 2 / 2, (1 + 2 * u - 2 * u**2) / 2, u**2 / 2], axis=-1)


def duration_matrix(n_segments: int) -> Floats:
    """Matrix that makes durations of the steps e; every duration is (e_(k-1) + 4 e_k + e_(k+1)) / 6."""
    off = np.ones(n_segments - 1) / 6
    return np.diag(np.full(n_segments, 4 / 6)) + np.diag(off, 1) + np.diag(off, -1)


def needed_slope(waypoints: Floats, velocity: Floats, points: Floats) -> Floats:
    """Smallest t' that velocity limits allow at the same points of every piece, shape (n_pieces, n_points), s."""
    coefficients = polynomial.derivative(np.moveaxis(bspline.unit_coefficients(waypoints), 1, 2))
    speeds = np.abs(polynomial.value(coefficients[:, :, None, :], points)) / velocity[:, None]
    return speeds.max(axis=1)


@dataclass(frozen=True)
class BSpline:
    """Steps of the time control points; limits as argued at the top of this file.

    What the path is at a point is a number, so a slot belongs to a piece and may hold a point of any joint.
    """

    n_waypoints: int
    n_joints: int
    orders: tuple[int, ...]
    pooled: ClassVar[bool] = True

    @property
    def key(self) -> tuple[Any, ...]:
        """Everything that the model depends on."""
        return ("bspline", self.n_waypoints, self.orders)

    @property
    def slot_shapes(self) -> dict[int, tuple[int, int, int]]:
        """Slots of the limited orders; velocity always, for time must increase."""
        return dict.fromkeys(sorted({1, *self.orders}), (self.n_waypoints - 1, 1, 10))

    def rows(self) -> Rows:
        """Build the symbolic model."""
        n = self.n_waypoints - 1
        e, u = ca.SX.sym("e", n), slot_symbols(self.slot_shapes)
        steps = ca.vertcat(0, e, 0)
        windows = (steps[:-2], steps[1:-1], steps[2:])
        rows, p = [(windows[0] + 4 * windows[1] + windows[2]) / 6], stacked(u)
        for order, symbols in u.items():
            for k, (point, correction) in enumerate(symbols):
                path = [ca.SX.sym(f"q{order}_{k}_{i}", n) for i in range(3)]
                height, slope = slack(path, time_rates(windows, point), order)
                rows.append(height - correction * slope**2)
                p += path
        return Rows(e, ca.vertcat(*p), ca.sum1(rows[0]), ca.vertcat(*rows))

    def lift(self, problem: Problem, durations: Floats) -> Floats:
        """Steps of the control points that give these durations."""
        return np.asarray(np.linalg.solve(duration_matrix(len(durations)), durations), dtype=float)

    def durations(self, x: Floats) -> Floats:
        """Durations of given variables."""
        return duration_matrix(len(x)) @ x

    def variable_bounds(self, problem: Problem) -> tuple[Floats, Floats]:
        """No bounds: the durations are rows."""
        return np.full(self.n_waypoints - 1, -np.inf), np.full(self.n_waypoints - 1, np.inf)

    def row_bounds(self, problem: Problem, slots: dict[int, Slots]) -> tuple[Floats, Floats]:
        """Shortest durations; no slack in the others is the limit."""
        durations = np.full(self.n_waypoints - 1, shortest_of(problem))
        others = [np.where(slot.used[:, 0], 0.0, -np.inf).ravel(order="F") for slot in slots.values()]
        lower = np.concatenate([durations, *others])
        return lower, np.full(lower.size, np.inf)

    def parameters(self, problem: Problem, slots: dict[int, Slots]) -> Floats:
        """Points, corrections, then the path's derivatives at every slot, over the limit, with the peak's sign."""
        values = slot_values(slots)
        coefficients = np.moveaxis(bspline.unit_coefficients(problem.waypoints), 1, 2)
        for order, slot in slots.items():
            points, joints = slot.filled()[:, 0], slot.joints[:, 0]
            limit = problem.limits.rates[order - 1][joints] * slot.signs[:, 0]
            rates, path = coefficients[np.arange(len(points))[:, None], joints], []
            for _ in range(3):
                rates = polynomial.derivative(rates)
                path.append(np.where(slot.used[:, 0], polynomial.value(rates, points) / limit, 0.0))
            values += [q[:, k] for k in range(points.shape[1]) for q in path]
        return np.concatenate(values)

    def critical(self, problem: Problem, x: Floats, order: int) -> Critical:
        """Critical points; where time hardly increases its slowest points stand in for all others."""
        durations = self.durations(x)
        time = bspline.time_coefficients(durations[None])[0][:, None, :]
        slope = polynomial.derivative(time)
        lowest, at_lowest, _, _ = polynomial.extrema(slope)
        if lowest.min() <= 0:
            stuck = np.where(lowest <= 0, np.inf if order == 1 else 0.0, 0.0)[..., None]
            return Critical(at_lowest[..., None], stuck, np.zeros_like(stuck))
        position = np.moveaxis(bspline.unit_coefficients(problem.waypoints), 1, 2)
        position = position / problem.limits.rates[order - 1][:, None]
        points, ratios = rational_candidates(time, position, order)
        numerator, denominator = rational_rate(time, position, order)
        seconds = [polynomial.derivative(polynomial.derivative(a))[..., None, :] for a in (numerator, denominator)]
        over, under = (polynomial.value(a, points) for a in seconds)
        curvature = over * np.sign(ratios) - under  # of the negative slack, so that it is negative at a peak
        level = is_root(rational_rate(time, position, order + 1)[0], points)
        return Critical(points, ratios, -corrections_of(curvature, level, np.abs(ratios), points))


def time_rates(windows: tuple[Any, Any, Any], u: Any) -> tuple[Any, Any, Any]:
    """First, second and third derivative of t(u), from three neighbouring steps of the control points."""
    low, middle, high = windows
    first = low * (1 - u) ** 2 / 2 + middle * (1 + 2 * u - 2 * u**2) / 2 + high * u**2 / 2
    return first, -low * (1 - u) + middle * (1 - 2 * u) + high * u, low - 2 * middle + high


def slack(path: list[Any], time: tuple[Any, Any, Any], order: int) -> tuple[Any, Any]:
    """Slack of a limit at a point, R, and its derivative by u.

    With N = q''t' - q't'': R = t' - q', t'^3 - N, t'^5 - (N't' - 3Nt''), the path taken over its limit. A peak that
    reaches its limit is where R = R' = 0.
    """
    (q1, q2, q3), (t1, t2, t3) = path, time
    if order == 1:
        return t1 - SLOWEST - q1, t2 - q2
    numerator, slope = q2 * t1 - q1 * t2, q3 * t1 - q1 * t3
    if order == 2:
        return t1**3 - numerator, 3 * t1**2 * t2 - slope
    twist = q3 * t2 - q2 * t3
    jerk, turn = slope * t1 - 3 * numerator * t2, twist * t1 - 2 * slope * t2 - 3 * numerator * t3
    return t1**5 - jerk, 5 * t1**4 * t2 - turn


def velocity_bound(problem: Problem) -> float:
    """Proven lower bound on the total time, s, from velocity limits and shortest durations alone: a linear programme.

    The rows stand at 33 points of every piece; rows left out make the bound looser, never wrong. The value returned is
    that of the dual, which bounds from below also where the solver stops a little early.
    """
    n, u = problem.n_segments, np.linspace(0, 1, 33)
    rows = np.zeros((n, 33, n + 2))
    for k in range(3):
        rows[np.arange(n), :, np.arange(n) + k] = slope_basis(u)[:, k]
    matrix, need = duration_matrix(n), needed_slope(problem.waypoints, problem.limits.velocity, u)
    a = np.concatenate([rows[:, :, 1:-1].reshape(-1, n), matrix])
    b = np.concatenate([need.ravel(), np.full(n, problem.duration_bounds[0])])
    solved = linprog(matrix.sum(axis=0), A_ub=-a, b_ub=-b, bounds=(None, None), method="highs")
    return float(-solved.ineqlin.marginals @ b) if solved.status == 0 else 0.0
