"""Deterministic planners on the papers' cases, and TOPP-RA next to what it does by default."""

from __future__ import annotations

import importlib
import logging
from functools import partial
from typing import Any

import numpy as np

from study.bench.measuring import Measurement, interleaved
from study.cases.library import load_case
from study.errors import StudyError
from study.planning import Plan, RunSettings, Status
from study.problem import Problem
from study.registry import planner_named
from study.runs.selections import TIMED

TOPIC = "Deterministic planners"
QUICK_CASES = ("woodworking", "ur5-helix")
CASES = ("woodworking", "aubo-i5", "puma560", "ur5-bspline", "ur5-helix")


def reference_rows(repetitions: int, quick: bool) -> list[Measurement]:
    """Measure one plan of every planner on every case; TOPP-RA's row has a peer."""
    return [row for name in (QUICK_CASES if quick else CASES) for row in _case_rows(name, repetitions)]


def _case_rows(name: str, repetitions: int) -> list[Measurement]:
    case = load_case(name)
    rows = []
    logging.getLogger("toppra").setLevel(logging.WARNING)
    for planner in TIMED:
        label = f"{planner} on {name}"
        try:
            plan = partial(planner_named(planner).plan, case.problem, RunSettings(curve=case.settings.curve))
            rows.append(_row(label, planner, plan, case.problem, repetitions))
        except StudyError as error:
            rows.append(Measurement(TOPIC, label, "", "plan", missing=str(error)))
    return rows


def _row(label: str, planner: str, plan: partial[Plan], problem: Problem, repetitions: int) -> Measurement:
    result = plan()
    if result.status is not Status.FINISHED:
        return Measurement(TOPIC, label, "", "plan", missing=result.message or result.status.value)
    calls: dict[str, partial[Any]] = {"ours": plan}
    if planner == "toppra":
        calls["default"] = partial(toppra_by_default, problem)
    taken = interleaved(calls, repetitions, dict.fromkeys(calls, 1))
    peer = "TOPP-RA's own default, whose motion may break limits" if planner == "toppra" else ""
    return Measurement(TOPIC, label, peer, "plan", taken["ours"], taken.get("default", ()))


def toppra_by_default(problem: Problem) -> Any:
    """Retime the package's own spline with its own grid and parametrizer."""
    toppra: Any = importlib.import_module("toppra")
    constraint: Any = importlib.import_module("toppra.constraint")
    algorithm: Any = importlib.import_module("toppra.algorithm")
    waypoints = problem.waypoints
    path = toppra.SplineInterpolator(np.linspace(0, 1, len(waypoints)), waypoints)
    velocity, acceleration = (np.where(np.isfinite(rate), rate, 1e9) for rate in problem.limits.rates[:2])
    limits = [
        constraint.JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    return algorithm.TOPPRA(limits, path).compute_trajectory()
