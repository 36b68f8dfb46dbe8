"""Particle swarm optimisation, basic and standard.

References
----------
Woodworking paper, Eqs. (19)-(21); AUBO paper, Eq. (11); PUMA560 paper, Section 3.2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from study.problem import Floats
from study.search.bounds import bounded
from study.search.loop import Box, State


@dataclass(frozen=True, eq=False)
class SwarmState(State):
    """A population with velocities and every particle's own best; arrays of shape (n_candidates, n_dimensions)."""

    velocities: Floats
    own_best: Floats
    own_values: Floats

    def remembered(self, values: Floats) -> SwarmState:
        """Update own bests, Eq. (19) read as a comparison of fitness values, and the incumbent."""
        better = values < self.own_values
        incumbent, incumbent_value = self.improved(values)
        return replace(
            self,
            own_best=np.where(better[:, None], self.candidates, self.own_best),
            own_values=np.where(better, values, self.own_values),
            incumbent=incumbent,
            incumbent_value=incumbent_value,
            generation=self.generation + 1,
        )


def new_swarm(box: Box, positions: Floats, velocities: Floats, generations: int) -> SwarmState:
    """State of a swarm that has not been evaluated yet."""
    return SwarmState(
        box=box,
        candidates=positions,
        generations=generations,
        generation=0,
        incumbent=positions[0],
        incumbent_value=np.inf,
        velocities=velocities,
        own_best=positions,
        own_values=np.full(len(positions), np.inf),
    )


@dataclass(frozen=True)
class PSO:
    """Particle swarm with linear inertia and constant learning factors.

    Attributes
    ----------
    inertia : tuple of two floats
        Weight at the start and at the end; the papers' basic PSO keeps 1.
    cognitive, social : float
        Learning factors c1 and c2.
    clamp : float
        Largest velocity as a share of the box's width.
    bounds : str
        A rule of `study.search.bounds`.
    """

    inertia: tuple[float, float] = (0.9, 0.4)
    cognitive: float = 2.0
    social: float = 2.0
    clamp: float = 0.2
    bounds: str = "clip"

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> SwarmState:
        """Spread particles uniformly, at rest."""
        positions = box.at(rng.random((population, len(box.lower))))
        return new_swarm(box, positions, np.zeros_like(positions), generations)

    def ask(self, state: SwarmState, rng: np.random.Generator) -> SwarmState:
        """Move every particle."""
        w = self.inertia[0] + (self.inertia[1] - self.inertia[0]) * state.progress
        return moved(state, rng, (w, self.cognitive, self.social), self.clamp * state.box.width, self.bounds)

    def tell(self, state: SwarmState, values: Floats, rng: np.random.Generator) -> SwarmState:
        """Remember what was better."""
        return state.remembered(values)


def moved(
    state: SwarmState, rng: np.random.Generator, weights: tuple[float, float, float], clamp: Floats, bounds: str
) -> SwarmState:
    """Velocity and position update shared by the velocity-based swarms.

    Parameters
    ----------
    state : SwarmState
    rng : numpy.random.Generator
    weights : inertia w and learning factors c1, c2
    clamp : array of shape (n_dimensions,)
        Largest velocity, in the unit of the positions per generation.
    bounds : str
    """
    w, c1, c2 = weights
    x = state.candidates
    r1, r2 = rng.random((2, *x.shape))
    v = w * state.velocities + c1 * r1 * (state.own_best - x) + c2 * r2 * (state.incumbent - x)  # eq. (20)
    v = np.clip(v, -clamp, clamp)
    x, v = bounded(bounds, state.box, x + v, v)  # eq. (21)
    return replace(state, candidates=x, velocities=v)
