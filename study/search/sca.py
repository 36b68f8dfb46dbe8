"""Sine cosine algorithm.

References
----------
PUMA560 paper, Table 3, which names it and gives no equation; Mirjalili (2016), whose equation numbers stand beside the
lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.problem import Floats
from study.search.bounds import brought_back
from study.search.draws import Rng
from study.search.loop import Box, SideBySide, evolved
from study.search.population import PopulationState, spread_population


@dataclass(frozen=True)
class SCA(SideBySide):
    """Members swing around the incumbent by a sine or a cosine of falling amplitude.

    Attributes
    ----------
    amplitude : float
        a, from which the amplitude r1 falls to 0; 2 in the algorithm's own paper.
    bounds : str
        A rule of `study.search.bounds`; ours.
    """

    amplitude: float = 2.0
    bounds: str = "clip"

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> PopulationState:
        """Spread members uniformly."""
        return spread_population(box, population, generations, rng)

    def ask(self, state: PopulationState, rng: Rng) -> PopulationState:
        """Move every member."""
        x = state.members
        r1 = self.amplitude * (1.0 - state.progress)  # eq. (3.4)
        r2, r3, r4 = rng.random((3, *x.shape[-2:]))
        swing = np.cos(2.0 * np.pi * r2 - 0.5 * np.pi * (r4 < 0.5))  # a quarter turn makes the cosine a sine
        moved = x + r1 * swing * np.abs(2.0 * r3 * state.incumbent - x)  # eq. (3.3)
        return evolved(state, candidates=brought_back(self.bounds, state.box, moved))

    def tell(self, state: PopulationState, values: Floats, rng: Rng) -> PopulationState:
        """Take the new positions, better or not."""
        return state.replaced(values)
