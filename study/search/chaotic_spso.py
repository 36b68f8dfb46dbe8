"""Chaotic particle swarm, the PUMA560 paper's SPSO: chaotic start, two-stage inertia, asynchronous learning factors.

Not the velocity-free SPSO of the woodworking paper. As printed the inertia is below 1e-6
from the first move until 60 % of the generations are over, then it jumps to about 0.5; the text says that it decreases.
With a uniform start, fixed learning factors and the `standard` reading what remains is `PSO`, candidate by candidate.

References
----------
PUMA560 paper, Sections 3.2, 3.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.choices import Options
from study.search.batched_rng import Rng
from study.search.chaos import MAPS, chaotic_population
from study.search.pso import Scalars, Swarm, SwarmState, VelocityUpdate, linear, moved_swarm, swarm_at_rest
from study.search.reading import PaperReading
from study.search.state import Box, uniform_population

VELOCITY = VelocityUpdate()


@dataclass(frozen=True)
class ChaoticSPSO(Swarm, Options):
    """Particle swarm with three switchable novelties.

    Attributes
    ----------
    inertia : tuple of two floats
        w_max and w_min of Section 3.3.2. Ours: the paper prints no values.
    exponents : tuple of two floats
        alpha and beta (Section 3.3.2), used by the printed inertia.
    stage : float
        Share of the generations after which the printed inertia changes its branch (Section 3.3.2).
    cognitive, social : tuple of two floats
        c1 and c2 at the start and at the end (Section 3.3.2).
    chaotic_start : bool
        Start from the sine-tent-cosine map (Section 3.3.1).
    asynchronous : bool
        Let c1 fall and c2 grow; otherwise both are `fixed`.
    fixed : float
        Learning factor without asynchrony. Ours: the textbook's 2.
    velocity : VelocityUpdate
        Clamp and bounds rule. Ours: the paper prints neither.
    reading : PaperReading
        `standard`: the inertia falls linearly from w_max to w_min. `as-printed`: the two branches.

    Raises
    ------
    StudyError
        If there is no such reading.
    """

    inertia: tuple[float, float] = (0.9, 0.4)
    exponents: tuple[float, float] = (3.0, 5.0)
    stage: float = 0.6
    cognitive: tuple[float, float] = (2.5, 0.5)
    social: tuple[float, float] = (0.5, 2.5)
    chaotic_start: bool = True
    asynchronous: bool = True
    fixed: float = 2.0
    velocity: VelocityUpdate = VELOCITY
    reading: PaperReading = PaperReading.STANDARD

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> SwarmState:
        """Spread particles by the map, or uniformly; at rest."""
        if self.chaotic_start:
            positions = chaotic_population(MAPS["sine-tent-cosine"], box, population, rng)
        else:
            positions = uniform_population(box, population, rng)
        return swarm_at_rest(box, positions, generations)

    def printed_inertia(self, t: int, total: int, rng: Rng) -> Scalars:
        """Inertia of Section 3.3.2 to the letter; the second branch draws one number per generation."""
        alpha, beta = self.exponents
        if t <= self.stage * total:
            return (alpha * t**alpha + beta * t**beta) / total / ((t + 1.0) ** (alpha + beta)) ** 3
        return self.inertia[0] - self.inertia[1] + 0.1 * rng.random()

    def ask(self, state: SwarmState, rng: Rng) -> SwarmState:
        """Move every particle, Section 3.2."""
        w: Scalars
        if self.reading is PaperReading.AS_PRINTED:
            w = self.printed_inertia(state.generation, state.generations, rng)
        else:
            w = linear(self.inertia, state.progress)
        c1, c2 = self.fixed, self.fixed
        if self.asynchronous:
            c1, c2 = linear(self.cognitive, state.progress), linear(self.social, state.progress)
        return moved_swarm(state, rng, (w, c1, c2), self.velocity)
