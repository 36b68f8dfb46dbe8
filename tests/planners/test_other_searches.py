"""Planners around other people's optimisers, and the planners of the tables, through the planner's contract."""

from __future__ import annotations

import sys
from functools import cache

import numpy as np
import pytest
from scipy import optimize

from study.curves import curve_named
from study.errors import StudyError
from study.formulation import Scaled
from study.judge import judge
from study.planners import other_searches, smwoa, sparrow
from study.planning import Meter, RunSettings, Status
from study.problem import EndCondition, JointLimits, Problem
from study.search.state import Box

PROBLEM = Problem(
    "three joints",
    np.array([[0.0, 0.2, 0.0], [0.7, -0.3, 0.1], [0.9, 0.4, 0.6], [0.1, 0.8, 0.2], [0.5, 0.5, -0.4]]),
    JointLimits(np.full(3, 1.7), np.full(3, 0.8), np.full(3, 1.1)),
    EndCondition.REST,
    duration_bounds=(0.1, 6.0),
)
PLANNERS = {
    f"{module.__name__.rpartition('.')[2]}.{name}": planner
    for module in (other_searches, smwoa, sparrow)
    for name, planner in vars(module).items()
    if hasattr(planner, "plan") and not isinstance(planner, type)
}
SETTINGS = RunSettings("cubic-spline", evaluations=600, population=20, formulation="scaled")


@cache
def optimum_total():
    """Total of the shared problem by Nelder-Mead on the scaled objective from many starts: another kind of search."""
    objective = Scaled(PROBLEM, curve_named("cubic-spline"))
    starts = np.exp(np.random.default_rng(0).uniform(-1, 1, (12, 4)))
    runs = [
        optimize.minimize(
            lambda y: objective(np.exp(y)[None])[0],
            np.log(start),
            method="Nelder-Mead",
            options={"maxiter": 4000, "xatol": 1e-9, "fatol": 1e-12},
        )
        for start in starts
    ]
    return min(run.fun for run in runs)


@pytest.mark.parametrize("name", PLANNERS)
@pytest.mark.parametrize("synchronisation", ["shared", "per-joint"])
def test_every_planner_keeps_the_contract(name, synchronisation):
    planner = PLANNERS[name]
    settings = RunSettings(
        "cubic-spline", seed=3, evaluations=150, population=20, formulation="scaled", synchronisation=synchronisation
    )
    waypoints = PROBLEM.waypoints.copy()
    plan, again = planner.plan(PROBLEM, settings), planner.plan(PROBLEM, settings)
    parts = 1 if synchronisation == "shared" else 3
    assert plan.status is Status.FINISHED
    assert 0 < plan.evaluations <= 150 * parts
    assert plan.durations.tobytes() == again.durations.tobytes()
    assert (np.diff(plan.history[:, 0]) >= 0).all()
    assert plan.history[-1, 0] == plan.evaluations
    np.testing.assert_array_equal(PROBLEM.waypoints, waypoints)
    verdict = judge(PROBLEM, plan.motion)
    assert verdict.duration == pytest.approx(plan.durations.sum())
    if synchronisation == "shared":
        assert verdict.feasible, verdict.reasons
        assert plan.history[-1, 1] == pytest.approx(verdict.duration)
        assert (np.diff(plan.history[:, 1]) <= 0).all()


@pytest.mark.parametrize("planner", [other_searches.DIRECT, other_searches.CENTRE])
def test_planners_that_call_themselves_deterministic_are(planner):
    assert not planner.stochastic
    totals = {
        float(planner.plan(PROBLEM, RunSettings("cubic-spline", seed=seed, evaluations=120)).durations.sum())
        for seed in range(3)
    }
    assert len(totals) == 1


