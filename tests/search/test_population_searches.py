"""Laws that every search without a paper of its own must keep: WOA, SMA, SMWOA, SSA, GSA, DE, STOA, SCA, CMA-ES."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from cmaes import CMA

from study.errors import StudyError
from study.planning import Meter
from study.search.cma_es import CMAES
from study.search.cma_sampling import QuickCMA
from study.search.de import DE
from study.search.gsa import GSA
from study.search.loop import minimise
from study.search.lshade import LSHADE
from study.search.population import new_population, normalised_fitness
from study.search.sca import SCA
from study.search.sma import SMA
from study.search.smwoa import SMWOA
from study.search.ssa import SSA
from study.search.state import Box
from study.search.stoa import STOA
from study.search.woa import WOA

BOX = Box(np.array([0.1, 0.2, 0.3, 0.4]), np.array([4.0, 5.0, 6.0, 7.0]))
TARGET = np.array([0.9, 3.1, 1.7, 4.4])
ADAPTIVE = {"adaptive_beta": True, "adaptive_k": True}
SEARCHES = {
    "woa": WOA(),
    "woa-vector": WOA(coefficients="component", leader="whale"),
    "sma": SMA(),
    "sma-component": SMA(restart="component"),
    "sma-as-printed": SMA(reading="as-printed"),
    "smwoa": SMWOA(),
    "smwoa-branches": SMWOA(restart_share=0.03, shrinking=True),
    "smwoa-as-printed": SMWOA(reading="as-printed"),
    "ssa": SSA(),
    "tadf-ssa": SSA(start="tent", **ADAPTIVE),
    "tadf-ssa-as-printed": SSA(reading="as-printed", start="tent", **ADAPTIVE),
    "gsa": GSA(),
    "de": DE(),
    "stoa": STOA(),
    "sca": SCA(),
    "cma-es": CMAES(),
    "l-shade": LSHADE(),
}


def bowl(points):
    return ((points - TARGET) ** 2).sum(axis=1)


def run(search, seed=0, budget=3000, objective=bowl):
    meter = Meter(objective, budget)
    minimise(search, meter, BOX, 30, np.random.default_rng(seed))
    return meter


@pytest.mark.parametrize("name", SEARCHES)
def test_stays_in_the_box_and_spends_exactly_its_budget(name):
    seen = []
    meter = run(SEARCHES[name], budget=1007, objective=lambda x: seen.append(x) or bowl(x))
    points = np.concatenate(seen)
    assert meter.evaluations == len(points) == 1007
    assert (points >= BOX.lower).all()
    assert (points <= BOX.upper).all()


@pytest.mark.parametrize("name", SEARCHES)
def test_same_seed_gives_the_same_bytes_and_another_seed_others(name):
    first, again, other = (run(SEARCHES[name], seed, 900) for seed in (3, 3, 4))
    assert first.history.tobytes() == again.history.tobytes()
    assert first.incumbent.tobytes() == again.incumbent.tobytes()
    assert first.history.tobytes() != other.history.tobytes()


@pytest.mark.parametrize("name", SEARCHES)
def test_beats_random_search_on_a_bowl_off_the_origin_and_off_the_diagonal(name):
    if name == "tadf-ssa-as-printed":
        pytest.skip("its steps have one sign, so it stalls; see test_ssa.py")
    ours = np.median([run(SEARCHES[name], seed).incumbent_value for seed in range(7)])
    points = BOX.at(np.random.default_rng(0).random((7, 3000, 4)))
    randoms = np.median([bowl(block).min() for block in points])
    assert ours < randoms


@pytest.mark.parametrize("name", [name for name in SEARCHES if name != "cma-es"])
def test_ask_and_tell_leave_their_state_as_it_was(name):
    search, rng = SEARCHES[name], np.random.default_rng(1)
    state = search.init(BOX, 12, 10, rng)
    for _ in range(4):
        before = {
            f.name: np.copy(v) for f in dataclasses.fields(state) if isinstance(v := getattr(state, f.name), np.ndarray)
        }
        told = search.tell(state, bowl(state.candidates), rng)
        asked = search.ask(told, rng)
        for key, value in before.items():
            np.testing.assert_array_equal(getattr(state, key), value)
        state = asked


@pytest.mark.parametrize("name", [name for name in SEARCHES if name != "cma-es"])
def test_infinite_values_are_survived_without_a_warning_or_a_nan(name):
    def half_infinite(points):
        return np.where(points[:, 0] > 2.0, np.inf, bowl(points))

    assert np.isfinite(run(SEARCHES[name], objective=half_infinite).incumbent_value)
    seen = []
    run(SEARCHES[name], budget=300, objective=lambda x: seen.append(x) or np.full(len(x), np.inf))
    assert np.isfinite(np.concatenate(seen)).all()


@pytest.mark.parametrize("population", [1, 2, 3])
@pytest.mark.parametrize("name", [name for name in SEARCHES if name not in ("cma-es", "de", "l-shade")])
def test_tiny_populations_work(name, population):
    meter = Meter(bowl, 40)
    minimise(SEARCHES[name], meter, BOX, population, np.random.default_rng(0))
    assert meter.evaluations == 40


def test_searches_that_need_a_population_say_so():
    for search in (DE(), CMAES(), LSHADE()):
        with pytest.raises(StudyError, match="population of at least 4"):
            minimise(search, Meter(bowl, 100), BOX, 3, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SMA(reading="original"), "no paper reading 'original'"),
        (lambda: SMA(restart="anywhere"), "no restart 'anywhere'"),
        (lambda: WOA(leader="wale"), "did you mean 'whale'"),
        (lambda: SSA(start="circle"), "no start 'circle'"),
        (lambda: SSA(scouts=1.5), "SSA: scouts must lie between 0 and 1, got 1.5"),
        (lambda: DE(crossover=-1), "DE: crossover must lie between 0 and 1"),
    ],
)
def test_wrong_options_are_refused(make, message):
    with pytest.raises(StudyError, match=message):
        make()


def test_badness_by_hand():
    np.testing.assert_array_equal(normalised_fitness(np.array([3.0, 1.0, np.inf, 2.0])), [1.0, 0.0, 1.0, 0.5])
    np.testing.assert_array_equal(normalised_fitness(np.array([2.0, 2.0])), [0.0, 0.0])
    np.testing.assert_array_equal(normalised_fitness(np.array([np.inf, np.inf])), [1.0, 1.0])


def test_kept_better_and_replaced():
    first = new_population(BOX, np.array([[1.0] * 4, [2.0] * 4]), 5).replaced(np.array([1.0, 2.0]))
    second = dataclasses.replace(first, candidates=np.array([[3.0] * 4, [4.0] * 4]))
    greedy, generational = second.kept_better(np.array([1.5, 0.5])), second.replaced(np.array([1.5, 0.5]))
    np.testing.assert_array_equal(greedy.members[:, 0], [1.0, 4.0])
    np.testing.assert_array_equal(greedy.values, [1.0, 0.5])
    np.testing.assert_array_equal(generational.members[:, 0], [3.0, 4.0])
    assert greedy.incumbent_value == generational.incumbent_value == 0.5
    assert greedy.generation == 2


def test_cma_es_leaves_its_states_unchanged():
    search, rng = CMAES(), np.random.default_rng(4)
    state = search.init(BOX, 8, 5, rng)
    told = search.tell(state, bowl(state.candidates), rng)
    again = search.tell(state, bowl(state.candidates), rng)
    first = search.ask(told, rng).candidates
    np.testing.assert_array_equal(first, search.ask(told, rng).candidates)
    np.testing.assert_array_equal(first, search.ask(again, rng).candidates)


@pytest.mark.parametrize("dimensions", [2, 9, 40])
def test_the_samples_of_cma_es_are_those_of_its_package_to_the_byte(dimensions):
    bounds = np.tile([0.0, 1.0], (dimensions, 1))
    weights, drawn = np.arange(1, dimensions + 1), []
    for kind in (CMA, QuickCMA):
        optimiser = kind(np.full(dimensions, 0.5), 0.3, bounds, seed=5, population_size=10)
        populations = []
        for _ in range(12):
            populations.append([optimiser.ask() for _ in range(10)])
            optimiser.tell([(point, float(((point - 0.3) ** 2 * weights).sum())) for point in populations[-1]])
        drawn.append(np.array(populations).tobytes())
    assert drawn[0] == drawn[1]
