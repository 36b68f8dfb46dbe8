"""The cubic spline through all waypoints with zero velocity and zero acceleration at both ends.

Two more conditions than the clamped spline need two more unknowns: the first and the last segment are halved, and the
position at each halving is free (the virtual points of the field). With a the halved duration, the virtual position
follows from the acceleration m there, q0 + m a^2 / 6, and drops out of the other equations: the accelerations at the
inner waypoints solve a tridiagonal system of their own in which the outer segments count with slope (q1 - q0) / a.

References
----------
The sparrow-search paper's Eqs. (8)-(11) leave an acceleration step at both ends; this is the variant without it.
Virtual points: Gasparetto and Zanotto 2008, after Lin, Chang and Luh 1983.
"""

from __future__ import annotations

import numpy as np

from study.curves.cubic_spline import swept
from study.errors import StudyError
from study.problem import Floats


def accelerations(waypoints: Floats, durations: Floats) -> Floats:
    """Accelerations at the knots: start, virtual point, inner waypoints, virtual point, end.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s

    Returns
    -------
    array of shape (n_candidates, n_waypoints + 2, n_joints), rad/s^2 or m/s^2

    Raises
    ------
    StudyError
        If there are fewer than three waypoints.
    """
    if len(waypoints) < 3:
        raise StudyError(f"the smooth cubic spline needs at least 3 waypoints, got {len(waypoints)}; use ruckig-stops")
    h = halved(durations)[:, :, None]
    steps = np.diff(waypoints, axis=0)
    slopes = steps / h[:, 1:-1]
    right = 6 * np.diff(slopes, axis=1)
    diagonal = 2 * (h[:, 1:-2] + h[:, 2:-1])
    m = np.zeros((len(durations), right.shape[1] + 4, waypoints.shape[1]))
    m[:, 2:-2] = swept(h[:, 2:-2], diagonal, right)
    m[:, 1] = steps[0] / h[:, 0] ** 2 - m[:, 2] / 6
    m[:, -2] = -steps[-1] / h[:, -1] ** 2 - m[:, -3] / 6
    return m


def halved(durations: Floats) -> Floats:
    """Durations of the pieces, shape (n_candidates, n_segments + 2), s: the outer segments stand twice, halved."""
    pieces = np.concatenate([durations[:, :1], durations, durations[:, -1:]], axis=1, dtype=float)
    pieces[:, [0, 1, -2, -1]] /= 2
    return pieces


def unit_coefficients(waypoints: Floats, durations: Floats) -> Floats:
    """Coefficients in local unit time of every piece, shape (n_candidates, n_segments + 2, n_joints, 4).

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s
    """
    m = accelerations(waypoints, durations)
    square = halved(durations)[:, :, None] ** 2
    left, right = m[:, :-1] * square, m[:, 1:] * square
    points = np.empty_like(m)
    points[:, 0], points[:, 2:-2], points[:, -1] = waypoints[0], waypoints[1:-1], waypoints[-1]
    points[:, 1] = waypoints[0] + right[:, 0] / 6
    points[:, -2] = waypoints[-1] + left[:, -1] / 6
    slope = np.diff(points, axis=1) - left / 3 - right / 6
    return np.stack([points[:, :-1], slope, left / 2, (right - left) / 6], axis=-1)


def peaks(waypoints: Floats, durations: Floats, orders: tuple[int, ...] = (1, 2, 3)) -> Floats:
    """Exact peak rates of every candidate.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s
    orders : tuple of int
        Which derivatives.

    Returns
    -------
    array of shape (n_candidates, len(orders), n_joints)
    """
    unit = unit_coefficients(waypoints, durations)
    h = halved(durations)[:, :, None]
    result = np.empty((len(durations), len(orders), waypoints.shape[1]))
    _, start, half, sixth = np.moveaxis(unit, -1, 0)
    for slot, order in enumerate(orders):
        if order == 1:
            with np.errstate(divide="ignore", invalid="ignore"):
                at = np.fmax(np.fmin(-half / (3 * sixth), 1.0), 0.0)
            turn = start + (2 * half + 3 * sixth * at) * at
            value = np.maximum(np.abs(start), np.abs(turn)) / h
        elif order == 2:
            value = np.abs(2 * half) / h**2
        else:
            value = np.abs(6 * sixth) / h**3
        result[:, slot] = value.max(axis=1)
    return result
