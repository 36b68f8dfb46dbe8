"""Problems without dimensions: times, and the positions of every joint, in units that suit a solver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from study.problem import Floats, JointLimits, Problem
from study.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Units:
    """Units of a dimensionless problem.

    Attributes
    ----------
    time : float, s
    length : array of shape (n_joints,), rad or m
    """

    time: float
    length: Floats

    def motion(self, motion: Trajectory) -> Trajectory:
        """Turn a motion of the dimensionless problem into one of the problem itself."""
        coefficients = motion.coefficients * self.length
        return Trajectory(motion.knots, coefficients, motion.waypoint_times).scaled(self.time)

    def into(self, motion: Trajectory) -> Trajectory:
        """Turn a motion of the problem into one of the dimensionless problem."""
        coefficients = motion.coefficients / self.length
        return Trajectory(motion.knots, coefficients, motion.waypoint_times).scaled(1 / self.time)


def dimensionless(problem: Problem, time: float, length: ArrayLike) -> tuple[Problem, Units]:
    """Divide times and positions by units; of the demands waypoints, limits, end condition and duration bounds stay.

    Parameters
    ----------
    problem : Problem
    time : float, s
    length : array of shape (n_joints,), rad or m
        Joints with the length 0 keep their own unit.
    """
    length = np.asarray(length, dtype=float)
    units = Units(float(time), np.where(length > 0, length, 1.0))
    rates = problem.limits.rates * units.time ** np.arange(1, 4)[:, None] / units.length
    lower, upper = problem.limits.lower / units.length, problem.limits.upper / units.length
    low, high = problem.duration_bounds
    scaled = Problem(
        problem.name,
        problem.waypoints / units.length,
        JointLimits(rates[0], rates[1], rates[2], lower, upper),
        problem.end,
        duration_bounds=(low / units.time, high / units.time),
        allow_dwell=True,
        joint_names=problem.joint_names,
    )
    return scaled, units


def largest_steps(problem: Problem) -> Floats:
    """Longest way of every joint between neighbouring waypoints, shape (n_joints,), rad or m."""
    return np.asarray(np.abs(np.diff(problem.waypoints, axis=0)).max(axis=0), dtype=float)
