"""Random search: the floor that every metaheuristic must beat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.problem import Floats
from study.search.batched_rng import Rng
from study.search.state import BatchedSearch, Box, State, evolved, uniform_population


@dataclass(frozen=True)
class RandomSearch(BatchedSearch[State]):
    """Random search: every generation uniform in the box."""

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> State:
        """Draw the first generation."""
        return State.new(box, uniform_population(box, population, rng), generations)

    def ask(self, state: State, rng: Rng) -> State:
        """Draw the next generation."""
        return evolved(state, candidates=uniform_population(state.box, state.candidates.shape[-2], rng))

    def tell(self, state: State, values: Floats, rng: Rng) -> State:
        """Remember the best."""
        return state.told(values)
