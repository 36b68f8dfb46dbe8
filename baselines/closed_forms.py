"""Minimum times of one joint in closed form: rest to rest under up to three limits, and between two velocities under two.

All functions broadcast over arrays. An infinite limit means no limit.

Notes
-----
Write w for the highest velocity of a move from velocity v0 to v1 in time T that accelerates by A as long as it can and
then brakes by A: w = (v0 + v1 + A T) / 2. Its displacement, the largest of any motion that keeps |v'| <= A and v <= V, is

    upper(T) = (w^2 - max(w - V, 0)^2 - (v0^2 + v1^2) / 2) / A,

because its velocity is min(v0 + A t, v1 + A (T - t), V), which no admissible velocity exceeds at any t. Mirrored, the
smallest displacement is lower(T; v0, v1) = -upper(T; -v0, -v1). Any displacement between the two is reachable in time T
(the admissible velocities form a convex set), and none outside.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study.problem import Floats


def two_limit_time(distance: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> Floats:
    """Rest to rest under velocity and acceleration limits, s: bang-bang, or a trapezoid where the velocity limit binds."""
    d, v, a = np.abs(distance), np.asarray(velocity, dtype=float), np.asarray(acceleration, dtype=float)
    with np.errstate(invalid="ignore", divide="ignore"):
        ramp = np.where(np.isinf(a), 0.0, v / a)
        return np.where(d <= v * ramp, 2 * np.sqrt(d / a), d / v + ramp)


def three_limit_time(distance: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike) -> Floats:
    """Rest to rest, also without acceleration, at both ends under velocity, acceleration and jerk limits, s.

    Up to seven phases of constant jerk, symmetric about the middle. With j the time at full jerk, k the time at full
    acceleration and c the time at full velocity it lasts 4 j + 2 k + c; the three limits on j, then on k, are taken in turn.
    """
    d = np.abs(np.asarray(distance, dtype=float))
    v, a, jerk = (np.asarray(x, dtype=float) for x in (velocity, acceleration, jerk))
    with np.errstate(invalid="ignore", divide="ignore"):
        by_jerk = np.minimum(np.minimum(np.cbrt(d / (2 * jerk)), np.sqrt(v / jerk)), a / jerk)
        full_jerk = np.where(np.isinf(jerk), 0.0, by_jerk)
        # distance = a (j + k) (2 j + k) with a = jerk j, and velocity = a (j + k)
        peak = np.where(np.isinf(jerk), a, jerk * full_jerk)
        by_distance = (np.sqrt(full_jerk**2 + 4 * d / peak) - 3 * full_jerk) / 2
        flat = np.maximum(np.minimum(by_distance, v / peak - full_jerk), 0.0)
        limited = (peak < a * (1 - 1e-15)) & np.isfinite(jerk)
        flat = np.where(limited | (peak == 0), 0.0, flat)
        top = np.where(np.isinf(peak), v, peak * (full_jerk + flat))
        cruise = np.where(top > 0, d / top - (2 * full_jerk + flat), 0.0)
    return 4 * full_jerk + 2 * flat + np.maximum(cruise, 0.0)


def rest_to_rest_time(distance: ArrayLike, rates: Floats) -> Floats:
    """Rest to rest under whatever limits there are, s.

    Parameters
    ----------
    distance : array of shape (..., n_joints), rad or m
    rates : array of shape (3, n_joints)
        Velocity, acceleration and jerk limits.
    """
    return np.where(
        np.isinf(rates[2]), two_limit_time(distance, rates[0], rates[1]), three_limit_time(distance, *rates)
    )


def largest_displacement(
    time: ArrayLike, start: ArrayLike, end: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Floats:
    """Largest displacement of any motion between two velocities in a given time, rad or m; see the module's notes."""
    v0, v1 = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    w = (v0 + v1 + np.asarray(acceleration) * time) / 2
    over = np.maximum(w - velocity, 0.0)
    return (w**2 - over**2 - (v0**2 + v1**2) / 2) / acceleration


def shortest_time(
    distance: ArrayLike, start: ArrayLike, end: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Floats:
    """Shortest time between two velocities over a signed distance under velocity and acceleration limits, s.

    Parameters
    ----------
    distance : array, rad or m
    start, end : arrays, rad/s or m/s
        Velocities at both ends, within the limit.
    velocity, acceleration : arrays
        Finite acceleration limit; the velocity limit may be infinite.
    """
    d = np.asarray(distance, dtype=float)
    flip = np.where(d < 0, -1.0, 1.0)
    v0, v1 = flip * np.asarray(start, dtype=float), flip * np.asarray(end, dtype=float)
    soonest = _time_at_peak(np.abs(d), v0, v1, velocity, acceleration)
    return np.maximum(soonest, _end_of_gap(np.abs(d), v0, v1, soonest, velocity, acceleration))


def _time_at_peak(d: Floats, v0: Floats, v1: Floats, velocity: ArrayLike, acceleration: ArrayLike) -> Floats:
    """Smallest T >= |v1 - v0| / A with upper(T) >= d, for d >= 0, s; upper then grows with T."""
    wanted = np.asarray(acceleration) * d + (v0**2 + v1**2) / 2
    w = np.maximum(np.sqrt(np.maximum(wanted, 0.0)), np.maximum(v0, v1))
    with np.errstate(invalid="ignore"):
        flat = (wanted + np.square(velocity)) / (2 * np.asarray(velocity))  # from upper = d with w > V
        w = np.where(w > velocity, flat, w)
    return np.maximum((2 * w - v0 - v1) / acceleration, 0.0)


def _end_of_gap(
    d: Floats, v0: Floats, v1: Floats, time: Floats, velocity: ArrayLike, acceleration: ArrayLike
) -> Floats:
    """Where even the smallest displacement at a time overshoots d: the first later time at which it no longer does, s."""
    over = (v0**2 + v1**2) / 2 - np.asarray(acceleration) * d
    deepest = np.sqrt(np.maximum(over, 0.0))
    w = (np.asarray(acceleration) * time - v0 - v1) / 2
    with np.errstate(invalid="ignore"):
        root = np.where(deepest > velocity, (over + np.square(velocity)) / (2 * np.asarray(velocity)), deepest)
    inside: NDArray[np.bool_] = (over > 0) & (np.abs(w) < root * (1 - 1e-12))
    return np.where(inside, (2 * root + v0 + v1) / acceleration, 0.0)
