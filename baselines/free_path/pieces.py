"""One piece of one joint: the states along a segment, the quantities that have bounds, and their derivatives.

A piece knows five numbers, y = (x2, x1, u0, u1, h): the states where it begins, u where it ends, and its width. Every
bounded quantity is a function of them:

    u1                                             u where the piece ends; u is linear, so this holds it everywhere
    u1 - u0                                        held to lower h .. upper h: the slope of u
    x1 + c1 h u0 / 2                               middle Bernstein coefficient of x1, a parabola
    h                                              not negative
    x2 + c2 h x1 / 3                               second and third Bernstein coefficient of x2, a cubic
    x2 + 2 c2 h x1 / 3 + c1 c2 h^2 u0 / 6

A polynomial lies between its smallest and largest Bernstein coefficient, and the outer coefficients lie between inner
ones of neighbouring pieces because the derivative is continuous. So the bounds hold on the whole of every piece; where
an optimal motion touches a bound, its knot moves there and nothing is lost. A new kind of row is a new quantity here:
its value, its gradient, and its second derivatives.

All arrays end in (n_segments, n_moving, K).

References
----------
G. Farin, Curves and Surfaces for CAGD, 5th ed., 2002: convex hull property of the Bernstein form.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from baselines.free_path.model import EARLY, LATE, MIDDLE, SLOPE, WIDTH, Model, U
from study.problem import Floats

X2, X1, U0, U1, H = range(5)


class Point(NamedTuple):
    """Unknowns of the nonlinear program, or a step in them.

    Attributes
    ----------
    durations : array of shape (n_segments,)
    nodes : array of shape (n_waypoints, n_moving, 3)
        u, x1 and x2 at the waypoints, position relative to the waypoint.
    inner : array of shape (n_segments, n_moving, K - 1)
        u where pieces meet.
    widths : array of shape (n_segments, n_moving, K)
    """

    durations: Floats
    nodes: Floats
    inner: Floats
    widths: Floats

    def moved(self, step: Point, length: float) -> Point:
        """Go some of a step."""
        return Point(*(mine + length * its for mine, its in zip(self, step, strict=True)))


class Pieces(NamedTuple):
    """States of all pieces at a point.

    Attributes
    ----------
    states : array of shape (5, n_segments, n_moving, K)
        y of every piece.
    gradients : array of shape (n_quantities, 5, n_segments, n_moving, K)
    rows : array of shape (2, n_quantities, n_segments, n_moving, K)
        Distance from the upper and from the lower bound; 1 where there is none.
    errors : array of shape (n_segments, n_moving, 3)
        What is left of the equations that close x1, x2 and the sum of the widths.
    """

    states: Floats
    gradients: Floats
    rows: Floats
    errors: Floats


class Costates(NamedTuple):
    """Sensitivity of a weighted sum of rows to x1 and x2 where every piece ends, and its gradient.

    Attributes
    ----------
    x1, x2 : arrays of shape (n_segments, n_moving, K)
    u : array of shape (n_segments, n_moving, K + 1)
    h : array of shape (n_segments, n_moving, K)
    start : array of shape (n_segments, n_moving, 2)
        Gradient in x1 and x2 where the segment begins.
    """

    x1: Floats
    x2: Floats
    u: Floats
    h: Floats
    start: Floats


class Bounds:
    """Bounds of the pieces in a form that is quick to use.

    Parameters
    ----------
    model : Model
    free : bool
        Whether widths are unknowns.
    """

    def __init__(self, model: Model, free: bool) -> None:
        held = bool(model.held[:, model.kinds == 3].any())
        self.count = 6 if held else 4
        segments, joints, pieces = model.shape
        full = (2, self.count, segments, joints, pieces)
        raw = np.stack([model.upper[: self.count], model.lower[: self.count]])
        active = np.broadcast_to(np.isfinite(raw)[..., None], full).copy()
        active[:, U, :, :, -1] = False  # the nodes hold the last one
        active[1, WIDTH] &= free or model.width_counts
        self.active = active
        self.idle = ~active
        self.upper, self.lower = np.where(np.isfinite(raw), raw, 0.0)[..., None]
        self.gradient = self._constant(model)

    def _constant(self, model: Model) -> Floats:
        gradient = np.zeros((self.count, 5, *model.shape))
        gradient[U, U1] = gradient[SLOPE, U1] = gradient[MIDDLE, X1] = gradient[WIDTH, H] = 1.0
        gradient[SLOPE, U0] = -1.0
        gradient[EARLY:, X2] = 1.0
        return gradient


def states_at(model: Model, point: Point) -> tuple[Floats, Floats]:
    """Follow every chain along its segment.

    Returns
    -------
    states : array of shape (5, n_segments, n_moving, K)
    errors : array of shape (n_segments, n_moving, 3)
    """
    first, second = model.gains
    begin, finish = point.nodes[:-1], point.nodes[1:] + model.ahead
    h, y = point.widths, np.empty((5, *model.shape))
    y[U0, :, :, 0], y[U0, :, :, 1:] = begin[:, :, 0], point.inner
    y[U1, :, :, :-1], y[U1, :, :, -1] = point.inner, finish[:, :, 0]
    y[H] = h
    run1 = first * h * (y[U0] + y[U1]) / 2
    sum1 = run1 @ model.summing
    y[X1] = begin[:, :, 1, None] + sum1 - run1
    run2 = second * h * (y[X1] + first * h * (2 * y[U0] + y[U1]) / 6)
    sum2 = run2 @ model.summing
    y[X2] = begin[:, :, 2, None] + sum2 - run2
    errors = np.empty((*model.shape[:2], 3))
    errors[:, :, 0] = begin[:, :, 1] + sum1[:, :, -1] - finish[:, :, 1]
    errors[:, :, 1] = begin[:, :, 2] + sum2[:, :, -1] - finish[:, :, 2]
    errors[:, :, :2] *= np.array([model.kinds > 1, model.kinds > 2]).T
    errors[:, :, :2] /= model.closures
    errors[:, :, 2] = h.sum(axis=2) - point.durations[:, None]
    return y, errors


def pieces_at(model: Model, bounds: Bounds, point: Point) -> Pieces:
    """Evaluate everything at a point."""
    first, second = model.gains
    y, errors = states_at(model, point)
    x2, x1, u0, u1, h = y
    gradient = bounds.gradient.copy()
    gradient[MIDDLE, U0], gradient[MIDDLE, H] = first * h / 2, first * u0 / 2
    values = np.empty((bounds.count, *model.shape))
    values[U], values[SLOPE], values[MIDDLE], values[WIDTH] = u1, u1 - u0, x1 + h * gradient[MIDDLE, H], h
    if bounds.count > EARLY:
        lift, bend = second * h / 3, first * second * h * u0 / 6
        values[EARLY], values[LATE] = x2 + lift * x1, x2 + 2 * lift * x1 + bend * h
        gradient[EARLY, X1], gradient[LATE, X1] = lift, 2 * lift
        gradient[EARLY, H], gradient[LATE, H] = second * x1 / 3, 2 * second * x1 / 3 + 2 * bend
        gradient[LATE, U0] = first * second * h * h / 6
    rows = np.empty((2, *values.shape))
    np.subtract(bounds.upper, values, out=rows[0])
    np.subtract(values, bounds.lower, out=rows[1])
    rows[0, SLOPE] = bounds.upper[SLOPE] * h - values[SLOPE]
    rows[1, SLOPE] = values[SLOPE] - bounds.lower[SLOPE] * h
    rows[bounds.idle] = 1.0
    return Pieces(y, gradient, rows, errors)


def pull(model: Model, bounds: Bounds, at: Pieces, weights: Floats, ends: Floats) -> Costates:
    """Gradient of the rows' weighted sum plus `ends` times the last x1 and x2, by the adjoint recursion.

    Parameters
    ----------
    weights : array of shape (2, n_quantities, n_segments, n_moving, K)
    ends : array of shape (n_segments, n_moving, 2)
    """
    first, second = model.gains
    _, x1, u0, u1, h = at.states
    net = weights[1] - weights[0]
    own = np.einsum("qasjk,qsjk->asjk", at.gradients, net)
    own[H] += bounds.upper[SLOPE] * weights[0, SLOPE] - bounds.lower[SLOPE] * weights[1, SLOPE]
    after2, start2 = _backwards(model, own[X2], ends[:, :, 1])
    after1, start1 = _backwards(model, own[X1] + second * h * after2, ends[:, :, 0])
    bend = first * second * h * after2
    half = first * after1 / 2
    u = np.zeros((*model.shape[:2], model.pieces + 1))
    u[:, :, :-1] = own[U0] + h * (half + bend / 3)
    u[:, :, 1:] += own[U1] + h * (half + bend / 6)
    width = own[H] + half * (u0 + u1) + second * after2 * x1 + bend * (2 * u0 + u1) / 3
    return Costates(after1, after2, u, width, np.stack([start1, start2], axis=2))


def _backwards(model: Model, own: Floats, last: Floats) -> tuple[Floats, Floats]:
    total = last + own.sum(axis=2)
    return total[:, :, None] - own @ model.summing, total


def push(model: Model, bounds: Bounds, at: Pieces, step: Point) -> Floats:
    """Change of all rows along a step, to first order; same shape as `at.rows`, 0 where there is no bound."""
    first, second = model.gains
    _, x1, u0, u1, h = at.states
    dy = np.empty_like(at.states)
    dy[U0, :, :, 0], dy[U0, :, :, 1:] = step.nodes[:-1, :, 0], step.inner
    dy[U1, :, :, :-1], dy[U1, :, :, -1] = step.inner, step.nodes[1:, :, 0]
    dh = dy[H] = step.widths
    run1 = first * (h * (dy[U0] + dy[U1]) + dh * (u0 + u1)) / 2
    dy[X1] = step.nodes[:-1, :, 1, None] + run1 @ model.summing - run1
    if bounds.count > EARLY:
        bend = h * (h * (2 * dy[U0] + dy[U1]) / 6 + dh * (2 * u0 + u1) / 3)
        run2 = second * (h * dy[X1] + dh * x1 + first * bend)
        dy[X2] = step.nodes[:-1, :, 2, None] + run2 @ model.summing - run2
    else:
        dy[X2] = 0.0
    change = np.einsum("qasjk,asjk->qsjk", at.gradients, dy)
    rows = np.stack([-change, change])
    rows[0, SLOPE] += bounds.upper[SLOPE] * dh
    rows[1, SLOPE] -= bounds.lower[SLOPE] * dh
    rows[bounds.idle] = 0.0
    return rows


_PAIRS = (
    (U, ((U1, U1),)),
    (SLOPE, ((U0, U0), (U1, U0), (U1, U1))),
    (MIDDLE, ((X1, X1), (U0, X1), (U0, U0), (H, X1), (H, U0), (H, H))),
    (WIDTH, ((H, H),)),
    (EARLY, ((X2, X2), (X1, X2), (X1, X1), (H, X2), (H, X1), (H, H))),
    (LATE, tuple((a, b) for a in (X2, X1, U0, H) for b in (X2, X1, U0, H) if a >= b)),
)
"""Entries of the gradients' outer products that are not zero, the later variable first."""


