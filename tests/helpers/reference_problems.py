"""Problems that the tests of the references share."""

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem

WOODWORKING = np.array(
    [[0.8, 0.578, 0.688, 0.459], [1.2, 0.868, 0.567, 0.964], [3.141, 1.897, 1.468, 2.355], [0, 1.047, 1.771, 0.754]]
).T
V, A = [0.6, 0.6, 1.8, 1.8], [0.8, 0.8, 2.4, 2.4]
INF = np.inf


def woodworking(velocity=V, acceleration=A, jerk=INF, **rest):
    return Problem("woodworking", WOODWORKING, JointLimits(velocity, acceleration, jerk), **rest)


EACH_LIMIT = {
    "velocity": ([1.0] * 3, INF, INF),
    "velocity binds": ([0.2] * 3, [9.0] * 3, INF),
    "acceleration binds": ([9.0] * 3, [0.4] * 3, INF),
    "jerk binds": ([9.0] * 3, [9.0] * 3, [2.0] * 3),
    "no velocity limit": ([INF] * 3, [2.0] * 3, INF),
    "jerk only": ([INF] * 3, INF, [2.0] * 3),
    "all": ([1.0, 0.5, 2.0], [2.0, 1.0, 1.5], [9.0, 5.0, 4.0]),
    "mixed": ([1.0, 0.5, 2.0], [2.0, INF, INF], [9.0, INF, 4.0]),
}
"""Velocity, acceleration and jerk limits of three joints in which each limit binds in turn."""


LIMITS_AND_ENDS = [
    pytest.param(
        limits,
        end,
        id=f"{name}-{end.name}",
        marks=[] if end is EndCondition.REST or name == "all" else pytest.mark.slow,
    )
    for name, limits in EACH_LIMIT.items()
    for end in EndCondition
]
"""Each of these between every pair of ends; by default each at rest, and all limits at once between every pair."""


def small(limits, end=EndCondition.REST, seed=0, n_waypoints=4):
    """Three joints through random waypoints."""
    points = np.random.default_rng(seed).uniform(-1, 1, (n_waypoints, 3))
    return Problem("small", points, JointLimits(*limits), end=end)
