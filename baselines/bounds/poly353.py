r"""Lower bounds on the total time of a 3-5-3 motion over boxes of duration ratios.

The problem in two dimensions. With r = t2/t1 and s = t2/t3 the quintic in unit time, N(tau; r, s), depends on nothing
else: its end velocities and accelerations are 3 d1 r, 6 d1 r^2 and 3 d3 s, -6 d3 s^2. So for every pair (r, s) the
shortest t2 is the largest of

* |N^(k)(tau)| / L_k to the power 1/k, over tau, joints and orders k = 1, 2, 3;
* b1 r and b3 s, where b1, b3 are the shortest end durations: the cubics peak at 3|d|/t, 6|d|/t^2, 6|d|/t^3;
* the shortest duration allowed;

and the total is T = t2 (1 + 1/r + 1/s). Coordinates are x = ln r, y = ln s, values ln T.

Bounds on a box. Dropping instants only lowers the maximum, so any few tau per joint and order give a lower bound: the
peaks at the middle of the box (a bad tau costs tightness, never validity). For fixed tau N is a sum of a quadratic in r
and one in s, so its range over the box is exact. This first bound errs by the width of the box. The second errs by its
square: f = (ln |N|)/k + ln(1 + e^-x + e^-y) has at the middle m a value and a gradient g, and

    f(m + z) >= f(m) + g.z - e,   2 k e = sum_i max(0, -min N_ii/N) z_i^2 + (sum_i max|N_i/N| |z_i|)^2,

because ln|N| has the Hessian diag(N_ii)/N - (grad N)(grad N)'/N^2, N has no mixed derivative, and the other term
is convex. The limits b1, b3 and the shortest duration are convex in x, y, with e = 0. A maximum is at least every mean
of its members: for any weight w in [0, 1], max(f, h) >= w f + (1 - w) h. Weights that cancel one component of the
mean's gradient keep the bound tight along a valley where two limits meet, and so keep the boxes from clustering there.

Rounding. N is a sum of fewer than 40 products, so it errs by less than 1e-14 of the sum of their absolute values; a
limit counts only where |N| exceeds 1e-4 of that sum, which makes its relative error less than 1e-10. Slopes and
remainders are widened by 1e-9 of themselves, and every bound is lowered by 1e-9 at the end, which is a thousandth of
the gap asked for.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from study import polynomial
from study.problem import Floats, Problem

QUINTICS = np.column_stack([np.zeros(5), *polynomial.hermite_quintic(*np.eye(5))])
"""Quintics of step, first and last velocity, first and last acceleration, shape (5, 6); ascending powers."""

GRID = np.linspace(0.0, 1.0, 13)
PEAKS = 3
"""Instants tried for every joint and order."""
ROUNDING = 1e-9
CANCELLED = 1e-4
STRONGEST = 5
"""Limits per box whose pairs are tried."""


class Pieces(NamedTuple):
    """Limits on boxes: value and slope at the middle, remainder, and the plain interval bound; all of ln T.

    Shapes (n_boxes, n_limits), the slope (n_boxes, n_limits, 2).
    """

    value: Floats
    slope: Floats
    remainder: Floats
    plain: Floats


class Bounds353:
    """Lower bounds of ln T on boxes of (ln t2/t1, ln t2/t3).

    Parameters
    ----------
    problem : Problem
        With four waypoints.
    """

    def __init__(self, problem: Problem) -> None:
        self.limits = problem.limits.rates
        self.steps = np.diff(problem.waypoints, axis=0)
        self.shortest = problem.duration_bounds[0]
        ends = np.abs(self.steps)[[0, 2], None, :] * np.array([3.0, 6.0, 6.0])[:, None] / self.limits
        needed = (ends.max(axis=2) ** (1 / np.arange(1, 4))).max(axis=1)
        self.first, self.last = np.maximum(needed, self.shortest).tolist()
        self.orders = [k for k in (1, 2, 3) if np.isfinite(self.limits[k - 1]).any()]

    def middle(self, total: float) -> float:
        """Shortest middle duration of a motion that lasts at most the given total, s.

        Between rests a joint is never faster than its limit, A T/2 or J T^2/4.
        """
        velocity, acceleration, jerk = self.limits
        fastest = np.minimum(velocity, np.minimum(acceleration * total / 2, jerk * total**2 / 4))
        return max(self.shortest, float((np.abs(self.steps[1]) / fastest).max()))

    def box(self, total: float) -> tuple[Floats, Floats]:
        """Box of the ratios of all motions that last at most the given total, s; a little widened."""
        middle = self.middle(total)
        longest = np.array([total - self.last - middle, total - self.first - middle])
        widest = total - self.first - self.last
        wide = np.log([[middle / longest[0], middle / longest[1]], [widest / self.first, widest / self.last]])
        return np.minimum(wide[0], wide[1]) - ROUNDING, np.maximum(wide[0], wide[1]) + ROUNDING

    def durations(self, points: Floats) -> Floats:
        """Durations in the ratios of given points, of shape (n_points, 2), up to a common factor."""
        return np.stack([np.exp(-points[:, 0]), np.ones(len(points)), np.exp(-points[:, 1])], axis=1)

    def __call__(self, low: Floats, high: Floats) -> Floats:
        """Lower bound of T, s, on every box."""
        parts = [self._convex(low, high), *(self._rates(low, high, order) for order in self.orders)]
        pieces = Pieces(*(np.concatenate(part, axis=1) for part in zip(*parts, strict=True)))
        best = np.maximum(pieces.plain.max(axis=1), _second_order(pieces, (high - low) / 2))
        return np.exp(best) * (1 - ROUNDING)

    def _convex(self, low: Floats, high: Floats) -> Pieces:
        """The limits b1 r, b3 s and shortest duration: ln of 1 + r + r/s, of 1 + s + s/r and of 1 + 1/r + 1/s."""
        directions = np.array([[[1, 0], [1, -1]], [[0, 1], [-1, 1]], [[-1, 0], [0, -1]]], dtype=float)
        with np.errstate(divide="ignore"):
            constants = np.log([self.first, self.last, self.shortest])
        middle, half = (low + high) / 2, (high - low) / 2
        at_middle = np.exp(np.einsum("cei,bi->bce", directions, middle))
        spread = np.einsum("cei,bi->bce", np.abs(directions), half)
        total = 1 + at_middle.sum(axis=2)
        slope = np.einsum("bce,cei->bci", at_middle, directions) / total[..., None]
        plain = np.log(1 + (at_middle * np.exp(-spread)).sum(axis=2)) + constants
        return Pieces(np.log(total) + constants, slope, np.zeros_like(plain), plain)

    def _rates(self, low: Floats, high: Floats, order: int) -> Pieces:
        """One order of the quintic's rates, each joint at the instants of its peaks in the middle of the box."""
        basis = QUINTICS
        for _ in range(order):
            basis = basis[:, 1:] * np.arange(1, basis.shape[1])
        steps = self.steps / self.limits[order - 1]
        weights = np.stack([steps[1], 3 * steps[0], 3 * steps[2], 6 * steps[0], -6 * steps[2]], axis=-1)
        corners = [np.exp(c)[:, None, :] for c in (low, (low + high) / 2, high)]
        ratios = corners[1]
        powers = np.stack(
            [np.ones_like(ratios[..., 0]), *(ratios[..., i] ** p for p in (1, 2) for i in (0, 1))], axis=-1
        )
        tau = peak_instants((weights * powers) @ basis)
        factors = (tau[..., None] ** np.arange(basis.shape[1])) @ basis.T * weights[:, None, :]
        return _logarithm(factors.reshape(len(low), -1, 5), corners, order, (high - low) / 2)


