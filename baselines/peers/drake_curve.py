"""Curves of Drake as exact motions, and its solver."""

from __future__ import annotations

import importlib
import logging
from typing import Any

import numpy as np

from study import polynomial
from study.problem import Floats
from study.trajectory import Trajectory


def cut(curve: Any, marks: Floats, knots: Floats, degree: int) -> Trajectory:
    """A curve that is polynomial between knots, cut at the times of the waypoints as well."""
    cuts = np.unique(np.concatenate([knots, marks]))
    cuts = cuts[np.append(True, np.diff(cuts) > 1e-9 * knots[-1])]
    cuts[-1] = knots[-1]
    middles = (cuts[:-1] + cuts[1:]) / 2
    factorials = np.cumprod(np.append(1.0, np.arange(1, degree + 1)))
    taylor = np.array([[curve.EvalDerivative(t, k)[:, 0] / factorials[k] for k in range(degree + 1)] for t in middles])
    taylor = polynomial.shifted(np.moveaxis(taylor, 1, 2), (cuts[:-1] - middles)[:, None])
    segment = np.clip(np.searchsorted(marks, middles) - 1, 0, len(marks) - 2)
    return Trajectory.from_pieces(
        np.diff(cuts), np.moveaxis(taylor, 2, 1), np.bincount(segment, minlength=len(marks) - 1)
    )


def snopt(seconds: float) -> tuple[Any, Any]:
    """SNOPT and its options: the time limit; Drake is told to keep quiet."""
    logging.getLogger("drake").setLevel(logging.ERROR)
    solvers: Any = importlib.import_module("pydrake.solvers")
    solver, options = solvers.SnoptSolver(), solvers.SolverOptions()
    options.SetOption(solver.id(), "Time limit", float(seconds))
    options.SetOption(solver.id(), "Timing level", 3)
    return solver, options
