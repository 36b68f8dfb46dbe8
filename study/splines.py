"""Cubic splines through waypoints as paths, gridpoints on them, and exact motions along them from speeds at gridpoints."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline

from study import polynomial
from study.problem import Floats, Problem
from study.trajectory import Trajectory

STATIONS, FEWEST, MOST = 400, 4, 100
"""Gridpoints of a whole path, and the least and the most for each segment."""


Ends = Literal["natural", "clamped"]


def spline_of(problem: Problem, power: float, ends: Ends) -> CubicSpline:
    """Lay a cubic spline; its parameter grows by a power of the distance in units of the velocity limits."""
    chords = np.linalg.norm(np.diff(problem.waypoints, axis=0) / problem.limits.velocity, axis=1) ** power
    return CubicSpline(np.append(0.0, np.cumsum(chords)), problem.waypoints, bc_type=ends)


def stations_of(knots: Floats) -> Floats:
    """Gridpoints with every knot among them."""
    count = int(np.clip(STATIONS // (len(knots) - 1), FEWEST, MOST))
    inner = [np.linspace(a, b, count, endpoint=False) for a, b in pairwise(knots)]
    return np.append(np.concatenate(inner), knots[-1])


def at_constant_acceleration(problem: Problem, answer: tuple[CubicSpline, Floats, Floats]) -> Trajectory:
    """Drive a spline with constant path acceleration between gridpoints: exact, degree 6."""
    spline, points, speeds = answer
    steps = np.diff(points)
    times = 2 * steps / (speeds[:-1] + speeds[1:])
    along = np.stack([np.zeros_like(steps), speeds[:-1], np.diff(speeds) / times / 2], axis=1)
    return _driven(spline, points, times, along)


def by_quintics(problem: Problem, answer: tuple[CubicSpline, Floats, Floats]) -> Trajectory:
    """Drive a spline through path states at stations, quintic in time between them: exact, degree 15."""
    spline, times, states = answer
    h = np.diff(times)
    (s0, v0, a0), (s1, v1, a1) = states[:-1].T, states[1:].T
    quintic = polynomial.hermite_quintic(s1 - s0, v0 * h, v1 * h, a0 * h**2, a1 * h**2)
    along = np.stack([np.zeros_like(h), *quintic], axis=1) / h[:, None] ** np.arange(6)
    return _driven(spline, states[:, 0], h, along)


def _driven(spline: CubicSpline, points: Floats, times: Floats, along: Floats) -> Trajectory:
    about = np.stack([spline(points[:-1], k) / (1, 1, 2, 6)[k] for k in range(4)], axis=2)
    segment = np.searchsorted(spline.x, (points[:-1] + points[1:]) / 2) - 1
    about[:, :, 3] = spline.c[0, segment]
    driven = np.moveaxis(polynomial.composed(about, along[:, None]), 1, 2)
    return Trajectory.from_pieces(times, driven, np.bincount(segment, minlength=len(spline.x) - 1))
