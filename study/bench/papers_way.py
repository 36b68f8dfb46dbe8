"""The papers' way to value a candidate, as the yardstick: one candidate and one joint at a time, rates by sampling.

For 3-5-3 one 14 x 14 system is solved for each joint; for the cubic spline a library's interpolation is built. Each
segment is then sampled at a hundred times.

References
----------
Woodworking paper, Eqs. (4)-(18) for the system; the number of samples is ours, no paper gives it.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from study.problem import Floats, Problem

SAMPLES = 100
PIECES = ((0, 3), (4, 5), (10, 3))
"""First unknown and degree of the three polynomials."""


def system_353(durations: Floats) -> Floats:
    """Matrix of the fourteen conditions on the coefficients of cubic, quintic and cubic."""
    t1, t2, t3 = durations.tolist()
    a = np.zeros((14, 14))
    a[0, :5], a[1, 1:6], a[2, 2:7] = (1, t1, t1**2, t1**3, -1), (1, 2 * t1, 3 * t1**2, 0, -1), (2, 6 * t1, 0, 0, -2)
    a[3, 4:11] = 1, t2, t2**2, t2**3, t2**4, t2**5, -1
    a[4, 5:12] = 1, 2 * t2, 3 * t2**2, 4 * t2**3, 5 * t2**4, 0, -1
    a[5, 6:13] = 2, 6 * t2, 12 * t2**2, 20 * t2**3, 0, 0, -2
    a[6, 10:], a[7, 11:], a[8, 12:] = (1, t3, t3**2, t3**3), (1, 2 * t3, 3 * t3**2), (2, 6 * t3)
    a[9, 0], a[10, 1], a[11, 2], a[12, 4], a[13, 10] = 1, 1, 2, 1, 1
    return a


def coefficients_353(waypoints: Floats, durations: Floats) -> Floats:
    """Solve for one joint; waypoints of shape (4,), durations of shape (3,), result of shape (14,)."""
    right = np.zeros(14)
    right[6], right[9], right[12], right[13] = waypoints[3], waypoints[0], waypoints[1], waypoints[2]
    return np.asarray(np.linalg.solve(system_353(durations), right), dtype=float)


def peaks_353(waypoints: Floats, durations: Floats) -> Floats:
    """Sampled peak velocity and acceleration of one candidate, shape (2, n_joints)."""
    result = np.zeros((2, waypoints.shape[1]))
    for j in range(waypoints.shape[1]):
        solved = coefficients_353(waypoints[:, j], durations)
        for (first, degree), t in zip(PIECES, durations, strict=True):
            times = np.linspace(0.0, t, SAMPLES)
            velocity = solved[first + 1 : first + degree + 1] * np.arange(1, degree + 1)
            acceleration = velocity[1:] * np.arange(1, degree)
            for order, rate in enumerate((velocity, acceleration)):
                result[order, j] = max(result[order, j], np.abs(np.polyval(rate[::-1], times)).max())
    return result


def peaks_spline(waypoints: Floats, durations: Floats) -> Floats:
    """Sampled peak velocity, acceleration and jerk of one candidate, shape (3, n_joints)."""
    knots = np.concatenate([[0.0], np.cumsum(durations)])
    times = np.concatenate([np.linspace(a, b, SAMPLES) for a, b in pairwise(knots)])
    result = np.empty((3, waypoints.shape[1]))
    for j in range(waypoints.shape[1]):
        spline = CubicSpline(knots, waypoints[:, j], bc_type="clamped")
        result[:, j] = [np.abs(spline(times, order)).max() for order in (1, 2, 3)]
    return result


def value_353(problem: Problem, durations: Floats) -> float:
    """Total time with a penalty where a sampled rate exceeds its limit: one candidate of the papers' search."""
    peaks = peaks_353(problem.waypoints, durations)
    excess = (peaks / problem.limits.rates[:2]).max() - 1.0
    worst = problem.n_segments * problem.duration_bounds[1]
    return float(durations.sum() + (worst * (1.0 + excess) if excess > 0 else 0.0))
