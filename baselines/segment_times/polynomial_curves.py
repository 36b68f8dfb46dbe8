"""The two polynomial families of the studied curves, transcribed for CasADi."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any, ClassVar

import numpy as np

from baselines.ipopt import ca
from baselines.segment_times.critical_points import Critical, Slots, polynomial_critical
from baselines.segment_times.model import Rows
from study import polynomial
from study.curves import cubic_spline, cubic_spline_smooth, curve_named
from study.errors import StudyError
from study.problem import Floats, Problem
from study.trajectory import Trajectory

Symbols = tuple[Any, ...]


def limited_orders(problem: Problem) -> tuple[int, ...]:
    """Orders, 1 to 3, in which at least one joint has a finite limit."""
    return tuple(int(k) + 1 for k in np.flatnonzero(np.isfinite(problem.limits.rates).any(axis=1)))


def shortest_of(problem: Problem) -> float:
    """Lower bound on every duration; never quite zero, for a segment without a duration has no motion."""
    lower, upper = problem.duration_bounds
    return max(lower, min(1e-6, 1e-7 * upper))


def flat(array: Floats) -> Floats:
    """Column by column, as CasADi flattens a matrix."""
    return np.asarray(array, dtype=float).ravel(order="F")


def trajectory_of(curve: str, problem: Problem, durations: Floats) -> Trajectory:
    """Motion of a family that is polynomial in time."""
    motion = curve_named(curve).motion(problem.waypoints, durations)
    if not isinstance(motion, Trajectory):
        raise StudyError(f"curve {curve!r} must be polynomial in time for this transcription")
    return motion


def horner(coefficients: list[Any], u: Any) -> Any:
    """Evaluate ascending powers."""
    result = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        result = result * u + c
    return result


def rate_rows(coefficients: list[Any], h: Any, weight: Any, order: int, points: list[Symbols]) -> list[Any]:
    """Heights of the rates over their limits at the slots of all pieces, one column of rows for each slot.

    Parameters
    ----------
    coefficients : list of (n_pieces, n_joints) matrices, ascending powers of the fraction of the piece
    h : (n_pieces, 1)
    weight : (1, n_joints)
    """
    for _ in range(order):
        coefficients = [k * c for k, c in enumerate(coefficients)][1:]
    shape = coefficients[0].shape
    scale = ca.repmat(weight, shape[0], 1) / ca.repmat(h**order, 1, shape[1])
    rate = [c * scale for c in coefficients]
    slope = [k * c for k, c in enumerate(rate)][1:]
    columns = []
    for u, correction in points:
        height = horner(rate, u) - (correction * horner(slope, u) ** 2 if slope else 0)
        columns.append(ca.vec(height))
    return columns


def slot_symbols(shapes: dict[int, tuple[int, int, int]]) -> dict[int, list[Symbols]]:
    """Points and corrections of each slot of each order."""
    return {
        order: [tuple(ca.SX.sym(f"{name}{order}_{k}", pieces, columns) for name in "ub") for k in range(count)]
        for order, (pieces, columns, count) in shapes.items()
    }


def stacked(symbols: dict[int, list[Symbols]]) -> list[Any]:
    """The same, as columns of parameters."""
    return [ca.vec(matrix) for slots in symbols.values() for pair in slots for matrix in pair]


def slot_values(slots: dict[int, Slots]) -> list[Floats]:
    """Points and corrections in the order of `stacked`."""
    return [
        flat(values[:, :, k])
        for slot in slots.values()
        for k in range(slot.points.shape[2])
        for values in (slot.filled(), slot.corrections)
    ]


def slot_bounds(slots: dict[int, Slots], rates: Floats) -> list[Floats]:
    """Upper bound of every slot's row: 1, or infinity where the slot is free or the joint has no such limit."""
    return [
        flat(np.where(slot.used[:, :, k] & np.isfinite(rates[order - 1]), 1.0, np.inf))
        for order, slot in slots.items()
        for k in range(slot.points.shape[2])
    ]


