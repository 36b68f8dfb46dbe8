"""Sine cosine algorithm (SCA).

References
----------
PUMA560 paper, Table 3, which names it and gives no equation; Mirjalili (2016), whose equation numbers stand beside the
lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.problem import Floats
from study.search.batched_rng import Rng
from study.search.bounds import BoundsRule, bounded_positions
from study.search.population import Generational, PopulationState
from study.search.state import BatchedSearch, evolved


@dataclass(frozen=True)
class SCA(Generational, BatchedSearch[PopulationState]):
    """Sine cosine algorithm: members swing around the incumbent by a sine or a cosine of falling amplitude.

    Attributes
    ----------
    amplitude : float
        a, from which the amplitude r1 falls to 0; 2 in the algorithm's own paper.
    bounds : BoundsRule
        A rule of `study.search.bounds`; ours.
    """

    amplitude: float = 2.0
    bounds: BoundsRule = BoundsRule.CLIP

    def ask(self, state: PopulationState, rng: Rng) -> PopulationState:
        """Move every member."""
        x = state.members
        r1 = self.amplitude * (1.0 - state.progress)  # eq. (3.4)
        r2, r3, r4 = rng.random((3, *x.shape[-2:]))
        quarters = 4.0 * r2 + np.rint(r4)  # of a turn: r4 from a half on adds one, which makes the sine a cosine
        return evolved(state, candidates=self.moved(state, r1 * np.sin(0.5 * np.pi * quarters), r3))

    def moved(self, state: PopulationState, swing: Floats, r3: Floats) -> Floats:
        """Swing every member towards the incumbent or away from it, Eq. (3.3).

        Parameters
        ----------
        state : PopulationState
        swing, r3 : arrays of the members' shape
            Amplitude times sine or cosine, and the random weight of the incumbent.
        """
        x = state.members
        return bounded_positions(self.bounds, state.box, x + swing * np.abs(r3 * (2.0 * state.incumbent) - x))
