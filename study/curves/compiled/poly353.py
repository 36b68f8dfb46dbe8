"""Compiled peak rates of the 3-5-3 curve: one pass over the candidates for each joint, eight bytes apart in memory.

Everything in that pass is arithmetic and selection without a branch, so that the compiler turns it into vector
instructions. Peak acceleration and jerk are closed forms. Peak velocity needs the roots of a cubic: its turning points
cut the unit interval into three monotone pieces, and in each a fixed number of steps that fit a parabola (exact for
double roots, of third order elsewhere) closes in. A curve whose steps have not settled is finished by a bracketing
loop.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from study.curves.compiled.kernels import inlined, kernel
from study.problem import Floats

Number = Any
SETTLED = (
    1e-13  # of the peak: a third of what one more step may still add (a whole Newton step is all at a simple root)
)


@inlined
def _larger(a: Number, b: Number) -> Number:
    return a if a > b else b


@inlined
def _unit(x: Number) -> Number:
    """Clip into [0, 1]; what is not a number becomes 0."""
    x = x if x > 0.0 else 0.0
    return x if x < 1.0 else 1.0


@inlined
def _cubic(f: Number, u: Number) -> Number:
    return ((f[3] * u + f[2]) * u + f[1]) * u + f[0]


@inlined
def _quartic(v: Number, u: Number) -> Number:
    return (((v[4] * u + v[3]) * u + v[2]) * u + v[1]) * u + v[0]


@inlined
def _turns(f: Number) -> Number:
    """Turning points of a cubic, in order, clipped into [0, 1]; its inflection twice if it has none."""
    c, b, a = f[1], 2.0 * f[2], 3.0 * f[3]
    square = b * b - 4.0 * a * c
    root = np.sqrt(square if square > 0.0 else 0.0)
    q = -0.5 * (b + (root if b > 0.0 else -root))
    x, y = _unit(q / a), _unit(c / q)
    return (x if x < y else y), (y if x < y else x)


@inlined
def _step(f: Number, u: Number, low: Number, high: Number, sign: Number) -> Number:
    """One step to the root of the parabola that touches the cubic at u, kept in the bracket; sign is the slope's."""
    at = _cubic(f, u)
    slope = abs((3.0 * f[3] * u + 2.0 * f[2]) * u + f[1])
    square = slope * slope - 2.0 * at * (6.0 * f[3] * u + 2.0 * f[2])
    below = slope + np.sqrt(square if square > 0.0 else 0.0) + 1e-300
    following = u - sign * (at + at) / below
    following = following if following > low else low
    return following if following < high else high


@inlined
def _halley(f: Number, u: Number, low: Number, high: Number) -> Number:
    """One step of Halley's: of third order too, without a square root, but at its worst near double roots."""
    at = _cubic(f, u)
    slope = (3.0 * f[3] * u + 2.0 * f[2]) * u + f[1]
    bend = 3.0 * f[3] * u + f[2]
    following = u - at * slope / (slope * slope - at * bend)
    following = following if following > low else low
    return following if following < high else high


@inlined
def _extremum(v: Number, f: Number, low: Number, high: Number, f_low: Number, f_high: Number) -> Number:
    """Velocity, squared rest and slope at the acceleration's root between two points; at any point where no root is."""
    sign = 1.0 if f_high > f_low else -1.0
    u = low if abs(f_low) < abs(f_high) else high
    u = _step(f, u, low, high, sign)
    u = _step(f, u, low, high, sign)
    u = _halley(f, u, low, high)
    missed = _cubic(f, u)
    slope = abs((3.0 * f[3] * u + 2.0 * f[2]) * u + f[1])
    return abs(_quartic(v, u)), (missed * missed if f_low * f_high < 0.0 else 0.0), slope


@kernel
def _closed(f: Number, low: Number, high: Number, sign: Number) -> Number:
    """Root of the cubic in a bracket, which shrinks at every step."""
    u = 0.5 * (low + high)
    for _ in range(100):
        if sign * _cubic(f, u) > 0.0:
            high = u
        else:
            low = u
        following = _step(f, u, low, high, sign)
        following = following if low < following < high else 0.5 * (low + high)
        if abs(following - u) < 1e-10:  # an extremum needs a root only to sqrt(eps)
            return following
        u = following
    return u


@kernel
def _settle(v: Number, f: Number) -> Number:
    """Peak velocity on the unit interval, every root closed in to the end; slower, and seldom needed."""
    points = np.empty(4)
    points[0], points[3] = 0.0, 1.0
    points[1], points[2] = _turns(f)
    peak = 0.0
    for k in range(3):
        low, high = points[k], points[k + 1]
        f_low, f_high = _cubic(f, low), _cubic(f, high)
        peak = _larger(peak, _larger(abs(_quartic(v, low)), abs(_quartic(v, high))))
        if f_low * f_high < 0.0:
            peak = _larger(peak, abs(_quartic(v, _closed(f, low, high, 1.0 if f_high > f_low else -1.0))))
    return peak


