"""The sparrow search: roles by hand, switches, readings."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest

from study.planning import Meter
from study.search.chaos import MAPS, chaotic_population
from study.search.loop import minimise
from study.search.population import new_population
from study.search.ssa import SSA
from study.search.state import Box
from tests.helpers.fixed import Fixed

BOX = Box(np.full(3, -50.0), np.full(3, 50.0))
TARGET = np.array([3.0, -7.0, 11.0])
NO_SCOUTS = SSA(scouts=0.0)


def bowl(x):
    return ((x - TARGET) ** 2).sum(axis=1)


def told(positions, values, generations=4):
    x = np.asarray(positions, dtype=float)
    box = Box(np.full(x.shape[1], -50.0), np.full(x.shape[1], 50.0))
    return new_population(box, x, generations).replaced(np.asarray(values, dtype=float))


def candidates_of(search, seed=1, budget=600):
    seen = []
    meter = Meter(lambda x: seen.append(x) or bowl(x), budget)
    minimise(search, meter, BOX, 20, np.random.default_rng(seed))
    return np.concatenate(seen)


def test_producers_contract_by_rank_when_there_is_no_alarm():
    search = SSA(scouts=0.0, producers=1.0)
    state = told([[8.0, 4.0], [2.0, 6.0]], [2.0, 1.0])  # the second is ranked first; alpha = 1 - u = 0.75
    moved = search.ask(state, Fixed(0.25)).candidates
    np.testing.assert_allclose(moved[1], np.array([2.0, 6.0]) * math.exp(-1 / (0.75 * 4)))
    np.testing.assert_allclose(moved[0], np.array([8.0, 4.0]) * math.exp(-2 / (0.75 * 4)))


def test_producers_jump_along_the_diagonal_on_alarm():
    state = told([[8.0, 4.0], [2.0, 6.0]], [2.0, 1.0])
    moved = SSA(scouts=0.0, producers=1.0).ask(state, Fixed(0.5, z=1.5)).candidates
    np.testing.assert_allclose(moved, state.members + 1.5)


def test_joiners_by_hand():
    # ranks 1..4; one producer; rank 2 joins, ranks 3 and 4 leave; all signs of A are -1, Q = 1, R2 = ST: alarm
    state = told([[1.0, 2.0], [4.0, 8.0], [5.0, 1.0], [9.0, 9.0]], [1, 2, 3, 4])
    moved = SSA(scouts=0.0, producers=0.25).ask(state, Fixed(0.5)).candidates
    leader = np.array([2.0, 3.0])
    np.testing.assert_allclose(moved[0], leader)
    np.testing.assert_allclose(moved[1], leader - (2 + 5) / 2)
    np.testing.assert_allclose(moved[2], np.exp(np.array([9.0 - 5.0, 9.0 - 1.0]) / 9))
    np.testing.assert_allclose(moved[3], [1.0, 1.0])
    printed = SSA(reading="as-printed", scouts=0.0, producers=0.25).ask(state, Fixed(0.5)).candidates
    np.testing.assert_allclose(printed[2], np.exp(-np.array([9.0 - 5.0, 9.0 - 1.0]) / 9))


def test_scouts_by_hand():
    state = told([[1.0, 2.0], [4.0, 8.0]], [1, 3], generations=2)
    moved = SSA(scouts=1.0).ask(state, Fixed(0.75, z=2.0)).candidates  # beta = 2, K = 1/2
    np.testing.assert_allclose(moved[1], np.array([1.0, 2.0]) + 2 * np.array([3.0, 6.0]))
    np.testing.assert_allclose(moved[0], np.array([1.0, 2.0]) + 0.5 * np.array([3.0, 6.0]) / (1 - 3))
    adaptive = SSA(reading="as-printed", scouts=1.0, adaptive_beta=True, adaptive_k=True).ask(state, Fixed(0.75))
    beta, k = 0.5 * (1 - math.cos(0.5)), 0.5 * math.e  # eqs. (18), (19) at half time with limits 0 and 1
    np.testing.assert_allclose(adaptive.candidates[1], np.array([1.0, 2.0]) + beta * np.array([3.0, 6.0]))
    np.testing.assert_allclose(adaptive.candidates[0], np.array([1.0, 2.0]) + k * np.array([-3.0, -6.0]) / (1 - 3))


def test_joiners_step_is_the_same_number_in_every_dimension():
    rng = np.random.default_rng(0)
    x = rng.uniform(-20, 20, (20, 3))
    state = told(x, np.arange(20.0))
    candidates = NO_SCOUTS.ask(state, np.random.default_rng(2)).candidates
    joiners = candidates[4:10] - candidates[0]
    np.testing.assert_allclose(joiners - joiners[:, :1], 0.0, atol=1e-12)


def test_constant_beta_is_the_plain_search_candidate_by_candidate():
    constant = SSA(adaptive_beta=True, beta_limits=(1.0, 1.0))
    np.testing.assert_array_equal(candidates_of(SSA()), candidates_of(constant))
    assert (candidates_of(SSA()) != candidates_of(SSA(adaptive_beta=True))).any()


def test_the_tent_changes_nothing_but_the_start():
    first = SSA(start="tent").init(BOX, 20, 30, np.random.default_rng(5))
    direct = chaotic_population(MAPS["perturbed-tent"], BOX, 20, np.random.default_rng(5), along="dimensions")
    np.testing.assert_array_equal(first.candidates, direct)
    state = told(first.candidates, bowl(first.candidates))
    plain, tent = (search.ask(state, np.random.default_rng(6)).candidates for search in (SSA(), SSA(start="tent")))
    np.testing.assert_array_equal(plain, tent)


def test_all_eight_combinations_of_switches_differ():
    switches = [
        dict(zip(("start", "adaptive_beta", "adaptive_k"), pick, strict=True))
        for pick in itertools.product(("uniform", "tent"), (False, True), (False, True))
    ]
    outcomes = {candidates_of(SSA(scouts=0.5, **switch)).tobytes() for switch in switches}
    assert len(outcomes) == 8


def test_members_never_get_worse():
    search, rng = SSA(), np.random.default_rng(0)
    state = search.init(BOX, 20, 30, rng)
    for _ in range(30):
        told_state = search.tell(state, bowl(state.candidates), rng)
        assert (told_state.values <= state.values).all()
        np.testing.assert_array_equal(told_state.values, bowl(told_state.members))
        state = search.ask(told_state, rng)


def test_printed_factors_move_scouts_to_one_side_only():
    search = SSA(reading="as-printed", scouts=1.0, adaptive_beta=True, adaptive_k=True)
    state = told(np.random.default_rng(0).uniform(-20, 20, (20, 3)), np.arange(20.0))
    assert (search.ask(state, np.random.default_rng(1)).candidates[1:] >= state.incumbent).all()
    both = dataclasses.replace(search, reading="standard").ask(state, np.random.default_rng(1)).candidates[1:]
    assert (both < state.incumbent).any()


def test_printed_tadf_ssa_stalls_off_the_diagonal_and_the_standard_one_does_not():
    best = {}
    for reading in ("as-printed", "standard"):
        search = SSA(reading=reading, start="tent", adaptive_beta=True, adaptive_k=True)
        values = []
        for seed in range(5):
            meter = Meter(bowl, 4000)
            minimise(search, meter, BOX, 50, np.random.default_rng(seed))
            values.append(meter.incumbent_value)
        best[reading] = np.median(values)
    assert best["standard"] < best["as-printed"] / 10


def test_worst_members_at_infinity_do_not_poison_the_rest():
    state = told([[1.0, 2.0], [4.0, 8.0], [5.0, 1.0]], [1, 2, math.inf])
    with np.errstate(all="raise"):
        moved = SSA(scouts=1.0).ask(state, np.random.default_rng(0)).candidates
    assert np.isfinite(moved).all()


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_extreme_shares_are_allowed(share):
    assert len(candidates_of(SSA(producers=share, scouts=share))) == 600
