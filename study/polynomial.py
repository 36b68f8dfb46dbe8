"""Roots and extrema of whole batches of polynomials on the unit interval, without sampling.

Coefficients stand in ascending powers on the last axis. `roots` returns points that *include* every real root
in [0, 1]; slots without a root hold another point of the interval, which never harms an extremum search.
"""

from __future__ import annotations

import numpy as np

from study.problem import Floats


def value(coefficients: Floats, u: Floats) -> Floats:
    """Evaluate by Horner's rule; leading axes of both arguments broadcast."""
    result = np.zeros(np.broadcast_shapes(coefficients.shape[:-1], np.shape(u)))
    for k in reversed(range(coefficients.shape[-1])):
        result = result * u + coefficients[..., k]
    return result


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
        if degree == 1:
            return _unit(-coefficients[..., :1] / coefficients[..., 1:])
        if degree == 2:
            return _quadratic_roots(coefficients)
        return _bracketed_roots(coefficients)


def _unit(u: Floats) -> Floats:
    return np.clip(np.nan_to_num(u, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)


def _quadratic_roots(coefficients: Floats) -> Floats:
    c, b, a = np.moveaxis(coefficients, -1, 0)
    discriminant = b * b - 4.0 * a * c
    q = -0.5 * (b + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), b))
    return _unit(np.stack([q / a, c / q], axis=-1))


def _bracketed_roots(coefficients: Floats) -> Floats:
    slope = derivative(coefficients)
    inner = np.sort(roots(slope), axis=-1)
    edge = np.zeros((*inner.shape[:-1], 1))
    points = np.concatenate([edge, inner, edge + 1.0], axis=-1)
    values = value(coefficients[..., None, :], points)
    low, high = points[..., :-1].copy(), points[..., 1:].copy()
    f_low, f_high = values[..., :-1], values[..., 1:]
    bracketed = np.sign(f_low) * np.sign(f_high) < 0
    found = np.where(np.abs(f_high) < np.abs(f_low), high, low)
    if not bracketed.any():
        return found
    index = np.nonzero(bracketed)
    cells = index[:-1]
    found[index] = _close_brackets(coefficients[cells], slope[cells], low[index], high[index], f_low[index])
    return found


def _close_brackets(coefficients: Floats, slope: Floats, low: Floats, high: Floats, f_low: Floats) -> Floats:
    rising = f_low < 0
    u = 0.5 * (low + high)
    for _ in range(100):
        f = value(coefficients, u)
        left = (f < 0) == rising
        low, high = np.where(left, u, low), np.where(left, high, u)
        newton = u - f / value(slope, u)
        inside = (newton > low) & (newton < high)
        following = np.where(inside, newton, 0.5 * (low + high))
        settled = np.abs(following - u) <= 4e-16 + 1e-15 * np.abs(u)
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
