"""Compiled peak rates of the clamped cubic spline, whose tridiagonal matrix is factored once for all joints."""

from __future__ import annotations

from typing import Any

import numpy as np

from study.curves.compiled.kernels import kernel
from study.problem import Floats

Number = Any


@kernel
def _factor(h: Number, factors: Number, pivots: Number) -> Number:
    """Gaussian elimination of the matrix that all joints share; h are one candidate's durations."""
    n = h.shape[0]
    pivots[0] = 2.0 * h[0]
    for s in range(1, n + 1):
        factors[s] = h[s - 1] / pivots[s - 1]
        following = h[s] if s < n else 0.0
        pivots[s] = 2.0 * (h[s - 1] + following) - factors[s] * h[s - 1]
    for s in range(n + 1):
        pivots[s] = 1.0 / pivots[s]


@kernel
def _accelerations(slopes: Number, h: Number, factors: Number, inverses: Number, m: Number) -> Number:
    """Accelerations at the waypoints of one joint, into m."""
    n = h.shape[0]
    before, above = 0.0, 0.0
    for s in range(n + 1):
        slope = slopes[s] if s < n else 0.0
        above = 6.0 * (slope - before) - (factors[s] * above if s > 0 else 0.0)
        m[s] = above
        before = slope
    m[n] *= inverses[n]
    for s in range(n - 1, -1, -1):
        m[s] = (m[s] - h[s] * m[s + 1]) * inverses[s]


@kernel
def _largest(slopes: Number, h: Number, m: Number) -> Number:
    """Peak velocity, acceleration and jerk of one joint; velocity turns where acceleration changes its sign."""
    n = h.shape[0]
    velocity, acceleration, jerk = 0.0, abs(m[n]), 0.0
    for s in range(n):
        left, right = m[s], m[s + 1]
        start = slopes[s] - h[s] * (2.0 * left + right) / 6.0
        velocity = max(velocity, abs(start))
        if left * right < 0.0:
            velocity = max(velocity, abs(start + h[s] * left * left / (2.0 * (left - right))))
        acceleration = max(acceleration, abs(left))
        jerk = max(jerk, abs(right - left) / h[s])
    return velocity, acceleration, jerk


@kernel
def fill(waypoints: Floats, durations: Floats, result: Floats) -> None:
    """Write peak rates.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s
    result : array of shape (3, n_joints, n_candidates)
        Peak velocity, acceleration and jerk.
    """
    n = durations.shape[1]
    factors, inverses, m, slopes = np.empty(n + 1), np.empty(n + 1), np.empty(n + 1), np.empty(n)
    for i in range(durations.shape[0]):
        h = durations[i]
        _factor(h, factors, inverses)
        for j in range(waypoints.shape[1]):
            for s in range(n):
                slopes[s] = (waypoints[s + 1, j] - waypoints[s, j]) / h[s]
            _accelerations(slopes, h, factors, inverses, m)
            result[0, j, i], result[1, j, i], result[2, j, i] = _largest(slopes, h, m)