@pytest.mark.parametrize("name", [pytest.param("LBFGSB_PLANNER", marks=pytest.mark.slow), "SCIPY_DE", "CMA_ES"])
def test_strong_searches_reach_the_reference(name):
    planner = getattr(other_searches, name)
    settings = RunSettings("cubic-spline", evaluations=6000, population=30, formulation="scaled")
    total = planner.plan(PROBLEM, settings).durations.sum()
    reference = optimum_total()
    assert total >= reference * (1 - 1e-6)
    assert total <= reference * 1.01


def test_the_centre_is_equal_durations_stretched():
    plan = other_searches.CENTRE.plan(PROBLEM, SETTINGS)
    assert plan.evaluations == 1
    np.testing.assert_allclose(plan.durations, plan.durations[0])
    assert judge(PROBLEM, plan.motion).worst_ratio == pytest.approx(1.0)


def test_a_planner_that_needs_its_own_formulation_takes_it_and_says_so():
    penalty = RunSettings("cubic-spline", evaluations=100, formulation="penalty")
    plan = other_searches.LBFGSB_PLANNER.plan(PROBLEM, penalty)
    assert judge(PROBLEM, plan.motion).feasible
    assert plan.message == "always takes the scaled formulation"
    assert other_searches.LBFGSB_PLANNER.plan(PROBLEM, SETTINGS).message == ""


def test_finite_differences_are_counted():
    calls = []
    meter = Meter(lambda x: calls.append(len(x)) or ((np.log(x) - 0.3) ** 2).sum(axis=1), 100)
    box = Box(np.full(4, 0.1), np.full(4, 10.0))
    other_searches.LBFGSB().minimise(meter, box, 20, np.random.default_rng(0))
    assert calls == [5] * 20
    assert meter.incumbent == pytest.approx(np.full(4, np.exp(0.3)), abs=1e-4)


def test_a_box_that_begins_at_zero_has_logarithms():
    meter = Meter(lambda x: np.abs(x - 0.5).sum(axis=1), 300)
    other_searches.LBFGSB().minimise(meter, Box(np.zeros(2), np.ones(2)), 20, np.random.default_rng(0))
    assert meter.incumbent_value < 0.01


def test_infinite_values_do_not_stop_the_descent():
    def partly(x):
        return np.where(x[:, 0] > 2 * x[:, 1], np.inf, np.abs(x - [1.0, 2.0]).sum(axis=1))

    meter = Meter(partly, 900)
    other_searches.LBFGSB().minimise(meter, Box(np.full(2, 0.1), np.full(2, 10.0)), 20, np.random.default_rng(0))
    assert meter.incumbent_value < 1e-3
    meter = Meter(lambda x: np.full(len(x), np.inf), 90)
    other_searches.LBFGSB().minimise(meter, Box(np.full(2, 0.1), np.full(2, 10.0)), 20, np.random.default_rng(0))
    assert meter.evaluations == 90
    assert meter.incumbent is None


def test_runs_of_different_length_still_make_one_history():
    problem = Problem(
        "one joint at rest",
        np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.0]]),
        JointLimits(np.ones(2), np.ones(2), np.ones(2)),
        duration_bounds=(0.1, 5.0),
    )
    settings = RunSettings("cubic-spline", evaluations=200, synchronisation="per-joint", formulation="scaled")
    plan = other_searches.SCIPY_DE.plan(problem, settings)
    assert plan.history[-1, 0] == plan.evaluations == 400


def test_a_missing_peer_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "cmaes", None)
    monkeypatch.delitem(sys.modules, "study.search.cma_sampling", raising=False)
    with pytest.raises(StudyError, match="needs the Python package 'cmaes'; install it with pip"):
        other_searches.CMA_ES.plan(PROBLEM, SETTINGS)


def test_cma_es_says_what_it_cannot_search():
    short = Problem("one segment", np.array([[0.0], [1.0]]), JointLimits(np.ones(1)))
    with pytest.raises(StudyError, match="at least 2 dimensions, got 20 and 1"):
        other_searches.CMA_ES.plan(short, SETTINGS)
