"""Peaks of the rates of a motion, piece by piece, and the finite sets of points at which an NLP holds the limits.

A limit |r(u)| <= 1 over a whole piece is held at points u_k. A plain point only cuts: where an optimum rests on a peak
that moves with the durations, points alone close in on it slowly, as cutting planes do. So a peak also carries a
curvature correction kappa = 1/(2 r''(u_k)), and the row reads r(u_k) - kappa r'(u_k)^2: the height of the peak to
second order in its shift, which is the first and second derivative of the peak value itself where r'(u_k) = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from study import polynomial
from study.problem import Floats, Problem
from study.trajectory import Trajectory

Mask = NDArray[np.bool_]

INTERIOR = 1e-9
"""A peak nearer to the end of its piece than this stands at the end and does not move."""

NEAR = 0.06
"""A peak that has moved less than this since the last round is the same peak."""


@dataclass(frozen=True, eq=False)
class Critical:
    """Points that include every extremum of a rate; all arrays of shape (n_pieces, n_joints, n_points).

    Attributes
    ----------
    points : array
        Fractions of the piece in [0, 1].
    ratios : array
        Rate over its limit, with its sign.
    corrections : array
        kappa of a peak inside its piece, else 0.
    """

    points: Floats
    ratios: Floats
    corrections: Floats


def corrections_of(curvature: Floats, level: Mask, ratios: Floats, points: Floats) -> Floats:
    """Curvature correction of every level peak inside its piece whose curvature is clear enough to divide by."""
    inside = (points > INTERIOR) & (points < 1 - INTERIOR)
    peaked = inside & level & (-curvature * np.sign(ratios) > 1e-2 * np.abs(ratios))
    return np.divide(0.5, curvature, out=np.zeros_like(curvature), where=peaked)


def is_root(coefficients: Floats, points: Floats) -> Mask:
    """Mask of the points at which polynomials vanish; `polynomial.roots` also returns points that are no roots."""
    size = np.abs(coefficients).sum(axis=-1)[..., None]
    return np.abs(polynomial.value(coefficients[..., None, :], points)) <= 1e-9 * size


def polynomial_critical(problem: Problem, motion: Trajectory, order: int, pieces: slice = slice(None)) -> Critical:
    """Critical points of a rate, order 1 to 3, on some pieces of a motion that is polynomial in time."""
    widths = np.diff(motion.knots)[pieces, None, None]
    rate = np.moveaxis(motion.coefficients[pieces], 1, 2) * widths ** (np.arange(motion.degree + 1) - order)
    for _ in range(order):
        rate = polynomial.derivative(rate)
    rate = rate / problem.limits.rates[order - 1][:, None]
    slope = polynomial.derivative(rate)
    critical = polynomial.roots(slope)
    edge = np.zeros((*critical.shape[:-1], 1))
    points = np.concatenate([edge, critical, edge + 1.0], axis=-1)
    ratios = polynomial.value(rate[..., None, :], points)
    curvature = polynomial.value(polynomial.derivative(slope)[..., None, :], points)
    return Critical(points, ratios, corrections_of(curvature, is_root(slope, points), ratios, points))


class Slots:
    """Points at which a limit stands in the NLP, in rows of slots; NaN marks a slot that is still free.

    Parameters
    ----------
    shape : tuple of (n_pieces, n_columns, n_slots)
    pooled : bool
        Whether one column serves the points of all joints, each with the sign of its peak; else there is a column for
        every joint, whose rows hold a limit on both sides.
    """

    def __init__(self, shape: tuple[int, int, int], *, pooled: bool = False) -> None:
        self.pooled = pooled
        self.points = np.full(shape, np.nan)
        self.corrections = np.zeros(shape)
        self.signs = np.ones(shape)
        self.joints = np.zeros(shape, dtype=int)
        self._met = np.zeros(shape)
        self._rounds = 0

    @property
    def used(self) -> Mask:
        """Mask of the slots that hold a point."""
        return ~np.isnan(self.points)

    def filled(self) -> Floats:
        """Points, with the middle of the piece in slots that are free."""
        return np.where(self.used, self.points, 0.5)

    def preset(self, points: tuple[float, ...]) -> None:
        """Put plain points into the first slots of every row, for good."""
        self.points[:, :, : len(points)] = points
        self._met[:, :, : len(points)] = np.inf

    def refresh(self, critical: Critical, threshold: float, corrected: bool) -> None:
        """Add every point whose ratio exceeds a threshold, highest first, in place of the point it has moved from.

        Points that are not met again lose their correction and stay as plain cuts.
        """
        self._rounds += 1
        reach = np.where(self.corrections != 0, NEAR, INTERIOR)
        self.corrections = np.zeros_like(self.corrections)
        height = np.abs(critical.ratios)
        chosen = np.argwhere(height > threshold)
        ranked = chosen[np.argsort(-height[tuple(chosen.T)], kind="stable")]
        fresh: set[tuple[int, int, int]] = set()
        for piece, joint, k in ranked.tolist():
            column = 0 if self.pooled else joint
            point, sign = critical.points[piece, joint, k], np.sign(critical.ratios[piece, joint, k])
            slot = self._place((piece, column), point, joint, sign, reach)
            if (piece, column, slot) in fresh:
                continue
            fresh.add((piece, column, slot))
            where = piece, column, slot
            self.points[where], self.joints[where], self.signs[where] = point, joint, sign
            self.corrections[where] = critical.corrections[piece, joint, k] if corrected else 0.0
            self._met[where] = max(self._met[where], self._rounds)

    def _place(self, row: tuple[int, int], point: float, joint: int, sign: float, reach: Floats) -> int:
        """Slot of the same peak before; else a free one; else that of the point met longest ago."""
        points = self.points[row]
        gap = np.where(np.isnan(points), np.inf, np.abs(points - point))
        same = gap <= reach[row]
        if self.pooled:
            same &= (self.joints[row] == joint) & (self.signs[row] == sign)
        if same.any():
            return int(np.where(same, gap, np.inf).argmin())
        free = np.flatnonzero(np.isnan(points))
        return int(free[0]) if len(free) else int(self._met[row].argmin())
