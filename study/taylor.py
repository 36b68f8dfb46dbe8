"""Functions over short intervals as polynomials with a proved rest, so that bounds between samples are theorems.

A model over u in [-1, 1] is a polynomial of degree at most 3 and a radius: the function is nowhere further from the polynomial.
Sums and products keep that true, whatever they leave out; a model of degree 0 and radius 0 is a plain number. Rounding
is not enclosed: it is some 1e-15 of the largest intermediate value.

References
----------
K. Makino, M. Berz, Taylor models and other validated functional inclusion methods, Int. J. Pure Appl. Math. 4(4), 2003.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.arrays import Floats

DEGREE = 3


@dataclass(frozen=True, eq=False)
class Model:
    """Functions of u, batched: one for each entry of the trailing axes.

    Attributes
    ----------
    poly : array of shape (degree + 1, ...)
        Ascending powers of u.
    rest : array of shape (...)
        Radius around the polynomial, not negative.
    """

    poly: Floats
    rest: Floats

    @classmethod
    def of(cls, ascending: Floats) -> Model:
        """Enclose polynomials of any degree, ascending powers on the first axis, in models of degree `DEGREE`."""
        poly = np.zeros((DEGREE + 1, *ascending.shape[1:]))
        poly[: len(ascending)] = ascending[: DEGREE + 1]
        return cls(poly, np.abs(ascending[DEGREE + 1 :]).sum(axis=0))

    @property
    def size(self) -> Floats:
        """Bound of the polynomial's absolute value, shape (...)."""
        return np.abs(self.poly).sum(axis=0)

    def __add__(self, other: Model) -> Model:
        return Model(self.poly + other.poly, self.rest + other.rest)

    def __sub__(self, other: Model) -> Model:
        return Model(self.poly - other.poly, self.rest + other.rest)

    def __mul__(self, other: Model | Floats | float) -> Model:
        if not isinstance(other, Model):
            return Model(self.poly * other, self.rest * np.abs(other))
        kept = len(self.poly)
        full = np.zeros((2 * kept - 1, *np.broadcast_shapes(self.rest.shape, other.rest.shape)))
        for power in range(kept):
            full[power : power + kept] += self.poly[power] * other.poly
        rest = self.size * other.rest + self.rest * (other.size + other.rest)
        return Model(full[:kept], rest + np.abs(full[kept:]).sum(axis=0))

    def __getitem__(self, index: Any) -> Model:
        return Model(self.poly[:, index], self.rest[index])

    def mapped(self, matrix: Floats) -> Model:
        """Linear image of vectors that stand on the first axis behind the powers; matrix of shape (n_images, n)."""
        return Model(np.einsum("ij,dj...->di...", matrix, self.poly), np.abs(matrix) @ self.rest)

    def inverse(self) -> Model:
        """One over a function; where the model does not exclude zero, the rest is infinite."""
        centre = self.poly[0]
        share = Model(self.poly / centre, self.rest / np.abs(centre))
        share.poly[0] = 0.0
        reach = share.size + share.rest
        square = share * share
        series = share * -1.0 + square - square * share
        series.poly[0] += 1.0
        with np.errstate(divide="ignore", invalid="ignore"):
            beyond = np.where(reach < 1, reach**4 / (1 - reach), np.inf)
        return Model(series.poly, series.rest + beyond) * (1 / centre)

    def range(self) -> tuple[Floats, Floats]:
        """Numbers that no value is below or above, both of shape (...); infinite where the model is not finite."""
        odd = np.abs(self.poly[1::2]).sum(axis=0) + self.rest
        even = self.poly[2::2]
        low = self.poly[0] - odd + np.minimum(even, 0.0).sum(axis=0)
        high = self.poly[0] + odd + np.maximum(even, 0.0).sum(axis=0)
        return np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)

    def values(self) -> Floats:
        """Polynomial's values at the start, in the middle and at the end of the interval, shape (3, ...)."""
        signs = (-1.0) ** np.arange(len(self.poly))
        return np.stack([np.tensordot(signs, self.poly, 1), self.poly[0], self.poly.sum(axis=0)])


def stacked(parts: Sequence[Model]) -> Model:
    """Put functions on one new axis behind the powers."""
    return Model(np.stack([part.poly for part in parts], axis=1), np.stack([part.rest for part in parts]))


def cross(first: Model, second: Model) -> Model:
    """Vector product of vectors of shape (3, n)."""
    return first[[1, 2, 0]] * second[[2, 0, 1]] - first[[2, 0, 1]] * second[[1, 2, 0]]


def sine_cosine(angle: Model) -> tuple[Model, Model]:
    """Sine and cosine by their series about the middle, with Lagrange's bound of what is left out."""
    sine, cosine = np.sin(angle.poly[0]), np.cos(angle.poly[0])
    away = Model(angle.poly.copy(), angle.rest)
    away.poly[0] = 0.0
    reach = away.size + away.rest
    square = away * away
    cube = square * away
    odd = away - cube * (1 / 6)
    even = square * -0.5
    even.poly[0] += 1.0
    odd = Model(odd.poly, odd.rest + reach**5 / 120)
    even = Model(even.poly, even.rest + reach**4 / 24)
    return odd * cosine + even * sine, even * cosine - odd * sine
