"""The cubic-quintic-cubic curve through four waypoints, with zero velocity and acceleration at both ends.

The fourteen conditions collapse: the first cubic is q0 + d1 (t/t1)^3 and the last q3 - d3 (1 - t/t3)^3, which fixes
velocity and acceleration at both inner waypoints; the middle is the quintic Hermite polynomial between them.

References
----------
Woodworking paper, Eqs. (4)-(18); AUBO paper, Eqs. (1)-(10); PUMA560 paper, Section 2.2.
"""

from __future__ import annotations

import numpy as np

from study import polynomial
from study.errors import StudyError
from study.problem import Floats


def unit_coefficients(waypoints: Floats, durations: Floats) -> Floats:
    """Coefficients in local unit time, for a whole population at once.

    Parameters
    ----------
    waypoints : array of shape (4, n_joints), rad or m
    durations : array of shape (n_candidates, 3), s

    Returns
    -------
    array of shape (n_candidates, 3, n_joints, 6), rad or m
        Ascending powers of the fraction of each segment's duration.

    Raises
    ------
    StudyError
        If there are not four waypoints.
    """
    if len(waypoints) != 4:
        raise StudyError(f"the 3-5-3 curve needs exactly 4 waypoints, got {len(waypoints)}; use cubic-spline instead")
    first, middle, last = np.diff(waypoints, axis=0)
    result = np.zeros((len(durations), 3, waypoints.shape[1], 6))
    result[:, 0, :, 0], result[:, 0, :, 3] = waypoints[0], first
    result[:, 2, :, :4] = np.stack([waypoints[2], 3 * last, -3 * last, last], axis=-1)
    t1, t2, t3 = durations.T[:, :, None]
    v1, a1 = 3 * first * (t2 / t1), 6 * first * (t2 / t1) ** 2
    v2, a2 = 3 * last * (t2 / t3), -6 * last * (t2 / t3) ** 2
    result[:, 1, :, 0] = waypoints[1]
    result[:, 1, :, 1] = v1
    result[:, 1, :, 2] = a1 / 2
    result[:, 1, :, 3] = 10 * middle - 6 * v1 - 4 * v2 - 1.5 * a1 + 0.5 * a2
    result[:, 1, :, 4] = -15 * middle + 8 * v1 + 7 * v2 + 1.5 * a1 - a2
    result[:, 1, :, 5] = 6 * middle - 3 * v1 - 3 * v2 - 0.5 * a1 + 0.5 * a2
    return result


def peaks(waypoints: Floats, durations: Floats) -> Floats:
    """Exact peak velocity, acceleration and jerk of every candidate.

    Parameters
    ----------
    waypoints : array of shape (4, n_joints), rad or m
    durations : array of shape (n_candidates, 3), s

    Returns
    -------
    array of shape (n_candidates, 3, n_joints)
        Orders 1, 2, 3 on the middle axis.
    """
    ends = np.abs(np.diff(waypoints, axis=0))[[0, 2]]
    middle = unit_coefficients(waypoints, durations)[:, 1]
    result = np.empty((len(durations), 3, waypoints.shape[1]))
    for order, factor in enumerate((3.0, 6.0, 6.0), start=1):
        middle = polynomial.derivative(middle)
        start, inner, stop = durations.T[:, :, None] ** order
        cubic = np.maximum(factor * ends[0] / start, factor * ends[1] / stop)
        result[:, order - 1] = np.maximum(cubic, polynomial.peak(middle) / inner)
    return result
