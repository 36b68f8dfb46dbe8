"""Sooty tern optimisation algorithm (STOA), called swallow tern algorithm in the PUMA560 paper.

References
----------
PUMA560 paper, Table 3, which names it and gives no equation. The form here is that of the widely circulated code, which
fits all six functions of the table; the equations of Dhiman and Kaur (2019) miss it by four to seven orders.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.search.batched_rng import Rng
from study.search.bounds import BoundsRule, bounded_positions
from study.search.population import Generational, PopulationState
from study.search.state import BatchedSearch, evolved


@dataclass(frozen=True)
class STOA(Generational, BatchedSearch[PopulationState]):
    """Sooty tern optimisation: terns shrink their position, drift towards the incumbent and spiral around it.

    Attributes
    ----------
    control : float
        Value of Sa at the start, from which it falls to 0; 2 in the circulated code.
    spiral : float
        Shape b of the spiral; 1 in the circulated code.
    bounds : BoundsRule
        A rule of `study.search.bounds`; `clip` in the circulated code.
    """

    control: float = 2.0
    spiral: float = 1.0
    bounds: BoundsRule = BoundsRule.CLIP

    def ask(self, state: PopulationState, rng: Rng) -> PopulationState:
        """Move every tern; its distance from the spiral's centre contains its own position, a pull to the origin."""
        x, best = state.members, state.incumbent
        sa = self.control * (1.0 - state.progress)
        drift = sa * (rng.random(x.shape[-2:]) - 1.0)  # 2 Sa r - Sa with r in [0, 0.5]
        turn = 1.0 + (sa - 1.0) * rng.random(x.shape[-2:])
        distance = sa * x + drift * (best - x)
        moved = distance * np.exp(self.spiral * turn) * np.cos(2.0 * np.pi * turn) + best
        return evolved(state, candidates=bounded_positions(self.bounds, state.box, moved))
