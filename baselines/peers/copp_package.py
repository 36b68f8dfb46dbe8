"""COPP's open core as its users take it, along splines in several parametrizations; the extra `copp`.

`copp-topp2-*` find path speeds under limits of velocity and acceleration, `copp-topp3-*` go on from there with limits
of jerk, by one round of the cone program about TOPP2-RA's profile. Limits hold at stations, and jerk in linearised
form.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.interpolate import CubicSpline

from baselines.peers.base import Peer, needs
from study.planning import Freedom
from study.problem import Floats, Problem
from study.splines import Ends, at_constant_acceleration, by_quintics, spline_of, stations_of
from study.trajectory import Trajectory

needs("copp_py")

COST = 3e-4
"""Processor time of the cone program for each station and joint, s; told beforehand, since nothing stops it."""

Answer = tuple[CubicSpline, Floats, Floats]


def path_speeds(problem: Problem, power: float, ends: Ends) -> Answer:
    """Spline, stations and the path speed at each, by TOPP2-RA."""
    copp: Any = importlib.import_module("copp_py")
    spline, points, robot = _robot(copp, problem, power, ends)
    return spline, points, np.sqrt(np.maximum(_second_order(copp, robot, len(points)), 0.0))


def path_states(problem: Problem, power: float, ends: Ends) -> Answer:
    """Spline, times at stations, and path parameter, speed and acceleration there, by TOPP3-SOCP."""
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


@dataclass(frozen=True)
class Second(Peer):
    """Planners `copp-topp2-*`: velocity and acceleration.

    Parameters
    ----------
    about : str
    power : float
        Power of the chords that the spline's parameter grows by.
    ends : str
        Whether the spline is natural or clamped.
    """

    about: str
    power: float
    ends: Ends = "natural"
    freedom: ClassVar[Freedom] = Freedom.PATH
    jerk: ClassVar[tuple[bool, ...]] = (False,)

    def solve(self, problem: Problem, time_limit: float) -> Answer:
        """Find path speeds."""
        return path_speeds(problem, self.power, self.ends)

    def motion(self, problem: Problem, answer: Answer) -> Trajectory:
        """Drive the spline with constant path acceleration between stations."""
        return at_constant_acceleration(problem, answer)


@dataclass(frozen=True)
class Third(Second):
    """Planners `copp-topp3-*`: jerk, too."""

    jerk: ClassVar[tuple[bool, ...]] = (True,)

    def declines(self, problem: Problem, time_limit: float) -> str:
        """Decline, too, what the cone program cannot do in the time."""
        stations = len(stations_of(np.arange(problem.n_waypoints, dtype=float)))
        needed = COST * stations * problem.n_joints
        late = f"COPP cannot be stopped and needs about {needed:.2g} s here, more than the time limit"
        return super().declines(problem, time_limit) or (late if needed > time_limit else "")

    def solve(self, problem: Problem, time_limit: float) -> Answer:
        """Find path states."""
        return path_states(problem, self.power, self.ends)

    def motion(self, problem: Problem, answer: Answer) -> Trajectory:
        """Drive the spline through the stations, by quintics in time between them."""
        return by_quintics(problem, answer)


SECOND, THIRD = "COPP's TOPP2-RA", "COPP's TOPP3-SOCP"
CHORDS, ROOTS = "along a natural spline by the chords", "along a natural spline by the roots of the chords"
TOPP2_NATURAL, TOPP2_CENTRIPETAL = Second(f"{SECOND} {CHORDS}", 1.0), Second(f"{SECOND} {ROOTS}", 0.5)
TOPP3_NATURAL, TOPP3_CENTRIPETAL = Third(f"{THIRD} {CHORDS}", 1.0), Third(f"{THIRD} {ROOTS}", 0.5)
TOPP3_CLAMPED = Third(f"{THIRD} along a clamped spline by the chords", 1.0, "clamped")
