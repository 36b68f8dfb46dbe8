"""The parametric cubic uniform B-spline of the slime-mould paper: time t(u) and positions q(u) on the same knots.

Doubling the end control points, as the paper does, leaves the arm in motion at both ends with zero acceleration.

References
----------
UR5 slime-mould whale paper, Eqs. (16)-(22) for the curve, (25) and (27) for its rates.
"""

from __future__ import annotations

import numpy as np

from study import polynomial
from study.parametric import ParametricTrajectory, rational_candidates
from study.polynomial import Terms
from study.problem import Floats

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


def peaks(waypoints: Floats, durations: Floats, orders: tuple[int, ...] = (1, 2, 3)) -> Floats:
    """Exact peak rates of every candidate.

    A candidate whose t(u) does not increase strictly has no motion; its peaks are infinite.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s
    orders : tuple of int
        Which derivatives; leaving out those without a limit saves their work.

    Returns
    -------
    array of shape (n_candidates, len(orders), n_joints)
    """
    time, position = time_coefficients(durations), np.moveaxis(unit_coefficients(waypoints), 1, 2)
    rate: Terms = tuple(np.ascontiguousarray(time[:, :, k].T)[:, None] * k for k in (1, 2, 3))
    result = np.empty((len(durations), len(orders), waypoints.shape[1]))
    with np.errstate(all="ignore"):
        for slot, order in enumerate(orders):
            if order == 3:
                values = rational_candidates(time[:, :, None, :], position[None], order)[1]
                result[:, slot] = np.abs(values).max(axis=(1, 3))
            else:
                result[:, slot] = _peak(rate, position, order).max(axis=0).T
    slowest = np.minimum(rate[0], sum(rate))
    for turn in polynomial.roots_of_terms((rate[1], 2 * rate[2])):
        slowest = np.minimum(slowest, polynomial.value_of_terms(rate, turn))
    result[(slowest <= 0).any(axis=(0, 1))] = np.inf
    return result


def _peak(rate: Terms, position: Floats, order: int) -> Floats:
    """Peak velocity or acceleration on every piece, shape (n_segments, n_joints, n_candidates).

    With t' = e0 + e1 u + e2 u^2 and q' alike, N = q''t' - q't'' loses its cubic term; velocity turns where N = 0 and
    acceleration N / t'^3 where M = N't' - 3Nt'' = 0.
    """
    e0, e1, e2 = rate
    d0, d1, d2 = (position[:, :, k, None] * k for k in (1, 2, 3))
    n: Terms = (d1 * e0 - d0 * e1, 2 * (d2 * e0 - d0 * e2), d2 * e1 - d1 * e2)
    over: Terms = (d0, d1, d2)
    turns = n
    if order == 2:
        over = n
        turns = (
            n[1] * e0 - 3 * n[0] * e1,
            2 * (n[2] * e0 - n[1] * e1 - 3 * n[0] * e2),
            -n[2] * e1 - 5 * n[1] * e2,
            -4 * n[2] * e2,
        )
    power = 2 * order - 1
    result = np.maximum(np.abs(over[0] / e0**power), np.abs(sum(over) / sum(rate) ** power))
    for u in polynomial.roots_of_terms(turns):
        at = polynomial.value_of_terms(over, u) / polynomial.value_of_terms(rate, u) ** power
        result = np.maximum(result, np.abs(at))
    return result


def trajectory(waypoints: Floats, durations: Floats) -> ParametricTrajectory:
    """Build the motion of one vector of durations, shape (n_segments,), s."""
    return ParametricTrajectory(time_coefficients(durations[None])[0], unit_coefficients(waypoints))
