"""Shared by the tests: stores."""

import numpy as np

from study.problem import EndCondition, JointLimits, Problem

TINY = Problem(
    "tiny",
    np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]]),
    JointLimits(np.array([1.0, 0.8]), np.array([2.0, 1.5])),
    EndCondition.SMOOTH,
    (0.1, 4.0),
)
