"""Polynomials over [0, 1] by their Bernstein coefficients, in extended precision: values, parts and enclosed suprema."""

from __future__ import annotations

from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.trajectory import Trajectory

Long = NDArray[np.floating[Any]]

GAP = 1e-10
"""Width to which suprema are enclosed, as a share of what is allowed."""


class Curve:
    """A motion in extended precision, every piece over [0, 1]."""

    def __init__(self, motion: Trajectory) -> None:
        self.knots = motion.knots.astype(np.longdouble)
        self.local = np.moveaxis(motion.coefficients, 1, 2).astype(np.longdouble)
        self.passed = np.concatenate([[0.0], motion.waypoint_times[1:-1], [motion.duration]]).astype(np.longdouble)

    def power(self, order: int) -> Long:
        """Coefficients of a derivative in powers of time, shape (n_pieces, n_joints, degree + 1)."""
        power = self.local
        for _ in range(order):
            power = power[..., 1:] * np.arange(1, power.shape[-1]) if power.shape[-1] > 1 else 0 * power
        return power

    def size(self) -> np.longdouble:
        """Largest number that double precision has to hold."""
        return max(np.abs(numbers).max() for k in range(4) for numbers in (self.power(k), self.unit(k)))

    def unit(self, order: int) -> Long:
        """Bernstein coefficients of a derivative, shape (n_pieces, n_joints, degree + 1)."""
        power = self.power(order)
        widths = np.diff(self.knots)[:, None, None] ** np.arange(power.shape[-1])
        return as_bernstein(power * widths)

    def at(self, time: np.longdouble, order: int = 0, left: bool = False) -> Long:
        """Value at a time, shape (n_joints,); at a knot that of the piece after or before it."""
        piece = int(np.searchsorted(self.knots, time, side="left" if left else "right")) - 1
        piece = min(max(piece, 0), len(self.local) - 1)
        u = (time - self.knots[piece]) / (self.knots[piece + 1] - self.knots[piece])
        return halved(self.unit(order)[piece], u)[0][..., -1]

    def between(self, start: np.longdouble, stop: np.longdouble, order: int = 0) -> Long:
        """Bernstein coefficients of the pieces between two times, cut off there."""
        parts = []
        for piece, coefficients in enumerate(self.unit(order)):
            low, high = max(start, self.knots[piece]), min(stop, self.knots[piece + 1])
            if low >= high or high - low <= 1e-12 * self.knots[-1] < stop - start:
                continue
            width = self.knots[piece + 1] - self.knots[piece]
            rest = halved(coefficients, (low - self.knots[piece]) / width)[1]
            share = (high - low) / (self.knots[piece + 1] - low)
            parts.append(halved(rest, share)[0])
        return np.array(parts).reshape(-1, *self.unit(order).shape[1:])

    def segment(self, segment: int, order: int = 0) -> Long:
        """Bernstein coefficients of the pieces between two neighbouring waypoints."""
        start, stop = self.passed[segment : segment + 2]
        return self.between(start, stop, order)


def as_bernstein(power: Long) -> Long:
    """Bernstein coefficients over [0, 1] of polynomials in ascending powers."""
    return power @ _to_bernstein(power.shape[-1] - 1).T


def _to_bernstein(degree: int) -> Long:
    rows = [[comb(i, m) / np.longdouble(comb(degree, m)) for m in range(degree + 1)] for i in range(degree + 1)]
    return np.array(rows, dtype=np.longdouble)


def halved(coefficients: Long, u: float | np.longdouble = 0.5) -> tuple[Long, Long]:
    """Bernstein coefficients of both parts of polynomials that are cut at u, by de Casteljau's scheme."""
    work, left, right = coefficients.copy(), coefficients.copy(), coefficients.copy()
    degree = coefficients.shape[-1] - 1
    for step in range(1, degree + 1):
        work = work[..., :-1] + u * (work[..., 1:] - work[..., :-1])
        left[..., step] = work[..., 0]
        right[..., degree - step] = work[..., -1]
    return left, right


def suprema(coefficients: Long) -> tuple[Long, Long]:
    """Enclose the supremum over [0, 1] of each polynomial, given by Bernstein coefficients of shape (n, degree + 1).

    Those that clearly exceed 1 are not followed any further.
    """
    owner = np.arange(len(coefficients))
    low = np.maximum(coefficients[:, 0], coefficients[:, -1])
    high = low.copy()
    for _ in range(60):
        top = coefficients.max(axis=1, initial=-np.inf)
        open_ = (top > low[owner] + GAP) & (low[owner] < 1.001) & (top > 0.99)
        np.maximum.at(high, owner[~open_], top[~open_])
        coefficients, owner = coefficients[open_], owner[open_]
        if not len(owner):
            return low, high
        left, right = halved(coefficients)
        np.maximum.at(low, owner, left[:, -1])
        coefficients, owner = np.concatenate([left, right]), np.concatenate([owner, owner])
    np.maximum.at(high, owner, coefficients.max(axis=1))
    return low, high


def stacked(questions: list[Long]) -> Long:
    """Raise polynomials to one degree and put them in one list."""
    flat = [question.reshape(-1, question.shape[-1]) for question in questions if question.size]
    degree = max(question.shape[-1] for question in flat) - 1
    return np.concatenate([_raised(question, degree) for question in flat])


def _raised(coefficients: Long, degree: int) -> Long:
    while (n := coefficients.shape[-1]) <= degree:
        share = np.arange(n + 1) / np.longdouble(n)
        padded = np.pad(coefficients, ((0, 0), (1, 1)))
        coefficients = share * padded[:, :-1] + (1 - share) * padded[:, 1:]
    return coefficients