@dataclass(frozen=True)
class PolynomialFamily:
    """Steps that families polynomial in time share; durations come first among their variables.

    Parameters
    ----------
    n_waypoints, n_joints : int
    orders : tuple of int
        Limited derivatives, 1 to 3.
    """

    n_waypoints: int
    n_joints: int
    orders: tuple[int, ...]
    pooled: ClassVar[bool] = False

    @property
    def key(self) -> tuple[Any, ...]:
        """Everything that the model depends on."""
        return (type(self).__name__, *astuple(self))

    def durations(self, x: Floats) -> Floats:
        """Durations of given variables."""
        return x[: self.n_waypoints - 1]

    def row_bounds(self, problem: Problem, slots: dict[int, Slots]) -> tuple[Floats, Floats]:
        """Every row in [-1, 1]."""
        upper = np.concatenate(slot_bounds(slots, problem.limits.rates))
        return -upper, upper

    def parameters(self, problem: Problem, slots: dict[int, Slots]) -> Floats:
        """Steps, one over every limit, and the slots' points and corrections."""
        steps = np.diff(problem.waypoints, axis=0)
        return np.concatenate([flat(steps), flat(1 / problem.limits.rates), *slot_values(slots)])


@dataclass(frozen=True)
class Poly353(PolynomialFamily):
    """Cubic-quintic-cubic: three durations, nothing else.

    The two cubics peak at closed forms, 3 d/t, 6 d/t^2 and 6 d/t^3, so their limits are lower bounds on the first and
    last duration; only the quintic needs points.
    """

    @property
    def slot_shapes(self) -> dict[int, tuple[int, int, int]]:
        """Points on the quintic alone."""
        return dict.fromkeys(self.orders, (1, self.n_joints, 6))

    def rows(self) -> Rows:
        """Build the symbolic model; coefficients as in `study.curves.poly353`."""
        h = ca.SX.sym("h", 3)
        d, weights, u = (
            ca.SX.sym("d", 3, self.n_joints),
            ca.SX.sym("w", 3, self.n_joints),
            slot_symbols(self.slot_shapes),
        )
        v1, a1 = 3 * d[0, :] * (h[1] / h[0]), 6 * d[0, :] * (h[1] / h[0]) ** 2
        v2, a2 = 3 * d[2, :] * (h[1] / h[2]), -6 * d[2, :] * (h[1] / h[2]) ** 2
        middle = [0, *polynomial.hermite_quintic(d[1, :], v1, v2, a1, a2)]
        rows = [r for k in self.orders for r in rate_rows(middle, h[1], weights[k - 1, :], k, u[k])]
        p = ca.vertcat(ca.vec(d), ca.vec(weights), *stacked(u))
        return Rows(h, p, ca.sum1(h), ca.vertcat(*rows))

    def lift(self, problem: Problem, durations: Floats) -> Floats:
        """Variables of given durations: the durations."""
        return durations

    def motion(self, problem: Problem, x: Floats) -> Trajectory:
        """Motion of given variables."""
        return trajectory_of("poly353", problem, self.durations(x))

    def variable_bounds(self, problem: Problem) -> tuple[Floats, Floats]:
        """Shortest durations, for the first and the last segment the closed forms of the cubics."""
        ends = np.abs(np.diff(problem.waypoints, axis=0))[[0, 2]]
        needed = (ends[:, None, :] * np.array([3.0, 6.0, 6.0])[:, None] / problem.limits.rates).max(axis=2)
        first, last = (needed ** (1 / np.arange(1, 4))).max(axis=1)
        return np.maximum([first, 0.0, last], shortest_of(problem)), np.full(3, np.inf)

    def critical(self, problem: Problem, x: Floats, order: int) -> Critical:
        """Critical points of the quintic."""
        return polynomial_critical(problem, self.motion(problem, x), order, slice(1, 2))


