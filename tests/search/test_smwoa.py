"""WOA, SMA and SMWOA: steps by hand, reductions, the peer package, and the biases that the readings bring."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from study.planning import Meter
from study.search.loop import minimise
from study.search.population import new_population
from study.search.sma import SMA, Restart, arctanh_factor, fitness_weights, restarted
from study.search.smwoa import SMWOA
from study.search.state import Box
from study.search.woa import WOA
from tests.helpers.fixed import Fixed

WIDE = Box(np.full(2, -100.0), np.full(2, 100.0))


def told(positions, values, generations=2, box=WIDE):
    """A population after its first generation, so that t / t_max = 1 / generations."""
    return new_population(box, np.asarray(positions, dtype=float), generations).replaced(
        np.asarray(values, dtype=float)
    )


def best_of(search, objective, box, budget, seed, population=30):
    meter = Meter(objective, budget)
    minimise(search, meter, box, population, np.random.default_rng(seed))
    return meter.incumbent_value


def sphere(x):
    return (x**2).sum(axis=1)


def test_woa_steps_by_hand():
    # t / t_max = 1/2 and so a = 1; incumbent (4, 8), other member (10, 2)
    state = told([[4, 8], [10, 2]], [1, 2])
    encircling = WOA().ask(state, Fixed(0.25)).candidates  # A = -1/2, C = 1/2: X* + |X*/2 - X| / 2
    np.testing.assert_allclose(encircling, [[4 + 2 / 2, 8 + 4 / 2], [4 + 8 / 2, 8 + 2 / 2]])
    spiral = WOA().ask(state, Fixed(0.5)).candidates  # P = 1/2, l = 0: X* + |X* - X|
    np.testing.assert_allclose(spiral, [[4, 8], [10, 14]])
    early = told([[4, 8], [10, 2]], [1, 2], generations=10)  # a = 1.8, A = -1.44: explore around member 0, C = 0.2
    np.testing.assert_allclose(
        WOA().ask(early, Fixed(0.1)).candidates,
        np.array([4.0, 8.0]) + 1.44 * np.abs(0.2 * np.array([4.0, 8.0]) - [[4, 8], [10, 2]]),
    )


@pytest.mark.parametrize("coefficients", ["whale", "component"])
def test_smwoa_with_its_novelties_off_is_woa_candidate_by_candidate(coefficients):
    off = SMWOA(coefficients=coefficients, arctanh=False, weighted=False, oscillating=False)
    seen = []
    for search in (WOA(coefficients=coefficients), off):
        points = []
        best_of(search, lambda x, points=points: points.append(x) or sphere(x), WIDE, 900, 5)
        seen.append(np.concatenate(points))
    np.testing.assert_array_equal(*seen)


def test_each_novelty_of_smwoa_changes_the_search():
    outcomes = {
        best_of(SMWOA(**{key: value}), sphere, WIDE, 900, 5)
        for key, value in {
            "spiral": 1.0,
            "arctanh": False,
            "weighted": False,
            "oscillating": False,
            "restart_share": 0.1,
            "shrinking": True,
            "reading": "as-printed",
            "log_base": math.e,
        }.items()
    }
    assert len(outcomes) == 8


def test_readings_of_smwoa_differ_in_the_explored_leader():
    # a = arctanh(1 - 1/10) = 1.472, u = 0.1: A = -1.178, so both whales explore around member 1's position or the incumbent
    state = told([[10, 2], [4, 8]], [2, 1], generations=10)
    a = arctanh_factor(0.1) * (2 * 0.1 - 1)
    weights = fitness_weights(state.values, np.full((2, 2), 0.1), 10.0)
    x, first, best = state.members, state.members[0], state.incumbent
    standard = SMWOA().ask(state, Fixed(0.1)).candidates
    printed = SMWOA(reading="as-printed").ask(state, Fixed(0.1)).candidates
    np.testing.assert_allclose(standard, first - a * np.abs(weights * first - x))
    np.testing.assert_allclose(printed, first - a * np.abs(weights * best - x))


def test_arctanh_factor_is_finite_from_the_first_step_and_ends_at_zero():
    assert arctanh_factor(1 / 500) == pytest.approx(0.5 * math.log(999))  # arctanh(y) = ln((1 + y)/(1 - y)) / 2
    assert arctanh_factor(1.0) == 0.0


def test_weights_by_hand():
    values = np.array([4.0, 1.0, 3.0, 2.0])  # ranks: 1, 2, 3, 4 stand at 1, 3, 2, 0
    weights = fitness_weights(values, np.ones((4, 1)), 10.0)[:, 0]
    np.testing.assert_allclose(weights, [1 - math.log10(2), 1, 1 - math.log10(5 / 3), 1 + math.log10(4 / 3)])
    natural = fitness_weights(values, np.ones((4, 1)), math.e)[:, 0]
    np.testing.assert_allclose((natural - 1) * math.log10(math.e), weights - 1, atol=1e-15)


def test_restarts_land_where_each_reading_says():
    box, rng = Box(np.array([0.0, 10.0]), np.array([1.0, 30.0])), np.random.default_rng(0)
    stay = np.full((4000, 2), -5.0)
    for how in Restart:
        moved = restarted(stay, box, rng, 0.03, how)
        fractions = ((moved - box.lower) / box.width)[moved[:, 0] != -5.0]
        assert len(fractions) == pytest.approx(120, abs=40)
        on_diagonal = np.allclose(fractions[:, 0], fractions[:, 1])
        assert on_diagonal == (how != "component")
        assert (fractions.max() < 0.03) == (how == "same-number")


def test_sma_printed_feedback_never_changes_sign():
    state = told(np.full((50, 2), 7.0), np.zeros(50))  # p = tanh 0 = 0: everything shrinks
    printed = SMA(reading="as-printed", restart_share=0.0).ask(state, np.random.default_rng(0)).candidates
    np.testing.assert_allclose(printed, 3.5)
    standard = SMA(restart_share=0.0).ask(state, np.random.default_rng(0)).candidates
    assert standard.min() < 0 < standard.max()
    assert np.abs(standard).max() <= 3.5


@pytest.mark.parametrize("search", [SMA(), SMWOA(restart_share=0.03, shrinking=True)])
def test_a_shift_that_differs_per_coordinate_takes_the_origin_bias_away(search):
    box = Box(np.full(10, -100.0), np.full(10, 100.0))
    shift = np.linspace(5.0, 40.0, 10)
    centred = np.median([best_of(search, sphere, box, 6000, seed) for seed in range(3)])
    moved = np.median([best_of(search, lambda x: sphere(x - shift), box, 6000, seed) for seed in range(3)])
    assert centred < 1e-60
    assert moved > 1e-6


def test_one_sma_step_has_the_distribution_of_the_peer_package():
    """mealpy's OriginalSMA follows the equations; it draws A and B without the member itself and restarts per component."""
    mealpy = pytest.importorskip("mealpy", reason="the peer package mealpy is not installed")
    n, d, generations, repeats = 16, 3, 4, 150
    box = Box(np.full(d, -10.0), np.full(d, 10.0))
    x = np.random.default_rng(7).uniform(-10, 10, (n, d))
    x = x[np.argsort(sphere(x))]
    ours, theirs = [], []
    for seed in range(repeats):
        state = told(x, sphere(x) / 100, generations, box)
        ours.append(SMA(restart="component").ask(state, np.random.default_rng(seed)).candidates)
        theirs.append(_mealpy_first_move(mealpy, x, generations, seed))
    first, second = np.array(ours), np.array(theirs)
    p = [stats.ks_2samp(first[:, i, j], second[:, i, j]).pvalue for i in range(n) if i != n // 2 for j in range(d)]
    assert min(p) > 1e-4 / 2
    assert np.mean(p) > 0.35


def _mealpy_first_move(mealpy, x, generations, seed):
    seen = []

    def objective(solution):
        seen.append(np.array(solution))
        return float((solution**2).sum()) / 100

    problem = {
        "bounds": mealpy.FloatVar(lb=[-10.0] * x.shape[1], ub=[10.0] * x.shape[1]),
        "obj_func": objective,
        "minmax": "min",
        "log_to": None,
    }
    model = mealpy.SMA.OriginalSMA(epoch=generations, pop_size=len(x), p_t=0.03)
    model.solve(problem, mode="swarm", seed=seed, starting_solutions=list(x))
    calls = np.array(seen)
    start = next(k for k in range(len(calls)) if np.allclose(calls[k : k + len(x)], x))
    return calls[start + len(x) : start + 2 * len(x)]
