"""GSA, DE, STOA and SCA against transcriptions, closed forms and peer packages."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import optimize, stats

from study.planning import Meter
from study.search.de import DE, three_others
from study.search.gsa import GSA, GravityState, half_words
from study.search.loop import minimise
from study.search.population import new_population
from study.search.sca import SCA
from study.search.state import Box
from study.search.stoa import STOA
from tests.helpers.fixed import Fixed

BOX = Box(np.full(3, -10.0), np.full(3, 10.0))


def told(search, positions, values, generations=4):
    state = search.init(BOX, len(positions), generations, np.random.default_rng(0))
    first = new_population(BOX, np.asarray(positions, dtype=float), generations)
    if isinstance(state, GravityState):
        first = GravityState(**vars(first), velocities=np.full(np.shape(positions), 0.5))
    return first.replaced(np.asarray(values, dtype=float))


def bowl(x):
    return ((x - 1.0) ** 2).sum(axis=1)


def transcribed_gsa(state, rng):
    """Rashedi's equations, one mass and one coordinate at a time, fed with the same random numbers."""
    x, f = state.members, state.values
    n, d = x.shape
    keep = rng.random((n, d))
    m = [(f[i] - f.max()) / (f.min() - f.max()) for i in range(n)]
    masses = [value / sum(m) for value in m]
    share = 0.02 + (1 - 1 / 4) * 0.98
    heavy = sorted(range(n), key=lambda i: -masses[i])[: round(share * n)]
    draws = half_words(rng, (len(heavy), d, n)) / 2**32
    g = 100 * math.exp(-20 / 4)
    out = np.empty((n, d))
    for i in range(n):
        for k in range(d):
            pull = 0.0
            for place, j in enumerate(heavy):
                if j != i:
                    r = math.dist(x[i], x[j])
                    pull += draws[place, k, i] * g * masses[j] * (x[j][k] - x[i][k]) / (r + np.finfo(float).eps)
            out[i, k] = x[i][k] + keep[i, k] * state.velocities[i][k] + pull
    return np.clip(out, -10, 10)


def test_gsa_follows_a_transcription_of_its_equations():
    x = np.random.default_rng(2).uniform(-10, 10, (12, 3))
    state = told(GSA(), x, bowl(x))
    ours = GSA().ask(state, np.random.default_rng(9)).candidates
    np.testing.assert_allclose(ours, transcribed_gsa(state, np.random.default_rng(9)), rtol=1e-12)


def test_halves_are_uniform_whole_numbers_of_32_bits():
    drawn = half_words(np.random.default_rng(4), (301, 11, 9))
    assert drawn.shape == (301, 11, 9)
    assert drawn.dtype == np.uint32
    assert stats.kstest(drawn.ravel() / 2**32, "uniform").pvalue > 1e-3
    assert abs(np.corrcoef(drawn.ravel()[:-1:2], drawn.ravel()[1::2])[0, 1]) < 0.02


def test_gsa_keeps_still_where_all_masses_sit_together():
    state = told(GSA(), np.full((5, 3), 2.0), np.ones(5))
    np.testing.assert_allclose(GSA().ask(state, Fixed(0.5)).candidates, 2.0 + 0.5 * 0.5)


def test_three_others_are_distinct_and_uniform():
    n, rounds = 7, 4000
    rng = np.random.default_rng(0)
    picks = np.array([three_others(n, rng).T for _ in range(rounds)])
    for i in range(n):
        mine = picks[:, i]
        assert all(len({i, *row}) == 4 for row in mine.tolist())
        codes, counts = np.unique(mine @ [49, 7, 1], return_counts=True)
        assert len(codes) == 6 * 5 * 4
        assert stats.chisquare(counts).pvalue > 1e-4


def test_de_without_crossover_changes_exactly_one_coordinate():
    x = np.random.default_rng(2).uniform(-10, 10, (12, 3))
    moved = DE(crossover=0.0).ask(told(DE(), x, bowl(x)), np.random.default_rng(1)).candidates
    np.testing.assert_array_equal((moved != x).sum(axis=1), 1)
    full = DE(crossover=1.0, bounds="free").ask(told(DE(), x, bowl(x)), np.random.default_rng(1)).candidates
    a, b, c = x[three_others(12, np.random.default_rng(1))]
    np.testing.assert_allclose(full, a + 0.5 * (b - c))


