"""Roots and extrema of whole batches of polynomials on the unit interval, without sampling.

Coefficients stand in ascending powers on the last axis. `roots` returns points that *include* every real root
in [0, 1]; slots without a root hold another point of the interval, which never harms an extremum search.
"""

from __future__ import annotations

from functools import cache
from math import comb
from typing import Any

import numpy as np

from study.problem import Floats

SETTLED = 1e-9
"""Step of Newton's iteration on the unit interval, the last one; what it leaves is of the order of its square."""

VANISHING = 4e-16
"""Value of a polynomial of size 1 that cannot be told from zero."""


def value(coefficients: Floats, u: Floats) -> Floats:
    """Evaluate by Horner's rule; leading axes of both arguments broadcast."""
    last = coefficients.shape[-1] - 1
    if last < 1:
        return np.zeros(np.broadcast_shapes(coefficients.shape[:-1], np.shape(u))) + coefficients[..., 0]
    result = coefficients[..., last] * u
    for k in reversed(range(1, last)):
        result += coefficients[..., k]
        result *= u
    return np.asarray(result + coefficients[..., 0])


def derivative(coefficients: Floats) -> Floats:
    """Differentiate; a constant becomes the zero constant."""
    if coefficients.shape[-1] == 1:
        return np.zeros_like(coefficients)
    return coefficients[..., 1:] * np.arange(1, coefficients.shape[-1])


def product(a: Floats, b: Floats) -> Floats:
    """Multiply two batches of polynomials; leading axes broadcast."""
    shape = np.broadcast_shapes(a.shape[:-1], b.shape[:-1])
    result = np.zeros((*shape, a.shape[-1] + b.shape[-1] - 1))
    for k in range(a.shape[-1]):
        result[..., k : k + b.shape[-1]] += a[..., k, None] * b
    return result


def shifted(coefficients: Floats, u: Floats | float) -> Floats:
    """Move the origin to u: the result at v is the polynomial at u + v; u broadcasts against the leading axes."""
    result = coefficients.copy()
    degree = result.shape[-1] - 1
    for first in range(degree):
        for k in reversed(range(first, degree)):
            result[..., k] += u * result[..., k + 1]
    return result


def stretched(coefficients: Floats, width: Floats | float) -> Floats:
    """Measure the argument in a new unit: the result at v is the polynomial at width * v.

    A power is never formed by itself: it could vanish although its product with the coefficient does not.
    """
    result = coefficients.copy()
    for first in range(1, result.shape[-1]):
        result[..., first:] *= width if np.ndim(width) == 0 else np.asarray(width)[..., None]
    return result


def clipped(coefficients: Floats, start: float, stop: float) -> Floats:
    """Take the part between start and stop, over [0, 1] again."""
    return stretched(shifted(coefficients, start), stop - start)


def composed(outer: Floats, inner: Floats) -> Floats:
    """Put one batch of polynomials into another, outer(inner(u)); leading axes broadcast."""
    result = outer[..., -1:]
    for power in reversed(range(outer.shape[-1] - 1)):
        result = product(result, inner)
        result[..., 0] += outer[..., power]
    return result


