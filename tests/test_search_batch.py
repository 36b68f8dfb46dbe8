"""Runs in lock step against the same runs one by one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from study.curves import CURVES
from study.errors import StudyError
from study.experiment.cases import load_case
from study.formulation import Penalty
from study.planning import Meter
from study.problem import Floats
from study.search.batch import minimise_many
from study.search.de import DE
from study.search.golds_pso import GoldSPSO
from study.search.loop import Box, Search, minimise
from study.search.pso import PSO
from study.search.sma import SMA
from study.search.ssa import SSA

N_RUNS = 5


def generators() -> list[np.random.Generator]:
    return [np.random.default_rng(stream) for stream in np.random.SeedSequence(2).spawn(N_RUNS)]


@pytest.mark.parametrize("search", [PSO(), GoldSPSO(), DE(), SMA(), SSA()], ids=lambda search: type(search).__name__)
def test_equals_runs_one_by_one(search: Search[Any]) -> None:
    problem = load_case("woodworking").problem
    objective = Penalty(problem, CURVES["poly353"])
    box = Box(*(np.full(3, bound) for bound in problem.duration_bounds))
    together = minimise_many(search, objective, 190, box, 20, generators())  # the last generation is cut short
    for rng, batched in zip(generators(), together, strict=True):
        alone = Meter(objective, 190)
        minimise(search, alone, box, 20, rng)
        assert alone.evaluations == batched.evaluations == 190
        np.testing.assert_array_equal(alone.history, batched.history)
        np.testing.assert_array_equal(alone.incumbents, batched.incumbents)


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