def test_de_ends_where_scipys_rand1bin_ends():
    generations, size = 60, 30
    ours, theirs = [], []
    for seed in range(12):
        meter = Meter(bowl, size * (generations + 1))
        minimise(DE(), meter, BOX, size, np.random.default_rng(seed))
        ours.append(math.log10(meter.incumbent_value))
        rng = np.random.default_rng(seed)
        result = optimize.differential_evolution(
            lambda columns: bowl(columns.T),
            optimize.Bounds(BOX.lower, BOX.upper),
            strategy="rand1bin",
            maxiter=generations,
            init=BOX.at(rng.random((size, 3))),
            mutation=0.5,
            recombination=0.9,
            tol=0.0,
            polish=False,
            vectorized=True,
            updating="deferred",
            rng=rng,
        )
        theirs.append(math.log10(result.fun))
    assert stats.ttest_ind(ours, theirs).pvalue > 1e-3
    assert abs(np.mean(ours) - np.mean(theirs)) < 1.5


def test_stoa_step_by_hand():
    # half time: Sa = 1; r = 1/2: drift -1/2, turn 1, so 1.5 e (x - x_best / 3) + x_best
    state = told(STOA(), [[1.0, 2.0, -1.0], [0.0, 0.0, 0.0]], [1.0, 0.0], generations=2)
    np.testing.assert_allclose(STOA().ask(state, Fixed(0.5)).candidates[0], 1.5 * math.e * np.array([1.0, 2.0, -1.0]))


def test_sca_step_by_hand():
    # half time: r1 = 1; sin(pi/2) = 1, r3 = 1/2: x + |x_best / 2 - x|
    state = told(SCA(), [[1.0, 2.0, -1.0], [4.0, 4.0, 4.0]], [1.0, 0.0], generations=2)
    np.testing.assert_allclose(SCA().ask(state, Fixed(0.25)).candidates, [[2.0, 2.0, 2.0], [6.0, 6.0, 6.0]])
    # r4 = 3/4: cosine of 3 pi / 2 is 0, so nothing moves
    np.testing.assert_allclose(SCA().ask(state, Fixed(0.75)).candidates, state.members, atol=1e-14)


def test_one_sca_step_has_the_distribution_of_the_peer_package():
    """mealpy's OriginalSCA moves as the paper does; it then keeps the better and redraws what left the box."""
    mealpy = pytest.importorskip("mealpy", reason="the peer package mealpy is not installed")
    x = np.random.default_rng(3).uniform(-2, 2, (8, 3))
    x = x[np.argsort(bowl(x))]
    ours, theirs = [], []
    for seed in range(150):
        ours.append(SCA().ask(told(SCA(), x, bowl(x)), np.random.default_rng(seed)).candidates)
        theirs.append(_mealpy_first_move(mealpy, x, seed))
    first, second = np.array(ours), np.array(theirs)
    p = [stats.ks_2samp(first[:, i, j], second[:, i, j]).pvalue for i in range(8) for j in range(3)]
    assert min(p) > 1e-4
    assert np.mean(p) > 0.35


def _mealpy_first_move(mealpy, x, seed):
    seen = []

    def objective(solution):
        seen.append(np.array(solution))
        return float(((solution - 1.0) ** 2).sum())

    bounds = mealpy.FloatVar(lb=[-10.0] * 3, ub=[10.0] * 3)
    problem = {"bounds": bounds, "obj_func": objective, "minmax": "min", "log_to": None}
    model = mealpy.SCA.OriginalSCA(epoch=4, pop_size=len(x))
    model.solve(problem, mode="swarm", seed=seed, starting_solutions=list(x))
    calls = np.array(seen)
    start = next(k for k in range(len(calls)) if np.allclose(calls[k : k + len(x)], x))
    return calls[start + len(x) : start + 2 * len(x)]
