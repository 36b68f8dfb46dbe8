"""Particle swarm optimisation (PSO): swarm state, velocity update with a velocity clamp, and the plain algorithm.

References
----------
Woodworking paper, Eqs. (19)-(21); AUBO paper, Eq. (11); PUMA560 paper, Section 3.2. Kennedy and Eberhart 1995.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Self

import numpy as np

from study.choices import Choice, Options
from study.problem import Floats
from study.search.batched_rng import Rng
from study.search.bounds import BoundsRule, Moved, bounded
from study.search.state import BatchedSearch, Box, State, evolved, uniform_population

Scalars = Floats | float
"""A number of one run, or of each of several batched runs, shape (n_runs, 1, 1)."""

Weights = tuple[Scalars, Scalars, Scalars]


@dataclass(frozen=True, eq=False)
class SwarmState(State):
    """Swarm whose particles remember their own best positions.

    Attributes
    ----------
    own_best : array of shape (n_candidates, n_dimensions)
    own_values : array of shape (n_candidates,)
    velocities : array of shape (n_candidates, n_dimensions)
        Per generation; zeros in a swarm without velocities.
    """

    own_best: Floats
    own_values: Floats
    velocities: Floats

    def remembered(self, values: Floats) -> Self:
        """Update own bests, Eq. (19) read as a comparison of fitness values, and the incumbent."""
        better = values < self.own_values
        return self.told(
            values,
            own_best=np.where(better[..., None], self.candidates, self.own_best),
            own_values=np.where(better, values, self.own_values),
        )


def new_swarm(box: Box, positions: Floats, velocities: Floats, generations: int) -> SwarmState:
    """State of a swarm that has not been evaluated yet; positions and velocities have the population's shape."""
    own_values = np.full(len(positions), np.inf)
    return SwarmState.new(box, positions, generations, own_best=positions, own_values=own_values, velocities=velocities)


def swarm_at_rest(box: Box, positions: Floats, generations: int) -> SwarmState:
    """State of a new swarm without velocity."""
    return new_swarm(box, positions, np.zeros_like(positions), generations)


def linear(ends: tuple[float, float], progress: float) -> float:
    """Linear schedule: from one number to another in proportion to the progress of the search."""
    return ends[0] + (ends[1] - ends[0]) * progress


class ClampUnit(Choice):
    """Unit of a velocity clamp: that of the positions, or a share of the box's width."""

    ABSOLUTE = "absolute"
    SHARE = "share"


@dataclass(frozen=True)
class VelocityUpdate(Options):
    """Velocity and position update with a velocity clamp and a bounds rule.

    Attributes
    ----------
    clamp : float
        Largest velocity per generation and coordinate; infinity for none.
    unit : ClampUnit
    bounds : BoundsRule
        A rule of `study.search.bounds`.

    Raises
    ------
    StudyError
        If there is no such unit.
    """

    clamp: float = 0.2
    unit: ClampUnit = ClampUnit.SHARE
    bounds: BoundsRule = BoundsRule.CLIP

    def clamped(self, box: Box, velocities: Floats) -> Floats:
        """Cut velocities off at the clamp."""
        slowest, fastest = velocity_bounds(self, box, velocities.shape)
        return np.minimum(np.maximum(velocities, slowest), fastest)

    def moved(self, state: SwarmState, weights: Weights, draws: Floats) -> Moved:
        """Positions and velocities of the next generation.

        Parameters
        ----------
        state : SwarmState
        weights : inertia w and learning factors c1, c2
        draws : array of shape (2, n_candidates, n_dimensions)
            Uniform random numbers.

        References
        ----------
        Woodworking paper, Eqs. (20), (21).
        """
        w, c1, c2 = weights
        x, (r1, r2) = state.candidates, draws
        v = w * state.velocities + c1 * r1 * (state.own_best - x) + c2 * r2 * (state.incumbent - x)  # eq. (20)
        v = self.clamped(state.box, v)
        return bounded(self.bounds, state.box, x + v, v)  # eq. (21)


@lru_cache(maxsize=8)
def velocity_bounds(velocity: VelocityUpdate, box: Box, shape: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Least and greatest velocities repeated for a population of that shape, as `population_bounds`."""
    limit = np.broadcast_to(velocity.clamp * box.width if velocity.unit is ClampUnit.SHARE else velocity.clamp, shape)
    return -limit, limit.copy()


def moved_swarm(state: SwarmState, rng: Rng, weights: Weights, velocity: VelocityUpdate) -> SwarmState:
    """Move every particle of a swarm by its velocity; see `VelocityUpdate.moved`."""
    draws = rng.random((2, *state.candidates.shape[-2:]))
    x, v = velocity.moved(state, weights, draws)
    return evolved(state, candidates=x, velocities=v)


class Swarm(BatchedSearch[SwarmState]):
    """Swarm search whose particles start uniformly, at rest, and remember their own best positions."""

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> SwarmState:
        """Spread particles uniformly, at rest."""
        return swarm_at_rest(box, uniform_population(box, population, rng), generations)

    def tell(self, state: SwarmState, values: Floats, rng: Rng) -> SwarmState:
        """Remember what was better."""
        return state.remembered(values)


@dataclass(frozen=True)
class PSO(Swarm):
    """Particle swarm with linear inertia and constant learning factors.

    The defaults are the textbook's; no paper prints a complete set. The papers' basic PSO keeps the inertia at 1.

    Attributes
    ----------
    inertia : tuple of two floats
        Weight w at the start and at the end (Shi and Eberhart 1998).
    cognitive, social : float
        Learning factors c1 and c2 (Kennedy and Eberhart 1995).
    velocity : VelocityUpdate
        Clamp and bounds rule; 0.2 of the box's width and `clip` are ours.
    """

    inertia: tuple[float, float] = (0.9, 0.4)
    cognitive: float = 2.0
    social: float = 2.0
    velocity: VelocityUpdate = VelocityUpdate()

    def ask(self, state: SwarmState, rng: Rng) -> SwarmState:
        """Move every particle."""
        w = linear(self.inertia, state.progress)
        return moved_swarm(state, rng, (w, self.cognitive, self.social), self.velocity)