def peak_instants(polynomials: Floats) -> Floats:
    """Instants near the highest peaks of |p| on [0, 1]; of shape (..., degree + 1) makes (..., PEAKS)."""
    powers = np.arange(polynomials.shape[-1])
    height = np.abs(polynomials @ (GRID[:, None] ** powers).T)
    padded = np.pad(height, [(0, 0)] * (height.ndim - 1) + [(1, 1)], constant_values=-1.0)
    peaked = np.where((height >= padded[..., :-2]) & (height >= padded[..., 2:]), height, -1.0)
    tau = GRID[np.argpartition(-peaked, PEAKS - 1, axis=-1)[..., :PEAKS]]
    slope = (polynomials[..., 1:] * powers[1:])[..., None, :]
    bend = slope[..., 1:] * powers[1:-1]
    for _ in range(3):
        at = tau[..., None] ** powers
        curvature = (bend * at[..., : bend.shape[-1]]).sum(axis=-1)
        change = (slope * at[..., : slope.shape[-1]]).sum(axis=-1)
        peaked = curvature * (polynomials[..., None, :] * at).sum(axis=-1) < 0
        newton = np.divide(change, curvature, out=np.zeros_like(tau), where=peaked)
        tau = np.clip(tau - np.clip(newton, -GRID[1], GRID[1]), 0.0, 1.0)
    return tau


