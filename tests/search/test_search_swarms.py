"""What every swarm and golden-sine search must do, whatever its equations."""

from dataclasses import fields, replace

import numpy as np
import pytest

from study import StudyError
from study.planners import aubo, puma, woodworking
from study.planners.other_searches import PSO_STANDARD, RANDOM_SEARCH
from study.planners.segment_times import SegmentTimePlanner
from study.planning import Meter
from study.search.cfpso import CFPSO
from study.search.chaotic_spso import ChaoticSPSO
from study.search.dynamic_adaptive_pso import DynamicAdaptivePSO
from study.search.gold_sa import GoldSA
from study.search.golds_pso import GoldSPSO
from study.search.loop import minimise
from study.search.pso import VelocityUpdate
from study.search.state import Box

PLANNERS = {
    name: planner
    for module in (woodworking, aubo, puma)
    for name, planner in vars(module).items()
    if isinstance(planner, SegmentTimePlanner)
} | {"PSO_STANDARD": PSO_STANDARD, "RANDOM_SEARCH": RANDOM_SEARCH}
SEARCHES = {name: planner.search for name, planner in PLANNERS.items()}
READ = [GoldSA, GoldSPSO, DynamicAdaptivePSO, ChaoticSPSO]


def locked(array):
    array.setflags(write=False)
    return array


BOX = Box(locked(np.full(5, -4.0)), locked(np.array([4.0, 5.0, 6.0, 7.0, 8.0])))


def shifted_sphere(x):
    return ((x - 1.5) ** 2).sum(axis=1)


def searched(search, seed=0, budget=1500):
    meter = Meter(shifted_sphere, budget)
    return meter, minimise(search, meter, BOX, 30, np.random.default_rng(seed))


@pytest.mark.parametrize("name", SEARCHES)
def test_it_improves_on_its_initial_population_within_its_budget(name):
    for seed in range(5):
        meter, state = searched(SEARCHES[name], seed)
        assert meter.evaluations == 1500
        assert meter.incumbent_value < meter.history[0, 1]
        assert state.incumbent_value == meter.incumbent_value


@pytest.mark.parametrize("name", SEARCHES)
def test_same_seed_same_bytes_other_seed_other_bytes(name):
    first, second, other = (searched(SEARCHES[name], seed, 300)[0].incumbents.tobytes() for seed in (3, 3, 4))
    assert first == second
    assert first != other


@pytest.mark.parametrize("name", SEARCHES)
def test_states_are_never_changed_in_place(name):
    search, rng = SEARCHES[name], np.random.default_rng(0)
    state = search.init(BOX, 20, 10, rng)
    for _ in range(6):
        for step in (lambda s: search.tell(s, locked(shifted_sphere(s.candidates)), rng), lambda s: search.ask(s, rng)):
            arrays = [getattr(state, f.name) for f in fields(state) if isinstance(getattr(state, f.name), np.ndarray)]
            copies = [array.copy() for array in arrays]
            for array in arrays:
                locked(array)
            state = step(state)
            assert all((array == copy).all() for array, copy in zip(arrays, copies, strict=True))
    assert state.generation == 6


@pytest.mark.parametrize("name", SEARCHES)
def test_candidates_stay_in_the_box(name):
    search, rng = SEARCHES[name], np.random.default_rng(1)
    state = search.init(BOX, 20, 40, rng)
    printed_start = isinstance(search, DynamicAdaptivePSO) and not search.start_inside
    for generation in range(40):
        inside = ((state.candidates >= BOX.lower) & (state.candidates <= BOX.upper)).all()
        assert inside or (printed_start and generation == 0)
        assert state.candidates.shape == (20, 5)
        state = search.ask(search.tell(state, shifted_sphere(state.candidates), rng), rng)


@pytest.mark.parametrize("search", READ)
def test_readings_differ_and_unknown_ones_are_refused(search):
    standard, printed = (searched(search(reading=reading), 0, 300)[0] for reading in ("standard", "as-printed"))
    assert standard.incumbents.tobytes() != printed.incumbents.tobytes()
    with pytest.raises(StudyError, match="no paper reading 'printed'; did you mean 'as-printed'"):
        search(reading="printed")


def test_other_impossible_constants_are_refused():
    with pytest.raises(StudyError, match="sum exceeds 4, got 2 and 2"):
        CFPSO(cognitive=2.0, social=2.0)
    with pytest.raises(StudyError, match="no clamp unit 'shares'"):
        VelocityUpdate(unit="shares")


@pytest.mark.parametrize("name", SEARCHES)
def test_searches_are_values(name):
    assert replace(SEARCHES[name]) == SEARCHES[name]
    assert hash(replace(SEARCHES[name])) == hash(SEARCHES[name])
