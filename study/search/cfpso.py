"""Particle swarm with a constriction factor (CFPSO).

References
----------
Woodworking paper, Section 2.5 (named, not printed); Clerc and Kennedy 2002.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.errors import StudyError
from study.search.batched_rng import Rng
from study.search.pso import Swarm, SwarmState, VelocityUpdate, moved_swarm

VELOCITY = VelocityUpdate(clamp=0.5)


def constriction(phi: float) -> float:
    """Constriction factor chi for phi = c1 + c2 > 4 (Clerc and Kennedy 2002): 0.7298 for phi = 4.1."""
    return 2.0 / abs(2.0 - phi - np.sqrt(phi * phi - 4.0 * phi))


@dataclass(frozen=True)
class CFPSO(Swarm):
    """Particle swarm whose whole velocity is multiplied by the constriction factor.

    Attributes
    ----------
    cognitive, social : float
        Learning factors c1 and c2; 2.05 after Clerc and Kennedy. Their sum must exceed 4.
    inertia_only : bool
        Apply the factor to the old velocity alone: no algorithm of that name, yet it explains the woodworking paper's
        Table 3 (with an absolute clamp of 3).
    velocity : VelocityUpdate
        Clamp and bounds rule; half the box's width after Eberhart and Shi 2000, `clip` is ours. Without a clamp, `clip`
        traps coordinates on the bounds of a 30-dimensional box.

    Raises
    ------
    StudyError
        If the learning factors are too small for a constriction.
    """

    cognitive: float = 2.05
    social: float = 2.05
    inertia_only: bool = False
    velocity: VelocityUpdate = VELOCITY

    def __post_init__(self) -> None:
        if self.cognitive + self.social <= 4:
            raise StudyError(
                f"CFPSO needs learning factors whose sum exceeds 4, got {self.cognitive:g} and {self.social:g}; "
                "2.05 each is usual"
            )

    def ask(self, state: SwarmState, rng: Rng) -> SwarmState:
        """Move every particle."""
        chi = constriction(self.cognitive + self.social)
        pull = 1.0 if self.inertia_only else chi
        return moved_swarm(state, rng, (chi, pull * self.cognitive, pull * self.social), self.velocity)
