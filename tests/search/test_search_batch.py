"""Runs as one batch against the same runs one by one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from study.cases.library import load_case
from study.curves import CURVES
from study.errors import StudyError
from study.formulation import Penalty
from study.planners.segment_times import SegmentTimePlanner
from study.planning import Meter
from study.problem import Floats
from study.registry import planner_named, planner_names, unavailable_planners
from study.search.batched_rng import BatchedRng
from study.search.cfpso import CFPSO
from study.search.chaotic_spso import ChaoticSPSO
from study.search.de import DE
from study.search.dynamic_adaptive_pso import DynamicAdaptivePSO
from study.search.gold_sa import GoldSA
from study.search.golds_pso import GoldSPSO
from study.search.loop import minimise, minimise_many
from study.search.pso import PSO, VelocityUpdate
from study.search.simple_pso import SimplePSO
from study.search.state import BatchedSearch, Box, Search

N_RUNS = 5


def generators() -> list[np.random.Generator]:
    return [np.random.default_rng(stream) for stream in np.random.SeedSequence(2).spawn(N_RUNS)]


SEARCHES: dict[str, Search[Any]] = {
    name: planner.search
    for name in sorted(set(planner_names()) - set(unavailable_planners()))
    if isinstance(planner := planner_named(name), SegmentTimePlanner) and name != "cma-es"
} | {
    "gold-sa, linked, every coordinate": GoldSA(linked=True, per_dimension=True),
    "golds-pso without its sine": GoldSPSO(golden_sine=False),
    "pso, reflected": PSO(velocity=VelocityUpdate(bounds="reflect")),
    "chaotic-spso from everywhere": ChaoticSPSO(chaotic_start=False, asynchronous=False),
}


@pytest.mark.parametrize("name", SEARCHES)
def test_equals_runs_one_by_one(name: str) -> None:
    search, problem = SEARCHES[name], load_case("woodworking").problem
    objective = Penalty(problem, CURVES["poly353"])
    box = Box(*(np.full(3, bound) for bound in problem.duration_bounds))
    together = minimise_many(search, objective, 190, box, 20, generators())  # the last generation is cut short
    for rng, batched in zip(generators(), together, strict=True):
        alone = Meter(objective, 190)
        minimise(search, alone, box, 20, rng)
        assert alone.evaluations == batched.evaluations == 190
        np.testing.assert_array_equal(alone.history, batched.history)
        np.testing.assert_array_equal(alone.incumbents, batched.incumbents)


@pytest.mark.parametrize("search", [PSO(), CFPSO(), ChaoticSPSO(), DynamicAdaptivePSO(), SimplePSO(), DE()])
def test_swarms_and_differential_evolution_move_all_runs_in_one_call(search: Search[Any]) -> None:
    """So that thirty repetitions cost a handful of array operations for each generation."""
    assert isinstance(search, BatchedSearch)
    box, rngs = Box(np.zeros(3), np.ones(3)), generators()
    state = search.batch([search.init(box, 8, 5, rng) for rng in rngs])
    told = search.tell(state, state.candidates.sum(axis=2), BatchedRng(tuple(rngs)))
    assert search.ask(told, BatchedRng(tuple(rngs))).candidates.shape == (N_RUNS, 8, 3)


@pytest.mark.parametrize("shape", [(4, 2), (4, 1), (3, 4, 2), (2, 4, 1)])
def test_generators_draw_what_each_would_alone(shape: tuple[int, ...]) -> None:
    together = BatchedRng(tuple(generators())).random(shape)
    apart = [rng.random(shape) for rng in generators()]
    np.testing.assert_array_equal(together, np.stack(apart, axis=len(shape) - 2))


def test_no_value_at_all_leaves_no_incumbent_in_a_batch() -> None:
    meters = minimise_many(PSO(), lambda x: np.full(len(x), np.nan), 50, Box(np.zeros(2), np.ones(2)), 20, generators())
    assert [meter.incumbent for meter in meters] == [None] * N_RUNS
    assert np.isinf(np.concatenate([meter.history[:, 1] for meter in meters])).all()


def test_calls_the_objective_once_for_each_generation() -> None:
    sizes = []

    def bowl(x: Floats) -> Floats:
        sizes.append(len(x))
        return (x**2).sum(axis=1)

    minimise_many(PSO(), bowl, 50, Box(-np.ones(2), np.ones(2)), 20, generators())
    assert sizes == [100, 100, 50]


def test_refuses_no_runs() -> None:
    with pytest.raises(StudyError, match="at least one random generator"):
        minimise_many(PSO(), lambda x: x[:, 0], 10, Box(np.zeros(1), np.ones(1)), 5, [])
