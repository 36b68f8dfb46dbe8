"""Several runs of one search as one batch: one objective call for each generation of all of them.

Where the search can, the runs share one state of arrays (n_runs, n_candidates, n_dimensions), and a generation costs a
handful of array operations whatever the number of runs. Otherwise each keeps its own state, and only the objective is
shared. Either way each run draws from its own generator and goes exactly as it goes alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.errors import StudyError
from study.planning import Meter
from study.problem import Floats
from study.search.draws import Generators
from study.search.engine import with_engine
from study.search.loop import Box, Search, SideBySide, State


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
    search = with_engine(search, budget)
    population = min(population, budget)
    meters = [Meter(objective, budget) for _ in rngs]
    states = [search.init(box, population, -(-budget // population), rng) for rng in rngs]
    every = Generators(tuple(rngs))
    shared = isinstance(search, SideBySide)
    moving: Any = search if shared else _Apart(search)
    state: Any = states[0].side_by_side(states) if shared else _States(tuple(states))
    while True:
        state = moving.tell(state, _valued(objective, meters, state.candidates), every)
        if meters[0].exhausted:
            return meters
        state = moving.ask(state, every)


def _valued(objective: Callable[[Floats], Floats], meters: list[Meter], candidates: Floats) -> Floats:
    """Value the candidates of all runs, shape (n_runs, n_candidates, n_dimensions), in one call, and tell the meters."""
    runs, n, dimensions = candidates.shape
    allowed = min(n, meters[0].budget - meters[0].evaluations)
    told = objective(candidates[:, :allowed].reshape(-1, dimensions)).reshape(runs, allowed)
    values = np.full((runs, n), np.inf)
    np.fmin(told, np.inf, out=values[:, :allowed])  # of NaN and infinity, infinity
    found = zip(meters, candidates, values.argmin(axis=1).tolist(), values.min(axis=1).tolist(), strict=True)
    for meter, own, best, value in found:
        meter.note(allowed, own, best, value)
    return values


@dataclass(frozen=True, eq=False)
class _States:
    """Runs that keep their own states."""

    each: tuple[State, ...]

    @property
    def candidates(self) -> Floats:
        return np.stack([state.candidates for state in self.each])


@dataclass(frozen=True)
class _Apart:
    """A search that asks and tells run by run."""

    search: Search[Any]

    def ask(self, states: _States, rngs: Generators) -> _States:
        return _States(tuple(map(self.search.ask, states.each, rngs.each)))

    def tell(self, states: _States, values: Floats, rngs: Generators) -> _States:
        return _States(tuple(map(self.search.tell, states.each, values, rngs.each)))
