"""What the searches themselves cost: an objective that costs next to nothing, ours and others' implementations."""

from __future__ import annotations

import numpy as np

from study.bench import peers
from study.bench.measuring import Call, Limit, Ratio, interleaved, missing
from study.planners import opponents, plain, puma, smwoa, sparrow, woodworking
from study.planners.segment_times import SegmentTimePlanner
from study.planning import Meter
from study.problem import Floats
from study.search.loop import Box, minimise

TOPIC = "Search overhead"
POPULATION, DIMENSIONS = 50, 5
GENERATIONS, FEW_GENERATIONS = 100, 8
"""Of our searches and of peers that take long."""

MOST = 1e-6
TARGETS = {"mealpy": 20.0, "pymoo": 20.0, "pyswarms": 2.0}
SEARCHES: dict[str, SegmentTimePlanner] = {
    "pso": plain.PSO_STANDARD,
    "de": smwoa.DE_PLANNER,
    "woa": smwoa.WOA_PLANNER,
    "sma": smwoa.SMA_PLANNER,
    "sca": opponents.SCA_PLANNER,
    "ssa": sparrow.SSA_PLANNER,
    "smwoa": smwoa.SMWOA_PLANNER,
    "gsa": smwoa.GSA_PLANNER,
    "golds-pso": woodworking.GOLDS_PSO,
    "gold-sa": woodworking.GOLD_SA,
    "cfpso": woodworking.CF_PSO,
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


def ours(name: str, generations: int = GENERATIONS) -> Call:
    """Run one of our searches."""
    search = SEARCHES[name].search

    def call() -> None:
        meter = Meter(first_column, POPULATION * generations)
        minimise(search, meter, BOX, POPULATION, np.random.default_rng(1))

    return call


def search_rows(repetitions: int) -> list[Ratio | Limit]:
    """Measure every search alone and next to the packages that have it."""
    rows: list[Ratio | Limit] = []
    with peers.quiet():
        for name in SEARCHES:
            calls = {"ours": ours(name)} | _peers(name)
            counts = {key: POPULATION * _generations(key) for key in calls}
            taken = interleaved(calls, repetitions, counts)
            rows.append(Limit(TOPIC, name, "evaluation", taken["ours"], MOST))
            rows += [
                Ratio(TOPIC, name, peer, "evaluation", taken["ours"], taken[peer], TARGETS[peer])
                for peer in TARGETS
                if peer in taken
            ]
    absent = [peer for peer in TARGETS if not peers.installed(peer)]
    return rows + [missing(TOPIC, "all searches", peer, TARGETS[peer]) for peer in absent]


def _generations(key: str) -> int:
    return FEW_GENERATIONS if key in ("mealpy", "pymoo") else GENERATIONS


def _peers(name: str) -> dict[str, Call]:
    calls: dict[str, Call] = {}
    few = POPULATION, FEW_GENERATIONS
    if name in peers.MEALPY and peers.installed("mealpy"):
        calls["mealpy"] = lambda: peers.with_mealpy(name, first_number, BOX, *few)
    if name in peers.PYMOO and peers.installed("pymoo"):
        calls["pymoo"] = lambda: peers.with_pymoo(name, first_column, BOX, *few)
    if name == "pso" and peers.installed("pyswarms"):
        calls["pyswarms"] = lambda: peers.with_pyswarms(first_column, BOX, POPULATION, GENERATIONS)
    return calls
