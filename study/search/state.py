"""Search space, search state and the ask-and-tell interface that all searches share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np

from study.problem import Floats
from study.search.batched_rng import Rng


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


def uniform_population(box: Box, population: int, rng: Rng) -> Floats:
    """Independent uniform candidates in the box, shape (population, n_dimensions)."""
    return box.at(rng.random((population, len(box.lower))))


@dataclass(frozen=True, eq=False)
class State:
    """Population, incumbent and progress of a search.

    Batched runs: arrays gain a leading axis n_runs; the incumbents have shape (n_runs, 1, n_dimensions), their values
    (n_runs, 1).

    Attributes
    ----------
    box : Box
    candidates : array of shape (n_candidates, n_dimensions)
        The population to evaluate next.
    generations : int
        Number of populations that the budget covers.
    generation : int
        Number of populations told so far.
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
        least, leaders = values[runs, best, None], self.candidates[runs, best, None]
        better = least < self.incumbent_value
        return np.where(better[..., None], leaders, self.incumbent), np.where(better, least, self.incumbent_value)

    @classmethod
    def new(cls, box: Box, positions: Floats, generations: int, **own: Any) -> Self:
        """State of a population that has not been evaluated yet; `own` are the fields that a kind of state adds."""
        return cls(box, positions, generations, 0, positions[0], np.inf, **own)

    def told(self, values: Floats, /, **changes: Any) -> Self:
        """State after the candidates have come back with `values`: incumbent and generation follow, and `changes`."""
        incumbent, value = self.improved(values)
        return evolved(self, incumbent=incumbent, incumbent_value=value, generation=self.generation + 1, **changes)

    @classmethod
    def batch(cls, states: Sequence[Self]) -> Self:
        """Stack the states of several runs into one batched state."""
        fields = {name: [getattr(state, name) for state in states] for name in vars(states[0])}
        stacked = {
            name: np.stack(values) if isinstance(values[0], np.ndarray) else values[0]
            for name, values in fields.items()
        }
        values = np.array(fields["incumbent_value"])[:, None]
        return evolved(states[0], **stacked | {"incumbent": stacked["incumbent"][:, None], "incumbent_value": values})


S = TypeVar("S", bound=State)


def evolved(state: S, **changes: Any) -> S:
    """Copy of a state with some fields changed; `dataclasses.replace` takes longer than moving fifty candidates."""
    copy = object.__new__(type(state))
    copy.__dict__.update(state.__dict__, **changes)
    return copy


class Search(Protocol, Generic[S]):
    """Metaheuristic as three pure functions over a frozen state; all randomness comes from the generator passed in."""

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> S:
        """Make the first state; its candidates are the initial population."""

    def ask(self, state: S, rng: np.random.Generator) -> S:
        """Propose the next candidates."""

    def tell(self, state: S, values: Floats, rng: np.random.Generator) -> S:
        """Learn the candidates' objective values, shape (n_candidates,)."""


class BatchedSearch(Generic[S]):
    """A search whose `ask` and `tell` also take the batched state of several runs and a `BatchedRng`."""

    def batch(self, states: Sequence[S]) -> S:
        """Stack the states of several runs, so that one call of `ask` or `tell` serves them all."""
        return type(states[0]).batch(states)
