"""The clamped cubic spline through all waypoints: zero velocity at both ends, continuous acceleration.

References
----------
UR5 sparrow-search paper, Eqs. (8)-(11), with M the accelerations at the waypoints.
"""

from __future__ import annotations

import numpy as np

from study.problem import Floats


def accelerations(waypoints: Floats, durations: Floats) -> Floats:
    """Accelerations at the waypoints, by one tridiagonal sweep over all candidates at once.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s

    Returns
    -------
    array of shape (n_candidates, n_waypoints, n_joints), rad/s^2 or m/s^2
    """
    n_candidates = len(durations)
    h = durations[:, :, None]
    slopes = np.diff(waypoints, axis=0) / h
    zero = np.zeros((n_candidates, 1, waypoints.shape[1]))
    right = 6 * np.diff(np.concatenate([zero, slopes, zero], axis=1), axis=1)
    none = np.zeros((n_candidates, 1, 1))
    diagonal = 2 * (np.concatenate([none, h], axis=1) + np.concatenate([h, none], axis=1))
    return swept(h, diagonal, right)


def swept(off: Floats, diagonal: Floats, right: Floats) -> Floats:
    """Solve symmetric tridiagonal systems of all candidates by elimination, with the candidates side by side in memory.

    Parameters
    ----------
    off : array of shape (n_candidates, n - 1, 1)
        Entries beside the diagonal.
    diagonal : array of shape (n_candidates, n, 1)
    right : array of shape (n_candidates, n, n_joints)

    Returns
    -------
    array of shape (n_candidates, n, n_joints)
    """
    beside, pivots, result = (np.moveaxis(part, 0, -1).astype(float, order="C") for part in (off, diagonal, right))
    factors = np.empty_like(beside)
    for i in range(len(beside)):
        np.divide(beside[i], pivots[i], out=factors[i])
        pivots[i + 1] -= factors[i] * beside[i]
        result[i + 1] -= factors[i] * result[i]
    result /= pivots
    for i in reversed(range(len(beside))):
        result[i] -= factors[i] * result[i + 1]
    return np.moveaxis(result, -1, 0).copy()


def unit_coefficients(waypoints: Floats, durations: Floats) -> Floats:
    """Coefficients in local unit time, shape (n_candidates, n_segments, n_joints, 4), ascending powers.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    durations : array of shape (n_candidates, n_segments), s
    """
    m = accelerations(waypoints, durations)
    square = durations[:, :, None] ** 2
    left, right = m[:, :-1] * square, m[:, 1:] * square
    steps = np.diff(waypoints, axis=0)[None]
    constant = np.broadcast_to(waypoints[:-1], left.shape)
    return np.stack([constant, steps - left / 3 - right / 6, left / 2, (right - left) / 6], axis=-1)


def peaks(waypoints: Floats, durations: Floats, orders: tuple[int, ...] = (1, 2, 3)) -> Floats:
    """Exact peak rates of every candidate.

    Acceleration is linear in each segment, so it peaks at waypoints; velocity peaks there or where acceleration is
    zero.

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
    m = accelerations(waypoints, durations)
    h = durations[:, :, None]
    left, right = m[:, :-1], m[:, 1:]
    result = np.empty((len(durations), len(orders), waypoints.shape[1]))
    for slot, order in enumerate(orders):
        if order == 1:
            start = np.diff(waypoints, axis=0) / h - h * (2 * left + right) / 6
            with np.errstate(divide="ignore", invalid="ignore"):
                turn = start + np.where(left * right < 0, h * left**2 / (2 * (left - right)), 0.0)
            result[:, slot] = np.maximum(np.abs(start), np.abs(turn)).max(axis=1)
        elif order == 2:
            result[:, slot] = np.abs(m).max(axis=1)
        else:
            result[:, slot] = np.abs((right - left) / h).max(axis=1)
    return result
