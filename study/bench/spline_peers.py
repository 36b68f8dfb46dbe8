"""TOPP-RA and COPP along splines through the waypoints of real arms, and their answers as exact motions."""

from __future__ import annotations

import importlib
from itertools import pairwise
from typing import Any, Literal

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


def with_toppra(problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Floats]:
    """Ask TOPP-RA for path speeds at gridpoints."""
    toppra, constraint = importlib.import_module("toppra"), importlib.import_module("toppra.constraint")
    algorithm: Any = importlib.import_module("toppra.algorithm")
    spline = spline_of(problem, power, ends)
    path = toppra.SplineInterpolator(spline.x, problem.waypoints, bc_type=ends)
    velocity, acceleration = problem.limits.rates[:2]
    limits = [
        constraint.JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    points = stations_of(spline.x)
    instance = algorithm.TOPPRA(limits, path, gridpoints=points, parametrizer="ParametrizeConstAccel")
    _, speeds, _ = instance.compute_parameterization(0.0, 0.0)
    return spline, points, speeds


def with_copp(problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Floats]:
    """Ask COPP's TOPP2-RA for path speeds at stations."""
    copp: Any = importlib.import_module("copp_py")
    spline, points, robot = _robot(copp, problem, power, ends)
    return spline, points, np.sqrt(np.maximum(_second_order(copp, robot, len(points)), 0.0))


def with_copp_third(problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Floats]:
    """Ask COPP's TOPP3-SOCP, one round about TOPP2-RA's profile; times and (parameter, speed, acceleration)."""
    copp: Any = importlib.import_module("copp_py")
    spline, points, robot = _robot(copp, problem, power, ends)
    reference, jerk = _second_order(copp, robot, len(points)), problem.limits.jerk
    robot.add_jerk_limits(jerk, -jerk, start_idx_s=0, length=len(points))
    third = copp.solver.topp3_socp
    profile = third.solve(third.Problem(robot.constraints, reference))
    _, times = copp.interpolation.s_to_t_topp3(points, profile)
    return spline, np.asarray(times), np.stack([points, np.sqrt(np.maximum(profile.a, 0.0)), profile.b], axis=1)


def _robot(copp: Any, problem: Problem, power: float, ends: Ends) -> tuple[CubicSpline, Floats, Any]:
    spline = spline_of(problem, power, ends)
    points = stations_of(spline.x)
    robot = copp.Robot(problem.n_joints, capacity=len(points))
    robot.append_s(points)
    robot.set_q(spline(points), spline(points, 1), spline(points, 2), 0, dddq=spline(points, 3))
    for add, limit in zip(
        (robot.add_velocity_limits, robot.add_acceleration_limits), problem.limits.rates, strict=False
    ):
        add(limit, -limit, start_idx_s=0, length=len(points))
    return spline, points, robot


def _second_order(copp: Any, robot: Any, count: int) -> Floats:
    second = copp.solver.topp2_ra
    given = second.Problem(robot.constraints, idx_s_interval=(0, count - 1), a_boundary=(0.0, 0.0))
    return np.asarray(second.solve(given, second.Options()))


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