def _quadratic_range(linear: Floats, square: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Smallest and largest value of linear r + square r^2 on [low, high]."""
    turn = np.divide(-linear, 2 * square, out=np.zeros_like(linear), where=square != 0)
    values = [r * (linear + square * r) for r in (low, high, np.clip(turn, low, high))]
    return np.minimum.reduce(values), np.maximum.reduce(values)


def _logarithm(factors: Floats, corners: list[Floats], order: int, half: Floats) -> Pieces:
    """Pieces of f = (ln |N|)/k + ln(1 + 1/r + 1/s), N = c0 + c1 r + c2 s + c3 r^2 + c4 s^2; (n_boxes, n_joints, 5)."""
    low, middle, high = corners
    linear, square = factors[..., 1:3], factors[..., 3:5]
    value = factors[..., 0] + (middle * (linear + square * middle)).sum(axis=-1)
    size = np.abs(factors[..., 0]) + (high * (np.abs(linear) + np.abs(square) * high)).sum(axis=-1)
    sign = np.where(value < 0, -1.0, 1.0)
    linear, square = linear * sign[..., None], square * sign[..., None]
    least, _ = _quadratic_range(linear, square, low, high)
    smallest = factors[..., 0] * sign + least.sum(axis=-1)
    counts = smallest > CANCELLED * size
    divisor = np.where(counts, smallest, 1.0)[..., None]
    first = np.maximum.reduce(np.abs(_quadratic_range(linear, 2 * square, low, high)))
    second, _ = _quadratic_range(linear, 4 * square, low, high)
    reach = half[:, None, :]
    error = (np.maximum(-second, 0.0) / divisor * reach**2).sum(axis=-1) + (first / divisor * reach).sum(axis=-1) ** 2
    total = 1 + (1 / middle).sum(axis=-1)
    outside = np.where(counts, 0.0, -np.inf)
    height = np.log(np.where(counts, np.abs(value), 1.0)) / order + np.log(total) + outside
    gradient = middle * (linear + 2 * square * middle) / np.where(counts, np.abs(value), 1.0)[..., None] / order
    plain = np.log(divisor[..., 0]) / order + np.log(1 + (1 / high).sum(axis=-1)) + outside
    return Pieces(height, gradient - 1 / middle / total[..., None], error / (2 * order), plain)


def _second_order(pieces: Pieces, half: Floats) -> Floats:
    """Best bound from means of two of the strongest limits of every box, shape (n_boxes,)."""
    count = min(STRONGEST, pieces.value.shape[1])
    strongest = np.argpartition(-pieces.value, count - 1, axis=1)[:, :count]
    value, error = (np.take_along_axis(a, strongest, 1) for a in (pieces.value, pieces.remainder))
    slope = np.take_along_axis(pieces.slope, strongest[..., None], 1)
    first, second = np.triu_indices(count)
    difference = slope[:, first] - slope[:, second]
    cancel = np.divide(-slope[:, second], difference, out=np.zeros_like(difference), where=difference != 0)
    best = np.full(len(half), -np.inf)
    for w in np.moveaxis(np.clip(cancel, 0.0, 1.0), 2, 0):
        finite = np.isfinite(value[:, first]) & np.isfinite(value[:, second])
        heights = [
            np.where(finite, a, 0.0) for a in (value[:, first] - error[:, first], value[:, second] - error[:, second])
        ]
        mean = w * heights[0] + (1 - w) * heights[1]
        tilt = np.abs(w[..., None] * slope[:, first] + (1 - w)[..., None] * slope[:, second])
        loss = (tilt * half[:, None, :]).sum(axis=-1) * (1 + ROUNDING) + ROUNDING * np.abs(
            error[:, first] + error[:, second]
        )
        best = np.maximum(best, np.where(finite, mean - loss, -np.inf).max(axis=1))
    return best
