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


def check_waypoints(waypoints: Floats) -> None:
    """Refuse anything but four waypoints.

    Raises
    ------
    StudyError
        If there are not four waypoints.
    """
    if len(waypoints) != 4:
        raise StudyError(f"the 3-5-3 curve needs exactly 4 waypoints, got {len(waypoints)}; use cubic-spline instead")


def hermite(waypoints: Floats, durations: Floats) -> tuple[Floats, ...]:
    """Coefficients c1 to c5 of the middle quintic in unit time, each of shape (n_joints, n_candidates).

    Parameters
    ----------
    waypoints : array of shape (4, n_joints), rad or m
    durations : array of shape (n_candidates, 3), s

    Raises
    ------
    StudyError
        If there are not four waypoints.
    """
    check_waypoints(waypoints)
    first, middle, last = np.diff(waypoints, axis=0)[:, :, None]
    t1, t2, t3 = np.ascontiguousarray(durations.T)
    before, after = t2 / t1, t2 / t3
    v1, v2 = first * (3 * before), last * (3 * after)
    a1, a2 = v1 * (2 * before), v2 * (-2 * after)
    return polynomial.hermite_quintic(middle, v1, v2, a1, a2)


def unit_coefficients(waypoints: Floats, durations: Floats) -> Floats:
    """Coefficients in local unit time, shape (n_candidates, 3, n_joints, 6), ascending powers.

    Parameters
    ----------
    waypoints : array of shape (4, n_joints), rad or m
    durations : array of shape (n_candidates, 3), s

    Raises
    ------
    StudyError
        If there are not four waypoints.
    """
    quintic = hermite(waypoints, durations)
    result = np.zeros((len(durations), 3, waypoints.shape[1], 6))
    first, _, last = np.diff(waypoints, axis=0)
    result[:, 0, :, 0], result[:, 0, :, 3] = waypoints[0], first
    result[:, 1, :, 0] = waypoints[1]
    for power, coefficient in enumerate(quintic, start=1):
        result[:, 1, :, power] = coefficient.T
    result[:, 2, :, :4] = np.stack([waypoints[2], 3 * last, -3 * last, last], axis=-1)
    return result


def peaks(waypoints: Floats, durations: Floats, orders: tuple[int, ...] = (1, 2, 3)) -> Floats:
    """Exact peak rates of every candidate: velocity where acceleration is zero, acceleration where jerk is.

    Parameters
    ----------
    waypoints : array of shape (4, n_joints), rad or m
    durations : array of shape (n_candidates, 3), s
    orders : tuple of int
        Which derivatives; leaving out those without a limit saves their work.

    Returns
    -------
    array of shape (n_candidates, len(orders), n_joints)
    """
    c1, c2, c3, c4, c5 = hermite(waypoints, durations)
    velocity = (c1, 2 * c2, 3 * c3, 4 * c4, 5 * c5)
    acceleration = (velocity[1], 6 * c3, 12 * c4, 20 * c5)
    jerk = (acceleration[1], 24 * c4, 60 * c5)
    middle = {1: velocity, 2: acceleration, 3: jerk, 4: (24 * c4, 120 * c5)}
    ends = np.abs(np.diff(waypoints, axis=0))[[0, 2], :, None]
    result = np.empty((len(durations), len(orders), waypoints.shape[1]))
    for slot, order in enumerate(orders):
        factor = 3.0 if order == 1 else 6.0
        start, inner, stop = np.ascontiguousarray(durations.T) ** order
        cubic = np.maximum(ends[0] * (factor / start), ends[1] * (factor / stop))
        quintic = polynomial.peak_of_terms(middle[order], middle[order + 1])
        result[:, slot] = np.maximum(cubic, quintic / inner).T
    return result
