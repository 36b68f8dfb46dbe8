"""Dynamic adaptive particle swarm: inertia and learning factors that change with the generation.

As printed the inertia *grows*, c1 is a constant (it holds 1/N where n/N must be meant), and the swarm starts above the
box. The `standard` reading mends these three and nothing else.

References
----------
AUBO paper, Eqs. (11)-(15), Section 4.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.choices import Options
from study.search.batched_rng import Rng
from study.search.pso import ClampUnit, Swarm, SwarmState, VelocityUpdate, linear, moved_swarm, new_swarm
from study.search.reading import PaperReading
from study.search.state import Box

VELOCITY = VelocityUpdate(clamp=4.0, unit=ClampUnit.ABSOLUTE)  # Section 4.3


@dataclass(frozen=True)
class DynamicAdaptivePSO(Swarm, Options):
    """Particle swarm with scheduled inertia and learning factors.

    Attributes
    ----------
    inertia : tuple of two floats
        w_max and w_min (Section 4.3).
    learning : tuple of two floats
        c_max and c_min (Section 4.3).
    one_number : bool
        Eq. (15) draws one number per particle, so all start on a diagonal of the box; without it, one per coordinate.
    velocity : VelocityUpdate
        Velocities within [-4, 4] (Section 4.3), twice the width of the paper's box; the bounds rule is ours.
    reading : PaperReading
        `standard`: w falls, c1 falls from c_max to c_min. `as-printed`: w grows, c1 stays next to c_min.
    start_inside : bool
        Positions start inside the box; Eq. (15) to the letter puts all of them one width above it.

    Raises
    ------
    StudyError
        If there is no such reading.
    """

    inertia: tuple[float, float] = (0.9, 0.1)
    learning: tuple[float, float] = (2.5, 1.5)
    one_number: bool = True
    velocity: VelocityUpdate = VELOCITY
    reading: PaperReading = PaperReading.STANDARD
    start_inside: bool = True

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> SwarmState:
        """Start as in Eq. (15), with velocities in [0, 1)."""
        dimensions = len(box.lower)
        fractions = rng.random((population, 1 if self.one_number else dimensions))
        start = box.lower if self.start_inside else box.upper
        positions = start + fractions * box.width  # eq. (15)
        return new_swarm(box, positions, rng.random((population, dimensions)), generations)

    def weights(self, state: SwarmState) -> tuple[float, float, float]:
        """Inertia w and learning factors c1, c2 of the generation to come."""
        w_max, w_min = self.inertia
        c_max, c_min = self.learning
        n, total = state.generation, state.generations
        c2 = c_min + (c_max - c_min) * np.sin(np.pi / 2 * n / total)  # eq. (14)
        if self.reading is PaperReading.AS_PRINTED:
            c1 = c_max - (c_max - c_min) * np.sin(np.pi / 2 * (1 - 1 / total)) ** 2  # eq. (14), to the letter
            return linear((w_min, w_max), n / total), c1, c2  # eq. (13), to the letter
        c1 = c_max - (c_max - c_min) * np.sin(np.pi / 2 * n / total) ** 2
        return linear((w_max, w_min), n / total), c1, c2

    def ask(self, state: SwarmState, rng: Rng) -> SwarmState:
        """Move every particle, Eq. (11)."""
        return moved_swarm(state, rng, self.weights(state), self.velocity)
