"""The package toppra as its users take it: gridpoints and a parametrizer, one pass, no check in between.

`toppra-natural` and `toppra-centripetal` keep constant path acceleration between gridpoints of our choice.
`toppra-default` is the first example of the package's own documentation: its own gridpoints and its default, a spline
in time.
"""

from __future__ import annotations

import importlib
import logging
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.interpolate import CubicSpline

from baselines.peers.base import Peer, needs
from study.io.passages import passages
from study.planning import Freedom
from study.problem import Floats, Problem
from study.splines import Ends, at_constant_acceleration, spline_of, stations_of
from study.trajectory import Trajectory

needs("toppra")

Answer = tuple[CubicSpline, Floats, Floats]


def path_speeds(problem: Problem, power: float, ends: Ends) -> Answer:
    """Spline, gridpoints and the path speed at each, by TOPP-RA."""
    spline = spline_of(problem, power, ends)
    points = stations_of(spline.x)
    instance = _instance(problem, spline, ends, gridpoints=points, parametrizer="ParametrizeConstAccel")
    _, speeds, _ = instance.compute_parameterization(0.0, 0.0)
    return spline, points, speeds


def _instance(problem: Problem, spline: CubicSpline, ends: Ends, **further: Any) -> Any:
    toppra, constraint = importlib.import_module("toppra"), importlib.import_module("toppra.constraint")
    algorithm: Any = importlib.import_module("toppra.algorithm")
    logging.getLogger("toppra").setLevel(logging.ERROR)
    path = toppra.SplineInterpolator(spline.x, problem.waypoints, bc_type=ends)
    velocity, acceleration = problem.limits.rates[:2]
    limits = [
        constraint.JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    return algorithm.TOPPRA(limits, path, **further)


@dataclass(frozen=True)
class ToppraPackage(Peer):
    """Planners `toppra-natural` and `toppra-centripetal`: TOPP-RA along a natural cubic spline.

    Parameters
    ----------
    power : float
        Power of the chords that the spline's parameter grows by.
    about : str
    """

    power: float
    about: str
    freedom: ClassVar[Freedom] = Freedom.PATH
    jerk: ClassVar[tuple[bool, ...]] = (False,)

    def solve(self, problem: Problem, time_limit: float) -> Answer:
        """Find the path speeds."""
        return path_speeds(problem, self.power, "natural")

    def motion(self, problem: Problem, answer: Answer) -> Trajectory:
        """Drive the spline with constant path acceleration between gridpoints."""
        return at_constant_acceleration(problem, answer)


class ToppraDefault(Peer):
    """Planner `toppra-default`: the package's own gridpoints and its default parametrizer, a cubic spline in time."""

    about = "the package toppra with its own gridpoints and its default, a spline in time"
    freedom: ClassVar[Freedom] = Freedom.PATH
    jerk: ClassVar[tuple[bool, ...]] = (False,)

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Compute the package's trajectory along a spline by the chords."""
        return _instance(problem, spline_of(problem, 1.0, "natural"), "natural").compute_trajectory(0.0, 0.0)

    def motion(self, problem: Problem, answer: Any) -> Trajectory:
        """Take the spline in time as it is; waypoints are passed where it comes closest."""
        knots, cubics = answer.cspl.x - answer.cspl.x[0], np.moveaxis(answer.cspl.c[::-1], 0, 1)
        return Trajectory(knots, cubics, passages(knots, cubics, problem.waypoints))


NATURAL = ToppraPackage(1.0, "the package toppra along a natural spline by the chords")
CENTRIPETAL = ToppraPackage(0.5, "the package toppra along a natural spline by the roots of the chords")
