"""Compiled peak rates of the parametric B-spline: the same closed forms and cubics as in NumPy, piece by piece.

With t' = e0 + e1 u + e2 u^2 and q' = d0 + d1 u + d2 u^2, velocity is q'/t' and acceleration N/t'^3 with N = q''t' -
q't''.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from study.curves.compiled.kernels import inlined, kernel
from study.problem import Floats

Number = Any


@inlined
def _value(c: Number, u: Number) -> Number:
    return (c[2] * u + c[1]) * u + c[0]


@inlined
def _cubic(c: Number, u: Number) -> Number:
    return ((c[3] * u + c[2]) * u + c[1]) * u + c[0]


@kernel
def _inside(x: Number) -> Number:
    """Clip into [0, 1]; what is not a number becomes 0."""
    return min(max(x, 0.0), 1.0) if x == x else 0.0


@kernel
def _turns(c: Number, b: Number, a: Number) -> Number:
    """Points of [0, 1] in order that include every root of c + b u + a u^2 there."""
    q = -0.5 * (b + np.copysign(np.sqrt(max(b * b - 4.0 * a * c, 0.0)), b))
    x, y = _inside(q / a), _inside(c / q)
    return min(x, y), max(x, y)


@kernel
def _root(c: Number, low: Number, high: Number, f_low: Number, f_high: Number) -> Number:
    """Root of a monotone cubic in a bracket by Newton steps, halving where one would leave; low if there is none."""
    if f_low * f_high >= 0.0:
        return low
    rising = f_low < 0.0
    u = low + (high - low) * (f_low / (f_low - f_high))
    for _ in range(60):
        f = _cubic(c, u)
        if (f < 0.0) == rising:
            low = u
        else:
            high = u
        following = u - f / ((3.0 * c[3] * u + 2.0 * c[2]) * u + c[1])
        if not (low < following < high):
            following = 0.5 * (low + high)
        if abs(following - u) < 1e-10:  # an extremum needs a root only to sqrt(eps)
            return following
        u = following
    return u


@kernel
def _slowest(e: Number) -> Number:
    """Least t'(u) on a piece; without an advancing time there is no motion."""
    turn = _inside(-0.5 * e[1] / e[2])
    return min(e[0], e[0] + e[1] + e[2], _value(e, turn))


@kernel
def _velocity(d: Number, e: Number, n: Number) -> Number:
    """Peak velocity on a piece, at its ends and where N = 0."""
    x, y = _turns(n[0], n[1], n[2])
    ends = max(abs(d[0] / e[0]), abs((d[0] + d[1] + d[2]) / (e[0] + e[1] + e[2])))
    return max(ends, abs(_value(d, x) / _value(e, x)), abs(_value(d, y) / _value(e, y)))


@kernel
def _acceleration(e: Number, n: Number) -> Number:
    """Peak acceleration on a piece, at its ends, at the turns of M = N't' - 3Nt'' and at its roots."""
    m = (
        n[1] * e[0] - 3.0 * n[0] * e[1],
        2.0 * (n[2] * e[0] - n[1] * e[1] - 3.0 * n[0] * e[2]),
        -n[2] * e[1] - 5.0 * n[1] * e[2],
        -4.0 * n[2] * e[2],
    )
    x, y = _turns(m[1], 2.0 * m[2], 3.0 * m[3])
    f_x, f_y = _cubic(m, x), _cubic(m, y)
    peak = abs((n[0] + n[1] + n[2]) / (e[0] + e[1] + e[2]) ** 3)
    first = _root(m, 0.0, x, m[0], f_x)
    second = _root(m, x, y, f_x, f_y)
    third = _root(m, y, 1.0, f_y, _cubic(m, 1.0))
    for u in (0.0, first, second, third):
        peak = max(peak, abs(_value(n, u) / _value(e, u) ** 3))
    return peak


@kernel
def _rates(to_time: Number, durations: Number, e: Number) -> Number:
    """Write t' of every piece of one candidate and return its least value."""
    slowest = np.inf
    for s in range(e.shape[0]):
        for k in range(3):
            total = 0.0
            for r in range(e.shape[0]):
                total += to_time[s, k, r] * durations[r]
            e[s, k] = total
        slowest = min(slowest, _slowest((e[s, 0], e[s, 1], e[s, 2])))
    return slowest


@kernel
def fill(position: Floats, to_time: Floats, durations: Floats, result: Floats) -> None:
    """Write peak velocity and acceleration, infinite where time does not advance.

    Parameters
    ----------
    position : array of shape (n_segments, n_joints, 3), rad or m
        Coefficients of q'(u) on every piece, ascending powers.
    to_time : array of shape (n_segments, 3, n_segments)
        Coefficients of t'(u) for each unit duration.
    durations : array of shape (n_candidates, n_segments), s
    result : array of shape (2, n_joints, n_candidates)
    """
    e = np.empty((position.shape[0], 3))
    for i in range(durations.shape[0]):
        if not _rates(to_time, durations[i], e) > 0.0:
            result[:, :, i] = np.inf
            continue
        result[:, :, i] = 0.0
        for s in range(position.shape[0]):
            rate = e[s, 0], e[s, 1], e[s, 2]
            for j in range(position.shape[1]):
                d = position[s, j, 0], position[s, j, 1], position[s, j, 2]
                n = (
                    d[1] * rate[0] - d[0] * rate[1],
                    2.0 * (d[2] * rate[0] - d[0] * rate[2]),
                    d[2] * rate[1] - d[1] * rate[2],
                )
                result[0, j, i] = max(result[0, j, i], _velocity(d, rate, n))
                result[1, j, i] = max(result[1, j, i], _acceleration(rate, n))
