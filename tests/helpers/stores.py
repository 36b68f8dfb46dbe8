"""Shared by the tests: stores."""

import sqlite3
from contextlib import closing

import numpy as np

from study.problem import EndCondition, JointLimits, Problem
from study.runs.execute import CellJob

TINY = Problem(
    "tiny",
    np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]]),
    JointLimits(np.array([1.0, 0.8]), np.array([2.0, 1.5])),
    EndCondition.SMOOTH,
    (0.1, 4.0),
)


def with_jobs(results, problem=TINY):
    """Results with their jobs, as the store takes them."""
    return [(CellJob(result.cell, problem), result) for result in results]


def change(path, *statements):
    """Change a results file behind the store's back."""
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        for statement in statements:
            connection.execute(statement)
