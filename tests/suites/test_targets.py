"""Costs to come near the best known, and profiles over evaluations: by hand, failures counted."""

import math
from dataclasses import replace

import numpy as np
import pytest

from study.suites.measures import Field
from study.suites.profiles import MOST_POINTS, step_profile
from study.suites.runs import Run
from study.suites.tables import cost_grid, cost_records
from study.suites.targets import (
    MANY_TARGETS,
    TARGETS,
    costs,
    costs_by_size,
    near_profiles,
    parts,
    runtime_distributions,
)

SEARCH = Run(
    "s:a", 4, 2, False, "pso", "case's curve", 1000, 0, "FINISHED", True, 1.0005, 1.0, 2.0, 0.0, "", 1000,
    (50, 200, 800), (0.1, 0.002, 0.0),
)  # fmt: skip
FAILED = replace(SEARCH, seed=1, feasible=False, duration=math.inf, curve_evaluations=(), curve_above=())
EXACT = replace(
    SEARCH, planner="nlp", evaluations=0, spent=0, duration=1.0, wall_time=0.5, curve_evaluations=(), curve_above=()
)
BEST = {("s:a", "case's curve"): 1.0, ("s:b", "case's curve"): 1.0}


@pytest.fixture
def field():
    return Field((SEARCH, FAILED, EXACT), BEST)


def test_a_run_reaches_each_target_where_its_curve_falls_below(field):
    reached = parts(field, SEARCH, TARGETS)
    np.testing.assert_allclose(reached, [0.2, 0.2, 0.8, np.inf])
    assert np.isinf(parts(field, FAILED, TARGETS)).all()
    assert parts(field, EXACT, TARGETS).tolist() == [1.0] * 4


def test_a_run_without_a_curve_reaches_all_at_its_end(field):
    old = replace(SEARCH, spent=0, curve_evaluations=(), curve_above=())
    assert parts(field, old, TARGETS).tolist() == [1.0, 1.0, 1.0, math.inf]


def test_marks_move_with_the_best_known(field):
    better = Field(field.runs, {("s:a", "case's curve"): 0.99})
    np.testing.assert_allclose(parts(better, SEARCH, TARGETS), [0.2, np.inf, np.inf, np.inf])


def test_expected_cost_counts_failed_runs_whole(field):
    exact, pso = costs(field)
    assert (pso.method, pso.runs) == ("pso, 1,000 evaluations", 2)
    np.testing.assert_allclose(pso.reached, [0.5, 0.5, 0.5, 0.0])
    np.testing.assert_allclose(pso.evaluations, [1200 / 4, 1200 / 4, 1800 / 4, np.inf])
    np.testing.assert_allclose(pso.seconds, [2.4, 2.4, 3.6, np.inf])
    np.testing.assert_allclose(exact.seconds, [0.5] * 4)
    np.testing.assert_allclose(exact.evaluations, [0.0] * 4)


def test_costs_by_size_are_whole_evaluations_of_each_size(field):
    larger = replace(SEARCH, problem="s:b", segments=8)
    small, large = costs_by_size(Field((*field.runs, larger), BEST), (SEARCH, FAILED, larger))
    assert (small.segments, small.evaluations[0]) == (4, pytest.approx(1200))
    assert (large.segments, large.evaluations[0]) == (8, pytest.approx(200))


def test_tables_and_files_tell_what_no_run_reached(field):
    rows = cost_grid(costs(field)).rows
    assert [row[0] for row in rows] == ["nlp", "pso, 1,000 evaluations"]
    assert list(rows[1])[1:] == ["50.0 %", "300 · 2.4 s", "300 · 2.4 s", "450 · 3.6 s", "never"]
    last = cost_records(costs(field))[-1]
    assert (last["target"], last["reached"], last["expected_seconds"]) == (0.0001, 0.0, None)


def test_profiles_over_evaluations_count_per_dimension(field):
    (near,) = near_profiles(field)
    assert (near.x.tolist(), near.share.tolist()) == ([200 / 5], [0.5])
    (ran,) = runtime_distributions(field)
    assert ran.x.tolist() == pytest.approx([50 / 4, 200 / 4, 800 / 4])
    hit = sum(1 + target >= 1.0005 for target in MANY_TARGETS)
    assert ran.share[-1] == pytest.approx(hit / (2 * len(MANY_TARGETS)))


def test_a_profile_of_many_costs_ends_at_the_same_share():
    costs_drawn = np.random.default_rng(1).lognormal(size=5000)
    costs_drawn[:1000] = np.inf
    line = step_profile("many", costs_drawn)
    assert len(line.x) == MOST_POINTS
    assert line.share[-1] == pytest.approx(0.8)