@dataclass(frozen=True)
class CubicSpline(PolynomialFamily):
    """Cubic splines: durations and the accelerations at the knots, tied by the spline's tridiagonal equations.

    Acceleration is linear between knots, so its limits are bounds on variables; jerk is constant on every piece; only
    velocity needs points. The smooth spline halves its outer segments and has no acceleration at its ends, which fixes
    the positions of the two knots in between.
    """

    smooth: bool = False

    @property
    def n_pieces(self) -> int:
        """Pieces between knots."""
        return self.n_waypoints + 1 if self.smooth else self.n_waypoints - 1

    @property
    def slot_shapes(self) -> dict[int, tuple[int, int, int]]:
        """Points for velocity alone."""
        return {1: (self.n_pieces, self.n_joints, 3)} if 1 in self.orders else {}

    def rows(self) -> Rows:
        """Build the symbolic model: equal velocities at the knots, then jerk, then velocity at the points."""
        joints = self.n_joints
        h, m = ca.SX.sym("h", self.n_waypoints - 1), ca.SX.sym("m", self.n_waypoints, joints)
        d, weights, u = ca.SX.sym("d", h.shape[0], joints), ca.SX.sym("w", 3, joints), slot_symbols(self.slot_shapes)
        widths, knots, steps = _halved(h, m, d) if self.smooth else (h, m, d)
        wide = ca.repmat(widths, 1, joints)
        left, right = knots[:-1, :] * wide**2, knots[1:, :] * wide**2
        pieces = [0 * steps, steps - left / 3 - right / 6, left / 2, (right - left) / 6]
        rows = [ca.vec(self._equations(pieces[1] / wide, (pieces[1] + (left + right) / 2) / wide))]
        if 3 in self.orders:
            jerk = (knots[1:, :] - knots[:-1, :]) / wide
            rows.append(ca.vec(jerk * ca.repmat(weights[2, :], self.n_pieces, 1)))
        if 1 in self.orders:
            rows += rate_rows(pieces, widths, weights[0, :], 1, u[1])
        p = ca.vertcat(ca.vec(d), ca.vec(weights), *stacked(u))
        return Rows(ca.vertcat(h, ca.vec(m)), p, ca.sum1(h), ca.vertcat(*rows))

    def _equations(self, start: Any, stop: Any) -> Any:
        """Velocity steps at the knots; at the ends the clamped spline has to stop, the smooth spline does by itself."""
        if self.smooth:
            return start[1:, :] - stop[:-1, :]
        rest = ca.SX.zeros(1, self.n_joints)
        return ca.vertcat(start, rest) - ca.vertcat(rest, stop)

    def lift(self, problem: Problem, durations: Floats) -> Floats:
        """Durations and the accelerations that follow from them."""
        if self.smooth:
            m = cubic_spline_smooth.accelerations(problem.waypoints, durations[None])[0, 1:-1]
        else:
            m = cubic_spline.accelerations(problem.waypoints, durations[None])[0]
        return np.concatenate([durations, flat(m)])

    def motion(self, problem: Problem, x: Floats) -> Trajectory:
        """Motion of the durations; the accelerations follow from them."""
        name = "cubic-spline-smooth" if self.smooth else "cubic-spline"
        return trajectory_of(name, problem, self.durations(x))

    def variable_bounds(self, problem: Problem) -> tuple[Floats, Floats]:
        """Shortest durations, and the acceleration limits."""
        peak = np.broadcast_to(problem.limits.acceleration, (self.n_waypoints, self.n_joints))
        lower = np.full(self.n_waypoints - 1, shortest_of(problem))
        return np.concatenate([lower, -flat(peak)]), np.concatenate([np.full_like(lower, np.inf), flat(peak)])

    def row_bounds(self, problem: Problem, slots: dict[int, Slots]) -> tuple[Floats, Floats]:
        """Zero for the equations, [-1, 1] for the limits."""
        upper = [np.zeros(self.n_waypoints * self.n_joints)]
        if 3 in self.orders:
            finite = np.where(np.isfinite(problem.limits.jerk), 1.0, np.inf)
            upper.append(flat(np.broadcast_to(finite, (self.n_pieces, self.n_joints))))
        upper += slot_bounds(slots, problem.limits.rates)
        return -np.concatenate(upper), np.concatenate(upper)

    def critical(self, problem: Problem, x: Floats, order: int) -> Critical:
        """Critical points of every piece."""
        return polynomial_critical(problem, self.motion(problem, x), order)


def _halved(h: Any, m: Any, d: Any) -> tuple[Any, Any, Any]:
    """Widths, knot accelerations and steps of the smooth spline; its virtual knots stand m a^2 / 6 from the ends."""
    widths = ca.vertcat(h[0] / 2, h[0] / 2, h[1:-1], h[-1] / 2, h[-1] / 2)
    first, last = m[0, :] * (h[0] / 2) ** 2 / 6, m[-1, :] * (h[-1] / 2) ** 2 / 6
    rest = ca.SX.zeros(1, d.shape[1])
    return widths, ca.vertcat(rest, m, rest), ca.vertcat(first, d[0, :] - first, d[1:-1, :], d[-1, :] + last, -last)