def curvature(
    model: Model, bounds: Bounds, at: Pieces, multipliers: Floats, stiffness: Floats, costates: Costates
) -> Floats:
    """Second derivatives of every piece's share in the Lagrangian, with the barrier's, lower triangle in y.

    Parameters
    ----------
    multipliers, stiffness : arrays of shape (2, n_quantities, n_segments, n_moving, K)
        Of the rows, and those over the slacks.
    costates : Costates
        Of the Lagrangian.

    Returns
    -------
    array of shape (n_segments, n_moving, K, 5, 5)
    """
    total = np.zeros((5, 5, *model.shape))
    both = stiffness[0] + stiffness[1]
    for row, pairs in _PAIRS[: bounds.count]:
        for a, b in pairs:
            total[a, b] += both[row] * at.gradients[row, a] * at.gradients[row, b]
    above, below = bounds.upper[SLOPE] * stiffness[0, SLOPE], bounds.lower[SLOPE] * stiffness[1, SLOPE]
    total[H, U1] -= above + below
    total[H, U0] += above + below
    total[H, H] += bounds.upper[SLOPE] * above + bounds.lower[SLOPE] * below
    _add_second(model, at, multipliers[0] - multipliers[1], costates, total)
    return np.ascontiguousarray(total.transpose(2, 3, 4, 0, 1))


def _add_second(model: Model, at: Pieces, net: Floats, costates: Costates, total: Floats) -> None:
    """Add the second derivatives of the chain, weighted by its costates, and of the quantities."""
    first, second = model.gains
    _, _, u0, u1, h = at.states
    bend, lift = first * second * costates.x2, second * costates.x2
    total[H, U0] += first * (costates.x1 + net[MIDDLE]) / 2 + 2 * bend * h / 3
    total[H, U1] += first * costates.x1 / 2 + bend * h / 3
    total[H, X1] += lift
    total[H, H] += bend * (2 * u0 + u1) / 3
    if len(net) > EARLY:
        total[H, X1] += second * (net[EARLY] + 2 * net[LATE]) / 3
        total[H, U0] += first * second * net[LATE] * h / 3
        total[H, H] += first * second * net[LATE] * u0 / 3
