"""Differential evolution, rand/1/bin.

References
----------
UR5 paper on SMWOA, Table 3, which names it and gives no setting; Storn and Price (1997).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.search.bounds import bounded
from study.search.loop import Box
from study.search.population import PopulationState, check_share, spread_population

SMALLEST_POPULATION = 4


@dataclass(frozen=True)
class DE:
    """Mutate by the difference of two random members, cross over with the parent, keep the better.

    Attributes
    ----------
    factor : float
        Differential weight F; ours, the paper gives none.
    crossover : float
        Crossover rate CR; ours, the paper gives none.
    bounds : str
        A rule of `study.search.bounds`; ours.
    """

    factor: float = 0.5
    crossover: float = 0.9
    bounds: str = "clip"

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

    def ask(self, state: PopulationState, rng: np.random.Generator) -> PopulationState:
        """Build one trial for every member."""
        x = state.members
        n, d = x.shape
        a, b, c = x[three_others(n, rng).T]
        mutant = a + self.factor * (b - c)
        crossed = rng.random((n, d)) < self.crossover
        crossed[np.arange(n), rng.integers(d, size=n)] = True
        return replace(state, candidates=bounded(self.bounds, state.box, np.where(crossed, mutant, x))[0])

    def tell(self, state: PopulationState, values: Floats, rng: np.random.Generator) -> PopulationState:
        """Keep each trial that is better than its parent."""
        return state.kept_better(values)


def three_others(n: int, rng: np.random.Generator) -> np.ndarray:
    """Draw for each of n members three different others, int array of shape (n, 3)."""
    taken = np.arange(n)[:, None]
    for left in range(n - 1, n - 4, -1):
        pick = rng.integers(left, size=n)
        for lower in np.sort(taken, axis=1).T:  # count past those that are taken, from the lowest
            pick += pick >= lower
        taken = np.column_stack([taken, pick])
    return taken[:, 1:]
