"""Ask-and-tell loops: one run of a search, or several runs that share every call of the objective."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from study.engine import compiled_module
from study.errors import StudyError
from study.planning import Meter
from study.problem import Floats
from study.search.batched_rng import BatchedRng
from study.search.state import BatchedSearch, Box, S, Search, State


def with_engine(search: Search[Any], evaluations: int | None = None) -> Search[Any]:
    """Compiled variant of a search, which gives the same bits, where the engine for that many evaluations is numba.

    Parameters
    ----------
    search : Search
    evaluations : int, optional
        Budget of the run; without one the run counts as long.
    """
    compiled = compiled_module(_compiled, evaluations)
    return search if compiled is None else compiled.compiled_variant(search)


def _compiled() -> ModuleType:
    from study.search import compiled  # here: importing the module imports numba

    return compiled


def minimise(search: Search[S], meter: Meter, box: Box, population: int, rng: np.random.Generator) -> S:
    """Ask, evaluate and tell until the meter's budget is spent; the meter keeps the incumbent and the history.

    Parameters
    ----------
    search : Search
    meter : Meter
        Wraps the objective; its budget ends the loop.
    box : Box
    population : int
    rng : numpy.random.Generator

    Returns
    -------
    State
        The last state of the search.
    """
    search = with_engine(search, meter.budget)
    population = min(population, meter.budget)
    generations = -(-meter.budget // population)
    state = search.init(box, population, generations, rng)
    while True:
        state = search.tell(state, meter(state.candidates), rng)
        if meter.exhausted:
            return state
        state = search.ask(state, rng)


def minimise_many(
    search: Search[Any],
    objective: Callable[[Floats], Floats],
    budget: int,
    box: Box,
    population: int,
    rngs: Sequence[np.random.Generator],
) -> list[Meter]:
    """Several runs with one objective call per generation of all of them; each goes exactly as it goes alone.

    A `BatchedSearch` also moves all runs in one call; any other search is asked and told run by run.

    Parameters
    ----------
    search : Search
    objective : callable (n_candidates, n_dimensions) -> (n_candidates,)
        Must value each candidate independently of the others in the call.
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
    rng = BatchedRng(tuple(rngs))
    mover: Any = search if isinstance(search, BatchedSearch) else _RunByRun(search)
    state: Any = mover.batch(states)
    while True:
        state = mover.tell(state, _evaluated(objective, meters, state.candidates), rng)
        if meters[0].exhausted:
            return meters
        state = mover.ask(state, rng)


def _evaluated(objective: Callable[[Floats], Floats], meters: list[Meter], candidates: Floats) -> Floats:
    """Evaluate the candidates of all runs, shape (n_runs, n_candidates, n_dimensions), and tell the meters."""
    runs, n, dimensions = candidates.shape
    allowed = min(n, meters[0].budget - meters[0].evaluations)
    raw = objective(candidates[:, :allowed].reshape(-1, dimensions)).reshape(runs, allowed)
    values = np.full((runs, n), np.inf)
    np.fmin(raw, np.inf, out=values[:, :allowed])  # of NaN and infinity, infinity
    bests, least = values.argmin(axis=1).tolist(), values.min(axis=1).tolist()
    for meter, population, best, value in zip(meters, candidates, bests, least, strict=True):
        meter.note(allowed, population, best, value)
    return values


@dataclass(frozen=True, eq=False)
class _States:
    """Separate states of several runs."""

    runs: tuple[State, ...]

    @property
    def candidates(self) -> Floats:
        return np.stack([state.candidates for state in self.runs])


@dataclass(frozen=True)
class _RunByRun:
    """A search that asks and tells run by run, behind the interface of a batched one."""

    search: Search[Any]

    def batch(self, states: Sequence[State]) -> _States:
        return _States(tuple(states))

    def ask(self, states: _States, rng: BatchedRng) -> _States:
        return _States(tuple(map(self.search.ask, states.runs, rng.rngs)))

    def tell(self, states: _States, values: Floats, rng: BatchedRng) -> _States:
        return _States(tuple(map(self.search.tell, states.runs, values, rng.rngs)))
