"""The loop, the meter it obeys and the rules for candidates that leave the box."""

import numpy as np
import pytest

from study import StudyError
from study.planning import Meter
from study.search.bounds import BoundsRule, bounded, bounded_positions
from study.search.loop import minimise
from study.search.pso import PSO
from study.search.random_search import RandomSearch
from study.search.state import Box

BOX = Box(np.array([0.0, 1.0]), np.array([2.0, 5.0]))


def sphere(x):
    return (x**2).sum(axis=1)


class Listening:
    """An objective that remembers what it was asked."""

    def __init__(self):
        self.batches = []

    def __call__(self, x):
        self.batches.append(x.copy())
        return sphere(x)


@pytest.mark.parametrize("budget", [1, 7, 20, 47, 60])
@pytest.mark.parametrize("search", [PSO(), RandomSearch()])
def test_the_budget_is_kept_exactly(search, budget):
    objective = Listening()
    meter = Meter(objective, budget)
    state = minimise(search, meter, BOX, 20, np.random.default_rng(0))
    seen = np.concatenate(objective.batches)
    assert len(seen) == meter.evaluations == budget
    assert meter.incumbent_value == sphere(seen).min()
    assert state.generation == state.generations == -(-budget // min(20, budget))
    assert state.progress == 1.0
    assert (state.incumbent == meter.incumbent).all()
    assert state.incumbent_value == meter.incumbent_value


def test_history_falls_and_counts_every_call():
    meter = Meter(sphere, 95)
    minimise(PSO(), meter, BOX, 10, np.random.default_rng(0))
    counts, values = meter.history.T
    assert counts.tolist() == [*range(10, 100, 10), 95]
    assert (np.diff(values) <= 0).all()
    assert sphere(meter.incumbents) == pytest.approx(values)


def test_values_that_are_not_numbers_never_win():
    meter = Meter(lambda x: np.where(x[:, 0] < 1.5, np.nan, sphere(x)), 300)
    state = minimise(PSO(), meter, BOX, 20, np.random.default_rng(0))
    assert meter.incumbent[0] >= 1.5
    assert np.isfinite(state.own_values).any()
    lost = Meter(lambda x: np.full(len(x), np.nan), 50)
    assert minimise(PSO(), lost, BOX, 20, np.random.default_rng(0)).incumbent_value == np.inf
    assert lost.incumbent is None


def test_box_maps_fractions():
    assert BOX.at(np.array([[0.0, 1.0], [0.5, 0.5]])).tolist() == [[0.0, 5.0], [1.0, 3.0]]
    assert BOX.width.tolist() == [2.0, 4.0]


OUTSIDE = np.array([[-0.5, 3.0], [2.5, 5.5], [1.0, 2.0]])
VELOCITIES = np.array([[-1.0, 1.0], [2.0, 3.0], [0.1, 0.2]])
EXPECTED = {
    "clip": ([[0.0, 3.0], [2.0, 5.0], [1.0, 2.0]], VELOCITIES.tolist()),
    "stop": ([[0.0, 3.0], [2.0, 5.0], [1.0, 2.0]], [[0.0, 1.0], [0.0, 0.0], [0.1, 0.2]]),
    "reflect": ([[0.5, 3.0], [1.5, 4.5], [1.0, 2.0]], [[1.0, 1.0], [-2.0, -3.0], [0.1, 0.2]]),
    "free": (OUTSIDE.tolist(), VELOCITIES.tolist()),
}


@pytest.mark.parametrize("rule", BoundsRule)
def test_bounds_rules(rule):
    positions, velocities = bounded(rule, BOX, OUTSIDE, VELOCITIES)
    assert (positions.tolist(), velocities.tolist()) == EXPECTED[rule]


@pytest.mark.parametrize("rule", [rule for rule in BoundsRule if rule != "free"])
def test_rules_bring_any_candidate_home_and_leave_those_inside_alone(rule):
    rng = np.random.default_rng(0)
    far = rng.normal(size=(500, 2)) * 50
    inside = BOX.at(rng.random((500, 2)))
    home = bounded_positions(rule, BOX, far)
    assert (home >= BOX.lower).all()
    assert (home <= BOX.upper).all()
    assert bounded_positions(rule, BOX, inside) == pytest.approx(inside, abs=1e-12)


def test_unknown_rule_says_what_would_do():
    with pytest.raises(StudyError, match="no bounds rule 'clop'; did you mean 'clip'"):
        bounded_positions("clop", BOX, OUTSIDE)
