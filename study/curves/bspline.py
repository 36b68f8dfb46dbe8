"""The parametric cubic uniform B-spline of the slime-mould paper: time t(u) and positions q(u) on the same knots.

Doubling the end control points, as the paper does, leaves the arm in motion at both ends with zero acceleration.

References
----------
UR5 slime-mould whale paper, Eqs. (16)-(22) for the curve, (25) and (27) for its rates.
"""

from __future__ import annotations

import numpy as np

from study import polynomial
from study.problem import Floats
from study.trajectory import ParametricTrajectory, rational_candidates

BASIS = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6  # Eq. (18), ascending powers of u


def control_points(values: Floats) -> Floats:
    """Control points whose curve passes through the given values: Eqs. (19) and (20).

    Parameters
    ----------
    values : array of shape (n_waypoints, ...), any unit

    Returns
    -------
    array of shape (n_waypoints + 2, ...)
    """
    n = len(values)
    system = (np.diag(np.full(n, 4.0)) + np.diag(np.ones(n - 1), 1) + np.diag(np.ones(n - 1), -1)) / 6
    system[0, 0] = system[-1, -1] = 5 / 6  # V0 = V1 and Vn = Vn+1, Eq. (20)
    inner = np.linalg.solve(system, values)
    return np.concatenate([inner[:1], inner, inner[-1:]])


def unit_coefficients(values: Floats) -> Floats:
    """Coefficients in u of every piece, shape (n_segments, 4, ...), ascending powers."""
    points = control_points(values)
    windows = np.stack([points[k : len(points) - 3 + k] for k in range(4)], axis=1)
    return np.einsum("pk...,ck->pc...", windows, BASIS)


def time_coefficients(durations: Floats) -> Floats:
    """Coefficients of t(u), shape (n_candidates, n_segments, 4), s; linear in the durations."""
    times = np.concatenate([np.zeros((len(durations), 1)), np.cumsum(durations, axis=1)], axis=1)
    return np.moveaxis(unit_coefficients(times.T), -1, 0)


def peaks(waypoints: Floats, durations: Floats) -> Floats:
    """Exact peak velocity, acceleration and jerk of every candidate, shape (n_candidates, 3, n_joints).

    A candidate whose t(u) does not increase strictly has no motion; its peaks are infinite.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s
    """
    time = time_coefficients(durations)[:, :, None, :]
    position = np.moveaxis(unit_coefficients(waypoints), 1, 2)[None]
    result = np.empty((len(durations), 3, waypoints.shape[1]))
    with np.errstate(all="ignore"):
        for order in (1, 2, 3):
            _, values = rational_candidates(time, position, order)
            result[:, order - 1] = np.abs(values).max(axis=(1, 3))
    slowest = polynomial.extrema(polynomial.derivative(time[:, :, 0]))[0].min(axis=1)
    result[slowest <= 0] = np.inf
    return result


def trajectory(waypoints: Floats, durations: Floats) -> ParametricTrajectory:
    """Build the motion of one vector of durations, shape (n_segments,), s."""
    return ParametricTrajectory(time_coefficients(durations[None])[0], unit_coefficients(waypoints))
