"""Overhead of the searches on an objective of almost no cost, beside other implementations.

Ours take their compiled steps where they have any and numba is there, as in a long run.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from study.bench import peers
from study.bench.measuring import Call, Measurement, interleaved, missing
from study.planners import aubo, other_searches, puma, smwoa, sparrow, woodworking
from study.planners.segment_times import SegmentTimePlanner
from study.planning import Meter
from study.problem import Floats
from study.search.loop import minimise, minimise_many, with_engine
from study.search.state import BatchedSearch, Box, Search

TOPIC = "Search overhead"
POPULATION, DIMENSIONS = 100, 5
GENERATIONS, FEW_GENERATIONS = 100, 8
"""Of our searches and of peers that take long."""

TOGETHER = 30
"""Runs of a batch: the repetitions of a cell in the papers."""

MOST = 1e-6
TARGETS = {"mealpy": 20.0, "pymoo": 20.0, "niapy": 20.0, "pyswarms": 2.0}
SEARCHES: dict[str, SegmentTimePlanner] = {
    "pso": other_searches.PSO_STANDARD,
    "de": smwoa.DE_PLANNER,
    "woa": smwoa.WOA_PLANNER,
    "sma": smwoa.SMA_PLANNER,
    "sca": other_searches.SCA_PLANNER,
    "ssa": sparrow.SSA_PLANNER,
    "smwoa": smwoa.SMWOA_PLANNER,
    "gsa": smwoa.GSA_PLANNER,
    "stoa": other_searches.STOA_PLANNER,
    "golds-pso": woodworking.GOLDS_PSO,
    "gold-sa": woodworking.GOLD_SA,
    "cfpso": woodworking.CF_PSO,
    "simple-pso": woodworking.SIMPLE_PSO,
    "dynamic-adaptive-pso": aubo.DYNAMIC_ADAPTIVE_PSO,
    "chaotic-spso": puma.CHAOTIC_SPSO,
    "tadf-ssa": sparrow.TADF_SSA,
}
BOX = Box(np.zeros(DIMENSIONS), np.ones(DIMENSIONS))


def first_column(x: Floats) -> Floats:
    """Objective of a population that costs next to nothing."""
    return x[:, 0]


def first_number(x: Floats) -> float:
    """Objective of one candidate that costs next to nothing."""
    return float(x[0])


def runs_of(
    search: Search[Any],
    objective: Callable[[Floats], Floats],
    box: Box,
    population: int,
    generations: int,
    runs: int = 1,
) -> Call:
    """Run a search once, or so many times as one batch."""
    budget = population * generations

    def call() -> None:
        rngs = [np.random.default_rng(seed) for seed in range(1, runs + 1)]
        if runs == 1:
            minimise(search, Meter(objective, budget), box, population, rngs[0])
        else:
            minimise_many(search, objective, budget, box, population, rngs)

    return call


def ours(name: str, runs: int = 1, generations: int = GENERATIONS) -> Call:
    """Run one of our searches, once or many times as one batch."""
    return runs_of(with_engine(SEARCHES[name].search), first_column, BOX, POPULATION, generations, runs)


def search_rows(repetitions: int) -> list[Measurement]:
    """Measure every search alone and next to the packages that have it, and as a batch where its runs share arrays."""
    rows: list[Measurement] = []
    with peers.quiet():
        for name, planner in SEARCHES.items():
            calls = {name: ours(name)}
            if isinstance(planner.search, BatchedSearch):
                calls[f"{name}, {TOGETHER} runs as one batch"] = ours(name, TOGETHER)
            rows += _rows(calls, _peers(name), repetitions)
    absent = [peer for peer in TARGETS if not peers.installed(peer)]
    return rows + [missing(TOPIC, "all searches", peer, TARGETS[peer]) for peer in absent]


def _rows(calls: dict[str, Call], others: dict[str, Call], repetitions: int) -> list[Measurement]:
    counts = dict(zip(calls, (POPULATION * GENERATIONS, TOGETHER * POPULATION * GENERATIONS), strict=False))
    counts |= {peer: POPULATION * _generations(peer) for peer in others}
    taken = interleaved(calls | others, repetitions, counts)
    rows: list[Measurement] = []
    for label in calls:
        rows.append(Measurement(TOPIC, label, "", "evaluation", taken[label], most=MOST))
        rows += [
            Measurement(TOPIC, label, peer, "evaluation", taken[label], taken[peer], TARGETS[peer]) for peer in others
        ]
    return rows


def _generations(peer: str) -> int:
    return GENERATIONS if peer == "pyswarms" else FEW_GENERATIONS


def _peers(name: str) -> dict[str, Call]:
    calls: dict[str, Call] = {}
    few = POPULATION, FEW_GENERATIONS
    if name in peers.MEALPY and peers.installed("mealpy"):
        calls["mealpy"] = lambda: peers.with_mealpy(name, first_number, BOX, *few)
    if name in peers.PYMOO and peers.installed("pymoo"):
        calls["pymoo"] = lambda: peers.with_pymoo(name, first_column, BOX, *few)
    if name in peers.NIAPY and peers.installed("niapy"):
        calls["niapy"] = lambda: peers.with_niapy(name, first_number, BOX, *few)
    if name == "pso" and peers.installed("pyswarms"):
        calls["pyswarms"] = lambda: peers.with_pyswarms(first_column, BOX, POPULATION, GENERATIONS)
    return calls
