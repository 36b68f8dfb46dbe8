"""Shared by the tests: segment problems."""

from __future__ import annotations

import numpy as np

from study import EndCondition, JointLimits, Problem

WOOD = np.array(
    [[0.8, 0.578, 0.688, 0.459], [1.2, 0.868, 0.567, 0.964], [3.141, 1.897, 1.468, 2.355], [0, 1.047, 1.771, 0.754]]
).T


WOODWORKING = Problem(
    "woodworking", WOOD, JointLimits([0.6, 0.6, 1.8, 1.8], [0.8, 0.8, 2.4, 2.4]), duration_bounds=(1, 5)
)


BINDING = {"velocity": (1.0, 1e3, 1e5), "acceleration": (1e3, 1.0, 1e5), "jerk": (1e3, 1e3, 1.0)}


def random_problem(
    seed: int, n_waypoints: int, n_joints: int, rates: tuple[float, float, float] = (1.0, 2.0, 8.0)
) -> Problem:
    waypoints = np.random.default_rng(seed).normal(size=(n_waypoints, n_joints))
    limits = JointLimits(*(np.full(n_joints, rate) for rate in rates))
    return Problem("random", waypoints, limits, end=EndCondition.FREE, duration_bounds=(1e-3, 10.0))


def shape(curve: str) -> tuple[int, int]:
    return (4, 3) if curve == "poly353" else (6, 3)