@kernel
def _quintic(steps: Number, before: Number, after: Number) -> Number:
    """Velocity's and acceleration's coefficients of a middle quintic in unit time, ascending powers."""
    first, middle, last = steps
    v1, v2 = 3.0 * first * before, 3.0 * last * after
    a1, a2 = 2.0 * v1 * before, -2.0 * v2 * after
    c3 = 10.0 * middle - 6.0 * v1 - 4.0 * v2 - 1.5 * a1 + 0.5 * a2
    c4 = -15.0 * middle + 8.0 * v1 + 7.0 * v2 + 1.5 * a1 - a2
    c5 = 6.0 * middle - 3.0 * (v1 + v2) + 0.5 * (a2 - a1)
    return (v1, a1, 3.0 * c3, 4.0 * c4, 5.0 * c5), (a1, 6.0 * c3, 12.0 * c4, 20.0 * c5), v2, a2


@kernel
def _two_peaks(steps: Number, rates: Number, velocity: Number, acceleration: Number, doubt: Number) -> Number:
    """Peak velocity and acceleration of one joint for all candidates, and whether a velocity needs more work."""
    first, _, last = steps
    for i in range(rates.shape[1]):
        r1, r2, r3 = rates[0, i], rates[1, i], rates[2, i]
        v, f, v2, a2 = _quintic(steps, rates[3, i], rates[4, i])
        x, y = _turns(f)
        f_x, f_y = _cubic(f, x), _cubic(f, y)
        left, rest_left, slope_left = _extremum(v, f, 0.0, x, f[0], f_x)
        inner, rest_inner, slope_inner = _extremum(v, f, x, y, f_x, f_y)
        right, rest_right, slope_right = _extremum(v, f, y, 1.0, f_y, a2)
        peak = _larger(_larger(abs(v[0]), abs(v2)), _larger(_larger(left, inner), right))
        velocity[i] = _larger(peak * r2, 3.0 * _larger(abs(first) * r1, abs(last) * r3))
        least = SETTLED * peak  # a Newton step adds rest / slope; multiplied out, because divisions are dear
        beyond = _larger(rest_left - least * slope_left, rest_inner - least * slope_inner)
        doubt[i] = _larger(beyond, rest_right - least * slope_right)
        peak = _larger(_larger(abs(f[0]), abs(a2)), _larger(abs(f_x), abs(f_y)))
        outer = 6.0 * _larger(abs(first) * r1 * r1, abs(last) * r3 * r3)
        acceleration[i] = _larger(peak * r2 * r2, outer)


@kernel
def _jerks(steps: Number, rates: Number, jerk: Number) -> Number:
    """Peak jerk of one joint for all candidates."""
    first, _, last = steps
    for i in range(rates.shape[1]):
        r1, r2, r3 = rates[0, i], rates[1, i], rates[2, i]
        _, f, _, _ = _quintic(steps, rates[3, i], rates[4, i])
        b, a = 2.0 * f[2], 3.0 * f[3]
        turn = _unit(-0.5 * b / a)
        peak = _larger(_larger(abs(f[1]), abs(f[1] + b + a)), abs((a * turn + b) * turn + f[1]))
        jerk[i] = _larger(peak * r2**3, 6.0 * _larger(abs(first) * r1**3, abs(last) * r3**3))


@kernel
def fill(waypoints: Floats, durations: Floats, result: Floats) -> int:
    """Write peak rates.

    Parameters
    ----------
    waypoints : array of shape (4, n_joints), rad or m
    durations : array of shape (n_candidates, 3), s
    result : array of shape (2 or 3, n_joints, n_candidates)
        Peak velocity, acceleration and, if there is room, jerk.

    Returns
    -------
    int
        How many curves the bracketing loop had to finish.
    """
    n = durations.shape[0]
    rates, doubt = np.empty((5, n)), np.empty(n)
    for i in range(n):
        for k in range(3):
            rates[k, i] = 1.0 / durations[i, k]
        rates[3, i], rates[4, i] = durations[i, 1] * rates[0, i], durations[i, 1] * rates[2, i]
    finished = 0
    for j in range(waypoints.shape[1]):
        own = (
            waypoints[1, j] - waypoints[0, j],
            waypoints[2, j] - waypoints[1, j],
            waypoints[3, j] - waypoints[2, j],
        )
        _two_peaks(own, rates, result[0, j], result[1, j], doubt)
        for i in range(n):
            if doubt[i] > 0.0:
                finished += 1
                v, f, _, _ = _quintic(own, rates[3, i], rates[4, i])
                result[0, j, i] = _larger(result[0, j, i], _settle(v, f) * rates[1, i])
        if result.shape[0] == 3:
            _jerks(own, rates, result[2, j])
    return finished
