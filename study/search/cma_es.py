"""CMA-ES (covariance matrix adaptation evolution strategy) of the package `cmaes`.

References
----------
Hansen and Ostermeier (2001). None of the papers compares with it.
"""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.search.state import Box, State

SMALLEST_POPULATION = 4


@dataclass(frozen=True, eq=False)
class CMAState(State):
    """State of the package's optimiser.

    Attributes
    ----------
    optimiser : cmaes.CMA
        Never changed in place: `ask` and `tell` of the search change a copy.
    fractions : array of shape (n_candidates, n_dimensions)
        The candidates as fractions of the box.
    """

    optimiser: Any
    fractions: Floats


@dataclass(frozen=True)
class CMAES:
    """CMA-ES: adapts a normal distribution of candidates; restarts where the distribution has shrunk away.

    Attributes
    ----------
    sigma : float
        First standard deviation as a share of the box's width; ours.
    own_population : bool
        Take the algorithm's own size, 4 + floor(3 ln n) for n dimensions, instead of the size asked for.
    """

    sigma: float = 0.3
    own_population: bool = False

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> CMAState:
        """Start from the centre of the box.

        Raises
        ------
        StudyError
            If the package is not installed, the box has one dimension, or the population is too small.
        """
        if self.own_population:
            budget, population = population * generations, 4 + int(3 * math.log(len(box.lower)))
            generations = -(-budget // population)
        if population < SMALLEST_POPULATION or len(box.lower) < 2:
            raise StudyError(
                f"CMA-ES needs a population of at least {SMALLEST_POPULATION} and at least 2 dimensions, "
                f"got {population} and {len(box.lower)}"
            )
        centre = np.full(len(box.lower), 0.5)
        optimiser = self._optimiser(centre, population, rng)
        return _sampled(CMAState(box, box.at(centre)[None], generations, 0, box.at(centre), np.inf, optimiser, centre))

    def ask(self, state: CMAState, rng: np.random.Generator) -> CMAState:
        """Sample the next population, after a restart from a random mean where the package says so."""
        if state.optimiser.should_stop():
            mean = rng.random(len(state.box.lower))
            state = replace(state, optimiser=self._optimiser(mean, state.optimiser.population_size, rng))
        return _sampled(state)

    def tell(self, state: CMAState, values: Floats, rng: np.random.Generator) -> CMAState:
        """Adapt the distribution."""
        numbers = _random_numbers(state.optimiser)
        optimiser = _copied(state.optimiser, {id(numbers): numbers})  # drawn from in `ask` alone, which copies them
        optimiser.tell(list(zip(state.fractions, values.tolist(), strict=True)))
        return state.told(values, optimiser=optimiser)

    def _optimiser(self, mean: Floats, population: int, rng: np.random.Generator) -> Any:
        try:
            from study.search.cma_sampling import QuickCMA  # here: only this search needs the package
        except ModuleNotFoundError:
            raise StudyError("CMA-ES needs the Python package 'cmaes'; install it with pip") from None

        bounds = np.tile([0.0, 1.0], (len(mean), 1))
        seed = int(rng.integers(2**31))
        return QuickCMA(mean=mean, sigma=self.sigma, bounds=bounds, seed=seed, population_size=population)


def _random_numbers(optimiser: Any) -> np.random.RandomState:
    return next(part for part in vars(optimiser).values() if isinstance(part, np.random.RandomState))


def _copied(optimiser: Any, shared: dict[int, Any]) -> Any:
    """Copy the package's optimiser with its random numbers, which its own copying leaves out.

    Parameters
    ----------
    optimiser : cmaes.CMA
    shared : mapping of int to object
        Parts that both go on using, by their `id`.
    """
    copy = object.__new__(type(optimiser))
    copy.__dict__.update(deepcopy(vars(optimiser), shared))
    return copy


def _sampled(state: CMAState) -> CMAState:
    """Take the next population of the state's optimiser."""
    optimiser = _copied(state.optimiser, {})
    fractions = np.array([optimiser.ask() for _ in range(optimiser.population_size)])
    return replace(state, optimiser=optimiser, fractions=fractions, candidates=state.box.at(fractions))
