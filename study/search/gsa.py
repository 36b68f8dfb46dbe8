"""Gravitational search algorithm (GSA).

References
----------
UR5 paper on SMWOA, Table 3, which names it and gives no equation; Rashedi, Nezamabadi-pour and Saryazdi (2009), whose
equation numbers stand beside the lines.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from study.problem import Floats
from study.search.bounds import BoundsRule, bounded
from study.search.population import PopulationState, normalised_fitness, spread_population
from study.search.state import Box, evolved

AT_ONCE = 32
"""Pullers taken together: the arrays for a hundred masses in five dimensions then stay in cache, 128 KB each."""

WEIGHTS = 2.0**32
"""Bound of the random weights; see `half_words`."""


@dataclass(frozen=True, eq=False)
class GravityState(PopulationState):
    """A population with velocities, shape (n_candidates, n_dimensions)."""

    velocities: Floats


@dataclass(frozen=True)
class GSA:
    """Gravitational search: masses attract one another, the better the heavier; fewer and fewer of them pull.

    Attributes
    ----------
    gravity : float
        Gravitational constant G0 at the start; 100 in the algorithm's own paper.
    decay : float
        Rate alpha of its decay; 20 in the algorithm's own paper.
    last_pullers : float
        Share of the population that still pulls in the end; 2 % in the circulated code.
    bounds : BoundsRule
        A rule of `study.search.bounds`; ours.
    """

    gravity: float = 100.0
    decay: float = 20.0
    last_pullers: float = 0.02
    bounds: BoundsRule = BoundsRule.CLIP

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> GravityState:
        """Spread masses uniformly, at rest."""
        state = spread_population(box, population, generations, rng)
        return GravityState(**vars(state), velocities=np.zeros_like(state.members))

    def ask(self, state: GravityState, rng: np.random.Generator) -> GravityState:
        """Accelerate and move every mass."""
        x = state.members
        g = self.gravity * math.exp(-self.decay * state.progress)  # eq. (28)
        v = rng.random(x.shape) * state.velocities + g * self._pull(state, rng)  # eq. (11)
        x, v = bounded(self.bounds, state.box, x + v, v)  # eq. (12)
        return evolved(state, candidates=x, velocities=v)

    def tell(self, state: GravityState, values: Floats, rng: np.random.Generator) -> GravityState:
        """Take the new positions, better or not."""
        return state.replaced(values)

    def _pull(self, state: GravityState, rng: np.random.Generator) -> Floats:
        """Acceleration of every mass for G = 1, Eqs. (7)-(10), (21); its own mass has cancelled out."""
        x = state.members
        m = 1.0 - normalised_fitness(state.values)  # eq. (15)
        total = np.add.reduce(m)
        masses = m / total if total > 0.0 else np.full(len(x), 1.0 / len(x))  # eq. (16)
        share = self.last_pullers + (1.0 - state.progress) * (1.0 - self.last_pullers)
        heavy = np.argsort(-masses, kind="stable")[: max(1, round(share * len(x)))]
        columns, pull = x.T.copy(), np.zeros(x.shape[::-1])
        for pullers in (heavy[k : k + AT_ONCE] for k in range(0, len(heavy), AT_ONCE)):
            weights = half_words(rng, (len(pullers), *columns.shape))
            pull += self.attraction(columns, x[pullers], masses[pullers] / WEIGHTS, weights)
        return pull.T

    @staticmethod
    def attraction(columns: Floats, pullers: Floats, masses: Floats, weights: Floats) -> Floats:
        """Sum of the pulls on every mass, each along the line to its puller and as strong as the puller's mass.

        Parameters
        ----------
        columns : array of shape (n_dimensions, n_candidates)
            Where the masses are: the long rows are the inner ones.
        pullers : array of shape (n_pullers, n_dimensions)
        masses : array of shape (n_pullers,)
        weights : array of shape (n_pullers, n_dimensions, n_candidates)
            Uniform integers below 2^32, random weights of Eq. (9); `masses` are pre-divided by 2^32.

        Returns
        -------
        array of shape (n_dimensions, n_candidates)
        """
        pulls = pullers[:, :, None] - columns
        distances = np.sqrt((pulls * pulls).sum(axis=1)) + np.finfo(float).eps  # eq. (8)
        pulls *= weights
        pulls *= (masses[:, None] / distances)[:, None]
        return pulls.sum(axis=0)


def half_words(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """Uniform integers below 2^32, two from every 64-bit number of the generator, whose numbers are most of the cost.

    Returns
    -------
    uint32 array of that shape
    """
    n = math.prod(shape)
    pairs = rng.integers(2**64 - 1, size=-(-n // 2), dtype=np.uint64, endpoint=True)
    return pairs.view(np.uint32)[:n].reshape(shape)
