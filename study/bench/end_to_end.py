"""Whole searches of the woodworking case, as a user meets them: search and evaluation together, next to whole peers.

Four joints together, population 50, 300 generations, particle swarms. The peers' evaluations are the papers' own for
mealpy, and our compiled kernel, a generation in one call, for pymoo and pyswarms. All numbers are for one evaluation;
peers that take long are given fewer generations. Two ways of ours stand beside each peer: one run, and the thirty
repetitions of a cell as one batch, which the targets are set for. Peers have no such batch: to them thirty repetitions
cost thirty times one run.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from study.bench import papers_way, peers
from study.bench.measuring import Call, Measurement, interleaved, missing
from study.bench.searches import TOGETHER, runs_of
from study.cases.library import load_case
from study.curves import compiled, curve_named
from study.formulation import Penalty
from study.planners.other_searches import PSO_STANDARD
from study.problem import Problem
from study.search.loop import with_engine
from study.search.state import Box

TOPIC = "End to end"
CASE = "woodworking"
POPULATION, GENERATIONS = 50, 300
FEW = {"mealpy": 3, "pymoo": 20}
TARGETS = {"mealpy": 1000.0, "pymoo": 100.0, "pyswarms": 5.0}
NAMES = {
    "mealpy": "mealpy with the papers' evaluation",
    "pymoo": "pymoo with our compiled kernel",
    "pyswarms": "pyswarms with our compiled kernel",
}


def end_to_end_rows(repetitions: int) -> list[Measurement]:
    """Measure one run, and thirty runs as one batch, next to each peer."""
    problem = load_case(CASE).problem
    objective = Penalty(problem, compiled.with_engine(curve_named("poly353")))
    box = Box(*(np.full(problem.n_segments, bound) for bound in problem.duration_bounds))
    shape, pso = (objective, box, POPULATION, GENERATIONS), PSO_STANDARD.search
    calls = {"one run": runs_of(with_engine(pso), *shape), "30 runs": runs_of(pso, *shape, TOGETHER)}
    counts = {"one run": POPULATION * GENERATIONS, "30 runs": POPULATION * GENERATIONS * TOGETHER}
    there = [peer for peer in TARGETS if peers.installed(peer)]
    for peer in there:
        calls[peer] = _peer(peer, problem, objective, box)
        counts[peer] = POPULATION * FEW.get(peer, GENERATIONS)
    with peers.quiet():
        taken = interleaved(calls, repetitions, counts)
    rows = [
        Measurement(TOPIC, _name(ours), NAMES[peer], "evaluation", taken[ours], taken[peer], target[peer])
        for ours, target in (("one run", dict.fromkeys(TARGETS)), ("30 runs", TARGETS))
        for peer in there
    ]
    absent = [peer for peer in TARGETS if peer not in there]
    return rows + [missing(TOPIC, _name("30 runs"), NAMES[peer], TARGETS[peer]) for peer in absent]


def _name(ours: str) -> str:
    many = f"{TOGETHER} runs as one batch" if ours != "one run" else "one run"
    return f"PSO on {CASE}, {POPULATION} x {GENERATIONS} evaluations, {many}"


def _peer(name: str, problem: Problem, objective: Penalty, box: Box) -> Call:
    generations = FEW.get(name, GENERATIONS)
    if name == "mealpy":
        value = partial(papers_way.value_353, problem)
        return partial(peers.with_mealpy, "pso", value, box, POPULATION, generations)
    if name == "pymoo":
        return partial(peers.with_pymoo, "pso", objective, box, POPULATION, generations)
    return partial(peers.with_pyswarms, objective, box, POPULATION, generations)
