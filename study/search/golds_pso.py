"""Golden sine particle swarm (GoldS-PSO): simple PSO, circle-map start, S-curve inertia and golden-sine update.

Each of the three can be switched off by itself; without them what remains is `SimplePSO`, candidate by candidate.

References
----------
Woodworking paper, Section 2.4, Eqs. (22)-(30).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.choices import Options
from study.problem import Floats
from study.search.bounds import BoundsRule, bounded_positions
from study.search.chaos import MAPS, chaotic_population
from study.search.gold_sa import GoldState, Sections, golden_angles
from study.search.pso import SwarmState, linear, swarm_at_rest
from study.search.reading import PaperReading
from study.search.simple_pso import contracted
from study.search.state import Box, evolved, uniform_population


@dataclass(frozen=True, eq=False)
class GoldenSwarmState(GoldState, SwarmState):
    """A swarm and the golden-section coefficients."""


def s_curve(ends: tuple[float, float], progress: float) -> float:
    """Inertia that falls along a tanh, Eq. (24); from `ends[0]` to `ends[1]` within 2 % of their difference."""
    return ends[1] + (ends[0] - ends[1]) * (1 + np.tanh(2 - 4 * progress)) / 2  # eq. (24)


@dataclass(frozen=True)
class GoldSPSO(Options):
    """Particle swarm with golden-sine moves.

    Attributes
    ----------
    inertia : tuple of two floats
        w_max and w_min of Eq. (24). Ours: the paper prints no values.
    cognitive, social : float
        Learning factors c1 and c2. Ours: not printed; 1.5 to 2 fits the paper's Table 3.
    acceleration : float
        Factor lambda of Eq. (30), part of the golden-sine update. Ours: not printed; 0.5 fits Table 3, 0.9 does not;
        0.7298 with c = 1.49445, after Clerc and Kennedy whom the paper cites for it, fits as well.
    circle_start, s_curve_inertia, golden_sine : bool
        The paper's three strategies: Sections 2.4.1, 2.4.2, 2.4.3. Without them the start is uniform, the inertia falls
        linearly, and positions follow Eq. (22).
    reading : PaperReading
        `standard`: x1 and x2 step after every evaluation as in Gold-SA. `as-printed`: they keep Eqs. (26), (27).
    per_dimension, linked : bool
        As in `GoldSA`.
    bounds : BoundsRule
        A rule of `study.search.bounds`; `clip` is Step 5 of Section 2.4.3.

    Raises
    ------
    StudyError
        If there is no such reading.
    """

    inertia: tuple[float, float] = (0.9, 0.4)
    cognitive: float = 2.0
    social: float = 2.0
    acceleration: float = 0.5
    circle_start: bool = True
    s_curve_inertia: bool = True
    golden_sine: bool = True
    reading: PaperReading = PaperReading.STANDARD
    per_dimension: bool = False
    linked: bool = False
    bounds: BoundsRule = BoundsRule.CLIP

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> GoldenSwarmState:
        """Spread particles by the circle map, Eq. (23), or uniformly."""
        if self.circle_start:
            positions = chaotic_population(MAPS["circle"], box, population, rng)
        else:
            positions = uniform_population(box, population, rng)
        sections = (Sections.printed if self.reading is PaperReading.AS_PRINTED else Sections.of)(-np.pi, np.pi)
        swarm = swarm_at_rest(box, positions, generations)
        return GoldenSwarmState(**vars(swarm), sections=sections)

    def ask(self, state: GoldenSwarmState, rng: np.random.Generator) -> GoldenSwarmState:
        """Move every particle."""
        w = (s_curve if self.s_curve_inertia else linear)(self.inertia, state.progress)
        if not self.golden_sine:
            return contracted(state, rng, (w, self.cognitive, self.social), self.bounds)
        x, s, c1, c2 = state.candidates, state.sections, self.cognitive, self.social
        r1, r2 = golden_angles(x.shape, self.per_dimension, self.linked, rng)
        own = c1 * np.abs(np.sin(r1)) * (state.own_best - x)
        pull = c2 * r2 * np.sin(r1) * np.abs(s.x1 * state.incumbent - s.x2 * x)
        x = self.acceleration * (w * x + own - pull)  # eq. (30)
        return evolved(state, candidates=bounded_positions(self.bounds, state.box, x))

    def tell(self, state: GoldenSwarmState, values: Floats, rng: np.random.Generator) -> GoldenSwarmState:
        """Remember what was better and step the golden sections."""
        sections = state.sections
        if self.golden_sine and self.reading is PaperReading.STANDARD:
            sections = state.stepped(values, rng)
        return evolved(state.remembered(values), sections=sections)
