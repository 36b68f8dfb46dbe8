"""Time limits: planners ask the clock on their way, and decline what they could not stop; a false clock tells."""

import numpy as np
import pytest

from baselines.free_path.nlp import FreePathNlp
from study import JointLimits, Problem
from study.planning import RunSettings, Status, Synchronisation, usual_settings
from study.registry import planner_named
from study.runs.execute import CellJob
from study.store.results import Cell
from study.testing.stress import reference_planners

POINTS = np.cumsum(np.random.default_rng(4).uniform(-0.5, 0.5, (5, 2)), axis=0)
LIMITS = JointLimits([1.5] * 2, [5.0] * 2, [50.0] * 2)
WITHOUT_CLOCK = {"centre", "lbfgsb-once", "ruckig-stops"}
"""Closed forms, and searches that end with their evaluations."""

LATER = 10
"""Times that a planner may ask the clock after it was told that it is late."""


class Clock:
    """Goes on by some seconds with every look at it."""

    def __init__(self, pace):
        self.pace, self.looks = pace, 0

    def monotonic(self):
        self.looks += 1
        return self.pace * self.looks


@pytest.mark.parametrize("name", sorted(set(reference_planners()) - WITHOUT_CLOCK))
def test_planners_ask_the_clock_and_stop(name, monkeypatch):
    clock = Clock(0.3)
    monkeypatch.setattr("study.deadline.time", clock)
    limits = LIMITS if name != "certified" else JointLimits(LIMITS.velocity, LIMITS.acceleration)
    problem = Problem("walk", POINTS, limits)
    settings = RunSettings(usual_settings(problem).curve, time_limit=1.0)
    result = CellJob(Cell("walk", name, name, settings), problem).run()
    assert clock.looks > 0
    assert clock.looks <= 1 / clock.pace + LATER
    assert result.status is Status.TIMED_OUT or clock.pace * clock.looks < 1 + clock.pace


@pytest.mark.parametrize("synchronisation", Synchronisation)
def test_direct_keeps_its_best_where_the_clock_ends_it(synchronisation, monkeypatch):
    problem = Problem("walk", POINTS, JointLimits(LIMITS.velocity, LIMITS.acceleration))
    settings = RunSettings("cubic-spline", evaluations=200, synchronisation=synchronisation)
    done = planner_named("direct").plan(problem, settings)
    monkeypatch.setattr("study.deadline.time", Clock(6.0))
    cut = planner_named("direct").plan(problem, settings)
    assert (done.status, cut.status) == (Status.FINISHED, Status.TIMED_OUT)
    assert cut.evaluations < 20
    assert cut.motion.duration >= done.motion.duration


@pytest.mark.parametrize("name", ["free-path-nlp", "topp3-nlp", "ruckig-via", "bspline-nlp", "casadi-nlp", "copp"])
def test_a_preparation_longer_than_the_time_limit_is_declined(name):
    if name not in reference_planners():
        pytest.skip("a package is missing")
    problem = Problem("long", np.cumsum(np.ones((2000, 2)), axis=0), LIMITS)
    plan = planner_named(name).plan(problem, RunSettings("cubic-spline", time_limit=0.1))
    assert plan.status is Status.NOT_APPLICABLE
    assert "more than the time limit" in plan.message


@pytest.mark.parametrize("name", ["bspline-nlp", "casadi-nlp"])
def test_no_time_to_solve_is_said(name, monkeypatch):
    if name not in reference_planners():
        pytest.skip("a package is missing")
    monkeypatch.setattr("study.deadline.time", Clock(1e3))
    problem = Problem("walk", POINTS, LIMITS)
    settings = RunSettings(usual_settings(problem).curve, time_limit=1.0)
    result = CellJob(Cell("walk", name, name, settings), problem).run()
    assert result.status is Status.TIMED_OUT
    assert result.message.endswith("a time limit inside the planner was reached")
    assert result.motion is None or result.feasible


def test_the_preparation_grows_with_segments_and_joints():
    assert FreePathNlp.set_up * (len(POINTS) - 1) * 2 < 0.1
