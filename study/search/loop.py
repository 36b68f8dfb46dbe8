"""The one loop that drives every search, and the state that all searches share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np

from study.planning import Meter
from study.problem import Floats
from study.search.engine import with_engine


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds of the search space; `lower` and `upper` have shape (n_dimensions,)."""

    lower: Floats
    upper: Floats

    @cached_property
    def width(self) -> Floats:
        """Side lengths, shape (n_dimensions,)."""
        return self.upper - self.lower

    def at(self, fractions: Floats) -> Floats:
        """Map fractions in [0, 1] into the box."""
        return self.lower + fractions * self.width


@dataclass(frozen=True, eq=False)
class State:
    """What every search remembers.

    Runs side by side share one state: their arrays have a leading axis for the runs, and what each run has one of has
    length 1 along the axes of candidates and dimensions, so that the same lines move one population or many.

    Attributes
    ----------
    box : Box
    candidates : array of shape (n_candidates, n_dimensions)
        The population to evaluate next.
    generations : int
        How many populations the budget covers.
    generation : int
        How many of them have been told.
    incumbent : array of shape (n_dimensions,)
    incumbent_value : float
    """

    box: Box
    candidates: Floats
    generations: int
    generation: int
    incumbent: Floats
    incumbent_value: float

    @property
    def progress(self) -> float:
        """Share of the generations told so far, in [0, 1]."""
        return min(self.generation / self.generations, 1.0)

    def improved(self, values: Floats) -> tuple[Floats, float]:
        """Incumbent and its value after the candidates have come back with `values`, shape (n_candidates,)."""
        if values.ndim > 1:
            return self._improved_each(values)
        best = int(values.argmin())
        if values[best] < self.incumbent_value:
            return self.candidates[best].copy(), float(values[best])
        return self.incumbent, self.incumbent_value

    def _improved_each(self, values: Floats) -> tuple[Floats, Any]:
        runs, best = np.arange(len(values)), values.argmin(axis=1)
        least, found = values[runs, best, None], self.candidates[runs, best, None]
        better = least < self.incumbent_value
        return np.where(better[..., None], found, self.incumbent), np.where(better, least, self.incumbent_value)

    @classmethod
    def side_by_side(cls, states: Sequence[Self]) -> Self:
        """Make one state of several runs' own."""
        together = {name: [getattr(state, name) for state in states] for name in vars(states[0])}
        shared = {
            name: np.stack(values) if isinstance(values[0], np.ndarray) else values[0]
            for name, values in together.items()
        }
        values = np.array(together["incumbent_value"])[:, None]
        return evolved(states[0], **shared | {"incumbent": shared["incumbent"][:, None], "incumbent_value": values})


S = TypeVar("S", bound=State)


class SideBySide:
    """Mark of a search whose `ask` and `tell` also take runs side by side, with a generator for each."""


def evolved(state: S, **changes: Any) -> S:
    """Copy a state with some fields changed; `dataclasses.replace` takes longer than moving fifty candidates."""
    copy = object.__new__(type(state))
    copy.__dict__.update(state.__dict__, **changes)
    return copy


class Search(Protocol, Generic[S]):
    """A metaheuristic as three pure functions over a frozen state; all randomness comes from the generator passed in."""

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> S:
        """Make the first state; its candidates are the initial population."""

    def ask(self, state: S, rng: np.random.Generator) -> S:
        """Propose the next candidates."""

    def tell(self, state: S, values: Floats, rng: np.random.Generator) -> S:
        """Learn the candidates' objective values, shape (n_candidates,)."""


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
