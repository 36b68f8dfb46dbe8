"""Minimum times of one joint in closed form: rest to rest under up to three limits.

All functions broadcast over arrays. An infinite limit means no limit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from study.problem import Floats


def _arrays(*values: ArrayLike) -> list[Floats]:
    return [np.asarray(value, dtype=float) for value in values]


def two_limit_time(distance: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> Floats:
    """Rest to rest within velocity and acceleration limits, s: bang-bang, or a trapezoid at the velocity limit."""
    d, v, a = _arrays(np.abs(distance), velocity, acceleration)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        ramp = v / a
        return np.where(d < v * ramp, 2 * np.sqrt(d / a), d / v + np.where(np.isinf(a), 0.0, ramp))


def three_limit_time(distance: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike) -> Floats:
    """Rest to rest, also without acceleration, at both ends under velocity, acceleration and a finite jerk limit, s.

    Four phases of full jerk; two of full acceleration between them from a distance of 2 A^3 / J^2 on; one of full
    velocity in the middle where the distance is longer than the two ramps, which take V / a + a / J each,
    a = min(A, sqrt(V J)).
    """
    d, v, a, j = _arrays(np.abs(distance), velocity, acceleration, jerk)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        sharp = 4 * np.cbrt(d / (2 * j))
        fade = a / j
        top = (np.sqrt(np.square(a * fade) + 4 * a * d) - a * fade) / 2  # top^2 / A + top A / J = distance
        short = np.where(d < 2 * a * np.square(fade), sharp, 2 * (top / a + fade))
        peak = np.minimum(a, np.sqrt(v * j))
        ramp = v / peak + peak / j
        return np.where(np.isinf(v) | (d < v * ramp), short, d / v + ramp)


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


def peak_velocity(square: Floats, limit: Floats | float) -> Floats:
    """Positive w with w^2 - max(w - V, 0)^2 = square; 0 where the square is negative."""
    w = np.sqrt(np.maximum(square, 0.0))
    with np.errstate(invalid="ignore"):
        return np.where(w > limit, (square + limit**2) / (2 * limit), w)
