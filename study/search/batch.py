"""Several runs of one search in lock step: one objective call for each generation of all of them.

Every run keeps its own state and generator, so each goes exactly as it goes alone; what is saved is the cost of a call
that does not depend on how many candidates it is given.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from study.errors import StudyError
from study.planning import Meter
from study.problem import Floats
from study.search.loop import Box, Search


def minimise_many(
    search: Search[Any],
    objective: Callable[[Floats], Floats],
    budget: int,
    box: Box,
    population: int,
    rngs: Sequence[np.random.Generator],
) -> list[Meter]:
    """Spend a budget once for each generator.

    Parameters
    ----------
    search : Search
    objective : callable (n_candidates, n_dimensions) -> (n_candidates,)
        Must value each candidate by itself, whoever stands beside it.
    budget : int
        Evaluations of each run.
    box : Box
    population : int
    rngs : sequence of numpy.random.Generator
        One for each run.

    Returns
    -------
    list of Meter
        With the evaluations, incumbent and history of each run, as `minimise` would have left them.

    Raises
    ------
    StudyError
        If there is no generator.
    """
    if not rngs:
        raise StudyError("minimise_many needs at least one random generator, one for each run; got none")
    population = min(population, budget)
    told: list[Floats] = [np.empty(0)] * len(rngs)
    meters = [Meter(partial(_first, told, run), budget) for run in range(len(rngs))]
    states = [search.init(box, population, -(-budget // population), rng) for rng in rngs]
    while True:
        left = budget - meters[0].evaluations
        together = np.concatenate([state.candidates[:left] for state in states])
        told[:] = np.split(objective(together), len(rngs))
        values = [meter(state.candidates) for meter, state in zip(meters, states, strict=True)]
        states = [search.tell(*one) for one in zip(states, values, rngs, strict=True)]
        if meters[0].exhausted:
            return meters
        states = [search.ask(state, rng) for state, rng in zip(states, rngs, strict=True)]


def _first(told: list[Floats], run: int, candidates: Floats) -> Floats:
    """What the common call said of one run's candidates."""
    return told[run][: len(candidates)]
