"""Differential evolution (DE), rand/1/bin.

References
----------
UR5 paper on SMWOA, Table 3, which names it and gives no setting; Storn and Price (1997).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.search.batched_rng import Rng, members_at
from study.search.bounds import BoundsRule, bounded_positions
from study.search.population import PopulationState, check_share, spread_population
from study.search.state import BatchedSearch, Box, evolved

SMALLEST_POPULATION = 4


@dataclass(frozen=True)
class DE(BatchedSearch[PopulationState]):
    """Differential evolution: mutate by the difference of two members, cross over with the parent, keep the better.

    Attributes
    ----------
    factor : float
        Differential weight F; ours, the paper gives none.
    crossover : float
        Crossover rate CR; ours, the paper gives none.
    bounds : BoundsRule
        A rule of `study.search.bounds`; ours.
    """

    factor: float = 0.5
    crossover: float = 0.9
    bounds: BoundsRule = BoundsRule.CLIP

    def __post_init__(self) -> None:
        check_share("DE", "crossover", self.crossover)

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> PopulationState:
        """Spread members uniformly.

        Raises
        ------
        StudyError
            If there are fewer than four members, so that no three others can be drawn.
        """
        if population < SMALLEST_POPULATION:
            raise StudyError(
                f"differential evolution needs a population of at least {SMALLEST_POPULATION}, got {population}; "
                "raise the population and the number of evaluations"
            )
        return spread_population(box, population, generations, rng)

    def ask(self, state: PopulationState, rng: Rng) -> PopulationState:
        """Build one trial for every member."""
        x = state.members
        n, d = x.shape[-2:]
        a, b, c = members_at(x, three_others(n, rng))
        mutant = a + self.factor * (b - c)
        crossed = rng.random((n, d)) < self.crossover
        crossed |= rng.integers(d, size=(n, 1)) == np.arange(d)
        return evolved(state, candidates=bounded_positions(self.bounds, state.box, np.where(crossed, mutant, x)))

    def tell(self, state: PopulationState, values: Floats, rng: Rng) -> PopulationState:
        """Keep each trial that is better than its parent."""
        return state.kept_better(values)


def three_others(n: int, rng: Rng) -> np.ndarray:
    """Draw for each of n members three different others, int array of shape (3, n) or (3, n_runs, n)."""
    own, remaining = _others(n)
    drawn = rng.integers(remaining).swapaxes(0, -2)
    first, second, third = drawn
    first += first >= own  # count past those that are taken, from the lowest
    low, high = np.minimum(own, first), np.maximum(own, first)
    second += second >= low
    second += second >= high
    for lower in (np.minimum(low, second), np.maximum(low, np.minimum(high, second)), np.maximum(high, second)):
        third += third >= lower
    return drawn


@lru_cache(maxsize=64)
def _others(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Every member's number, shape (n,), and number of members left for each draw, shape (3, n)."""
    return np.arange(n), np.repeat([[n - 1], [n - 2], [n - 3]], n, axis=1)
