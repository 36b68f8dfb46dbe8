"""Population state of searches without velocities, and its replacement rules."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.search.batched_rng import Rng
from study.search.state import Box, State, uniform_population


@dataclass(frozen=True, eq=False)
class PopulationState(State):
    """State with the population that the next candidates come from.

    Attributes
    ----------
    members : array of shape (n_candidates, n_dimensions)
    values : array of shape (n_candidates,)
        Their objective values; infinite before the first evaluation.
    """

    members: Floats
    values: Floats

    def replaced(self, values: Floats) -> Self:
        """Take the candidates as the new population, better or not."""
        return self.told(values, members=self.candidates, values=values)

    def kept_better(self, values: Floats) -> Self:
        """Take each candidate only where it is better than the member it came from."""
        better = values < self.values
        members = np.where(better[..., None], self.candidates, self.members)
        return self.told(values, members=members, values=np.where(better, values, self.values))


def new_population(box: Box, positions: Floats, generations: int) -> PopulationState:
    """State of a population that has not been evaluated yet."""
    return PopulationState.new(box, positions, generations, members=positions, values=np.full(len(positions), np.inf))


def spread_population(box: Box, population: int, generations: int, rng: np.random.Generator) -> PopulationState:
    """State of a population spread uniformly over the box."""
    return new_population(box, uniform_population(box, population, rng), generations)


class Generational:
    """Search that starts uniformly and replaces its whole population in every generation."""

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> PopulationState:
        """Spread members uniformly."""
        return spread_population(box, population, generations, rng)

    def tell(self, state: PopulationState, values: Floats, rng: Rng) -> PopulationState:
        """Take the new positions, better or not."""
        return state.replaced(values)


def normalised_fitness(values: Floats) -> Floats:
    """Normalised fitness from the generation's best, 0, to its worst, 1; infinite values count as worst.

    Parameters
    ----------
    values : array of shape (n_candidates,)

    Returns
    -------
    array of shape (n_candidates,)
        All 1 if nothing is finite, all 0 if everything is equal.
    """
    best, worst = values[values.argmin()], values[values.argmax()]
    if not (math.isfinite(best) and math.isfinite(worst)):
        finite = values[np.isfinite(values)]
        if not finite.size:
            return np.ones(len(values))
        best, worst = finite.min(), finite.max()
    return np.minimum((values - best) / (worst - best), 1.0) if worst > best else np.where(values > best, 1.0, 0.0)


def check_share(search: str, field: str, value: float) -> None:
    """Refuse a share or probability outside [0, 1].

    Raises
    ------
    StudyError
        Naming the search, the field and the value.
    """
    if not 0.0 <= value <= 1.0:
        raise StudyError(f"{search}: {field} must lie between 0 and 1, got {value:g}")