def hermite_quintic(step: Any, v0: Any, v1: Any, a0: Any, a1: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Coefficients of u to u^5 of the quintic from 0 to a step with given rates at both ends of the unit interval.

    Parameters
    ----------
    step, v0, v1, a0, a1 : arrays or symbolic expressions of one shape
        Position at the end; first and second derivative at the start and at the end, by u.
    """
    c3 = 10 * step - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1
    c4 = -15 * step + 8 * v0 + 7 * v1 + 1.5 * a0 - a1
    c5 = 6 * step - 3 * (v0 + v1) + 0.5 * (a1 - a0)
    return v0, 0.5 * a0, c3, c4, c5


def roots(coefficients: Floats) -> Floats:
    """Find all real roots in [0, 1].

    Parameters
    ----------
    coefficients : array of shape (..., degree + 1), ascending powers

    Returns
    -------
    array of shape (..., degree)
        Points of [0, 1] that include every root there.

    Notes
    -----
    Degrees 1 and 2 are closed forms free of cancellation. A higher degree is split at the roots of its derivative into
    monotone pieces, each of which brackets at most one root; a safeguarded Newton iteration closes the bracket.
    """
    degree = coefficients.shape[-1] - 1
    with np.errstate(all="ignore"):
        if degree == 0:
            return np.zeros((*coefficients.shape[:-1], 0))
        sized = _sized(coefficients)
        if degree <= 2:
            return np.stack(roots_of_terms(tuple(np.moveaxis(sized, -1, 0))), axis=-1)
        return _bracketed_roots(sized)


def _sized(coefficients: Floats) -> Floats:
    """Bring every polynomial to the size of 1 by a power of two, so that no product overflows or vanishes."""
    _, exponent = np.frexp(np.abs(coefficients).max(axis=-1, keepdims=True))
    return np.ldexp(coefficients, -exponent)


def _unit(u: Floats) -> Floats:
    """Clip into [0, 1]; what is not a number becomes 1."""
    return np.fmax(np.fmin(u, 1.0), 0.0)


def _bracketed_roots(coefficients: Floats) -> Floats:
    slope = derivative(coefficients)
    inner = np.sort(roots(slope), axis=-1)
    edge = np.zeros((*inner.shape[:-1], 1))
    points = np.concatenate([edge, inner, edge + 1.0], axis=-1)
    values = value(coefficients[..., None, :], points)
    values = np.where(np.abs(values) <= VANISHING, 0.0, values)  # as at a triple root, which Newton nears slowly
    low, high = points[..., :-1].copy(), points[..., 1:].copy()
    f_low, f_high = values[..., :-1], values[..., 1:]
    bracketed = np.sign(f_low) * np.sign(f_high) < 0
    zeros = np.where(np.abs(f_high) < np.abs(f_low), high, low)
    if not bracketed.any():
        return zeros
    index = np.nonzero(bracketed)
    cells = index[:-1]
    zeros[index] = _close_brackets(coefficients[cells], slope[cells], low[index], high[index], f_low[index])
    return zeros


def _close_brackets(coefficients: Floats, slope: Floats, low: Floats, high: Floats, f_low: Floats) -> Floats:
    rising = f_low < 0
    u = 0.5 * (low + high)
    for _ in range(100):
        f = value(coefficients, u)
        left = (f < 0) == rising
        low, high = np.where(left, u, low), np.where(left, high, u)
        newton = np.where(f == 0, u, u - f / value(slope, u))
        inside = (newton >= low) & (newton <= high)  # at a root the step ends on the bracket, and so it may
        following = np.where(inside, newton, 0.5 * (low + high))
        settled = (np.abs(following - u) <= SETTLED) & inside | (high - low <= 4e-16 + 1e-15 * np.abs(u))
        u = following
        if settled.all():
            break
    return u


def extrema(coefficients: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Find the smallest and largest value on [0, 1] and where they are.

    Parameters
    ----------
    coefficients : array of shape (..., degree + 1), ascending powers

    Returns
    -------
    lowest, at_lowest, highest, at_highest : arrays of shape (...)
    """
    critical = roots(derivative(coefficients))
    edge = np.zeros((*critical.shape[:-1], 1))
    points = np.concatenate([edge, critical, edge + 1.0], axis=-1)
    values = value(coefficients[..., None, :], points)
    return pick_extrema(points, values)


def may_be_extreme(coefficients: Floats) -> np.ndarray:
    """Mask of the polynomials that may hold the smallest or the largest value of their column on [0, 1].

    A polynomial lies between its smallest and largest Bernstein coefficient, and its column's extremes are no less wide
    than the values at the ends. What is not a number may be an extreme.

    Parameters
    ----------
    coefficients : array of shape (n, n_columns, degree + 1), ascending powers

    Returns
    -------
    bool array of shape (n, n_columns)

    References
    ----------
    G. Farin, Curves and Surfaces for CAGD, 5th ed., 2002: convex hull property of the Bernstein form.
    """
    with np.errstate(all="ignore"):
        hull = coefficients @ _into_bernstein(coefficients.shape[-1] - 1)
        rounding = 1e-12 * np.abs(coefficients).sum(axis=-1).max(axis=0)
        ends = hull[..., [0, -1]]
        low, high = ends.min(axis=(0, 2)) + rounding, ends.max(axis=(0, 2)) - rounding
        return np.asarray(~((hull.min(axis=-1) > low) & (hull.max(axis=-1) < high)))


@cache
def _into_bernstein(degree: int) -> Floats:
    return np.array([[comb(i, k) / comb(degree, k) for i in range(degree + 1)] for k in range(degree + 1)])


def pick_extrema(points: Floats, values: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Pick the smallest and largest value along the last axis and the points where they stand."""
    low = values.argmin(axis=-1, keepdims=True)
    high = values.argmax(axis=-1, keepdims=True)
    picked = [np.take_along_axis(a, i, -1)[..., 0] for i in (low, high) for a in (values, points)]
    return picked[0], picked[1], picked[2], picked[3]


def peak(coefficients: Floats) -> Floats:
    """Largest absolute value on [0, 1], shape (...)."""
    lowest, _, highest, _ = extrema(coefficients)
    return np.maximum(-lowest, highest)


Terms = tuple[Floats, ...]


def value_of_terms(terms: Terms, u: Floats | float) -> Floats:
    """Evaluate a polynomial given term by term, so that populations stay contiguous in memory."""
    result = terms[-1] + np.zeros_like(u)
    for term in reversed(terms[:-1]):
        result = result * u + term
    return result


def peak_of_terms(terms: Terms, slope: Terms) -> Floats:
    """Largest absolute value on [0, 1] of polynomials of degree at most 4, closed form.

    Parameters
    ----------
    terms, slope : tuples of arrays of one shape
        Ascending coefficients of the polynomials and of their derivatives.

    Returns
    -------
    array of the terms' shape
    """
    result = np.maximum(np.abs(terms[0]), np.abs(sum(terms)))
    for root in roots_of_terms(slope):
        np.maximum(result, np.abs(value_of_terms(terms, root)), out=result)
    return result


def roots_of_terms(terms: Terms) -> Terms:
    """Points of [0, 1] that include every real root, for degrees 1 to 3, as closed forms.

    A root within sqrt(eps) serves an extremum to rounding, because the value is stationary there; so the cubic formula
    needs no polishing, and only a leading coefficient that nearly vanishes goes to the bracketing solver.
    """
    with np.errstate(all="ignore"):
        if len(terms) == 2:
            return (_unit(-terms[0] / terms[1]),)
        if len(terms) == 3:
            c, b, a = terms
            q = -0.5 * (b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0)), b))
            return _unit(q / a), _unit(c / q)
        return _cubic_roots(terms)


def _cubic_roots(terms: Terms) -> Terms:
    """Viete's trigonometric form where all roots are real, Cardano's where one is, for t^3 + 3 p t + 2 q."""
    lead = terms[3]
    c0, c1, b = terms[0] / (2 * lead), terms[1] / (3 * lead), terms[2] / (3 * lead)
    p = c1 - b * b
    q = b * (b * b - 1.5 * c1) + c0
    square = q * q + p * p * p
    root = np.sqrt(np.abs(square))
    three = square < 0
    angle = np.arctan2(root, -q) / 3
    m = np.sqrt(np.maximum(-p, 0.0))
    cosine, sine = m * np.cos(angle), m * (np.sqrt(3.0) * np.sin(angle))
    a = -np.copysign(np.cbrt(np.abs(q) + root), q)
    single = a - np.where(a == 0, 0.0, p / a)
    zeros = np.stack([np.where(three, r, single) for r in (2 * cosine, -cosine - sine, sine - cosine)])
    zeros = _unit(zeros - b)
    weak = np.abs(lead) < 1e-3 * (np.abs(terms[2]) + np.abs(terms[1]) + np.abs(terms[0]))
    if weak.any():
        zeros[:, weak] = roots(np.stack([np.broadcast_to(t, weak.shape)[weak] for t in terms], axis=-1)).T
    return tuple(zeros)
