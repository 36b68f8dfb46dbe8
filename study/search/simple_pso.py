"""Simple PSO: a swarm without velocities (SPSO of the woodworking paper, not that of the PUMA560 paper).

The update multiplies the position itself by the inertia, so the swarm contracts towards the origin of the coordinates
whatever the objective is: most of its accuracy on benchmark functions is the product of its inertias.

References
----------
Woodworking paper, Eq. (22); Hu and Li 2007.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from study.search.batched_rng import Rng
from study.search.bounds import BoundsRule, bounded_positions
from study.search.pso import Swarm, SwarmState, linear
from study.search.state import evolved

W = TypeVar("W", bound=SwarmState)


def contracted(state: W, rng: Rng, weights: tuple[float, float, float], bounds: BoundsRule) -> W:
    """Position update without velocity, Eq. (22), with weights w, c1, c2."""
    w, c1, c2 = weights
    x = state.candidates
    r1, r2 = rng.random((2, *x.shape[-2:]))
    x = w * x + c1 * r1 * (state.own_best - x) + c2 * r2 * (state.incumbent - x)  # eq. (22)
    return evolved(state, candidates=bounded_positions(bounds, state.box, x))


@dataclass(frozen=True)
class SimplePSO(Swarm):
    """Swarm without velocities.

    Attributes
    ----------
    inertia : tuple of two floats
        Weight w at the start and at the end. The woodworking paper prints none; Hu and Li let it fall; a constant 0.8
        explains the paper's Table 3.
    cognitive, social : float
        Learning factors c1 and c2; 2 after Hu and Li.
    bounds : BoundsRule
        A rule of `study.search.bounds`; `clip` after Step 5 of the woodworking paper's Section 2.4.3.
    """

    inertia: tuple[float, float] = (0.9, 0.4)
    cognitive: float = 2.0
    social: float = 2.0
    bounds: BoundsRule = BoundsRule.CLIP

    def ask(self, state: SwarmState, rng: Rng) -> SwarmState:
        """Move every particle."""
        weights = linear(self.inertia, state.progress), self.cognitive, self.social
        return contracted(state, rng, weights, self.bounds)
