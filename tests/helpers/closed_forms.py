"""Shortest times and largest displacements between two velocities, in closed form: oracles of the bounds and of Ruckig.

Notes
-----
Write w for the highest velocity of a move from velocity v0 to v1 in time T that accelerates by A as long as it can and
then brakes by A: w = (v0 + v1 + A T) / 2. Its displacement, the largest of any motion that keeps |v'| <= A and
v <= V, is

    upper(T) = (w^2 - max(w - V, 0)^2 - (v0^2 + v1^2) / 2) / A,

because its velocity is min(v0 + A t, v1 + A (T - t), V), which no admissible velocity exceeds at any t. Mirrored, the
smallest displacement is lower(T; v0, v1) = -upper(T; -v0, -v1). Any displacement between the two is reachable in time T
(the admissible velocities form a convex set), and none outside.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from baselines.closed_forms import peak_velocity
from study.problem import Floats


def _arrays(*values: ArrayLike) -> list[Floats]:
    return [np.asarray(value, dtype=float) for value in values]


def largest_displacement(
    time: ArrayLike, start: ArrayLike, end: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Floats:
    """Largest displacement of any motion between two velocities in a given time, rad or m; see the module's notes."""
    t, v0, v1, limit, a = _arrays(time, start, end, velocity, acceleration)
    w = (v0 + v1 + a * t) / 2
    over = np.maximum(w - limit, 0.0)
    return (w**2 - over**2 - (v0**2 + v1**2) / 2) / a


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
    d, v0, v1, limit, a = _arrays(distance, start, end, velocity, acceleration)
    flip = np.where(d < 0, -1.0, 1.0)
    d, v0, v1 = flip * d, flip * v0, flip * v1
    soonest = _time_at_peak(d, v0, v1, limit, a)
    return np.maximum(soonest, _end_of_gap(d, v0, v1, soonest, limit, a))


def _time_at_peak(d: Floats, v0: Floats, v1: Floats, limit: Floats, a: Floats) -> Floats:
    """Smallest T >= |v1 - v0| / A with upper(T) >= d, for d >= 0, s; upper then grows with T."""
    square = a * d + (v0**2 + v1**2) / 2
    w = np.maximum(peak_velocity(square, limit), np.maximum(v0, v1))
    return np.maximum((2 * w - v0 - v1) / a, 0.0)


def _end_of_gap(d: Floats, v0: Floats, v1: Floats, time: Floats, limit: Floats, a: Floats) -> Floats:
    """End of a gap of infeasible times, s: first later time at which the least displacement does not overshoot d."""
    square = (v0**2 + v1**2) / 2 - a * d
    lowest, w = peak_velocity(square, limit), (a * time - v0 - v1) / 2
    inside = (square > 0) & (np.abs(w) < lowest * (1 - 1e-12))
    return np.where(inside, (2 * lowest + v0 + v1) / a, 0.0)
