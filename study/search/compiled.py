"""Compiled variants of searches, with the same bits as NumPy; importing this file imports numba.

Only for steps in which NumPy is slow: many small arrays, and more numbers than the cache holds. `study.code_digest`
leaves this file out, because the same bits make the same results.
"""

from __future__ import annotations

from dataclasses import is_dataclass, replace
from typing import Any

import numpy as np

from study.curves.compiled.kernels import exact
from study.problem import Floats
from study.search.bounds import BoundsRule, Moved, population_bounds
from study.search.gsa import GSA
from study.search.population import PopulationState
from study.search.pso import SwarmState, VelocityUpdate, Weights, velocity_bounds
from study.search.sca import SCA
from study.search.state import Search

EPS = np.finfo(float).eps


def compiled_variant(search: Search[Any]) -> Search[Any]:
    """Search with compiled steps; the same search where no step is compiled."""
    if type(search) in VARIANTS:
        return VARIANTS[type(search)](**vars(search))
    if is_dataclass(search) and type(getattr(search, "velocity", None)) is VelocityUpdate:
        return replace(search, velocity=CompiledVelocityUpdate(**vars(search.velocity)))
    return search


class CompiledVelocityUpdate(VelocityUpdate):
    """Velocity update of one swarm that is clipped at its bounds, in one pass; other swarms are left to NumPy."""

    def moved(self, state: SwarmState, weights: Weights, draws: Floats) -> Moved:
        """See `study.search.pso.VelocityUpdate.moved`."""
        x = state.candidates
        if x.ndim > 2 or self.bounds != BoundsRule.CLIP:
            return super().moved(state, weights, draws)
        swarm = x, state.velocities, state.own_best, state.incumbent
        w, c1, c2 = weights
        ends = *velocity_bounds(self, state.box, x.shape), *population_bounds(state.box, x.shape)
        v, moved = np.empty(x.shape), np.empty(x.shape)
        _update(swarm, draws, (float(w), float(c1), float(c2)), ends, v, moved)
        return moved, v


@exact
def _update(
    swarm: tuple[Floats, Floats, Floats, Floats],
    draws: Floats,
    weights: tuple[float, float, float],
    ends: tuple[Floats, Floats, Floats, Floats],
    v: Floats,
    moved: Floats,
) -> None:
    x, velocities, own_best, incumbent = swarm
    w, c1, c2 = weights
    slowest, fastest, lower, upper = ends
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            at, own, best = x[i, j], own_best[i, j], incumbent[j]
            pull = w * velocities[i, j] + c1 * draws[0, i, j] * (own - at) + c2 * draws[1, i, j] * (best - at)
            v[i, j] = min(max(pull, slowest[i, j]), fastest[i, j])
            moved[i, j] = min(max(at + v[i, j], lower[i, j]), upper[i, j])


class CompiledGSA(GSA):
    """Gravitational search with one pass for each attracting mass."""

    @staticmethod
    def attraction(columns: Floats, pullers: Floats, masses: Floats, weights: Floats) -> Floats:
        """See `study.search.gsa.GSA.attraction`."""
        pull = np.zeros(columns.shape)
        _attract(columns, pullers, masses, weights, pull)
        return pull


@exact
def _attract(columns: Floats, pullers: Floats, masses: Floats, weights: Floats, pull: Floats) -> None:
    dimensions, n = columns.shape
    strength = np.empty(n)
    for k in range(len(pullers)):
        strength[:] = 0.0
        for j in range(dimensions):
            for i in range(n):
                apart = pullers[k, j] - columns[j, i]
                strength[i] += apart * apart
        for i in range(n):
            strength[i] = masses[k] / (np.sqrt(strength[i]) + EPS)
        for j in range(dimensions):
            for i in range(n):
                pull[j, i] += (pullers[k, j] - columns[j, i]) * weights[k, j, i] * strength[i]


class CompiledSCA(SCA):
    """Sine cosine algorithm for one population that is clipped at its bounds, in one pass; others are left to NumPy."""

    def moved(self, state: PopulationState, swing: Floats, r3: Floats) -> Floats:
        """See `study.search.sca.SCA.moved`."""
        x = state.members
        if x.ndim > 2 or self.bounds != BoundsRule.CLIP:
            return super().moved(state, swing, r3)
        moved = np.empty(x.shape)
        _swing(x, state.incumbent, swing, r3, population_bounds(state.box, x.shape), moved)
        return moved


@exact
def _swing(x: Floats, incumbent: Floats, swing: Floats, r3: Floats, ends: tuple[Floats, Floats], moved: Floats) -> None:
    lower, upper = ends
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            to = x[i, j] + swing[i, j] * abs(r3[i, j] * (2.0 * incumbent[j]) - x[i, j])
            moved[i, j] = min(max(to, lower[i, j]), upper[i, j])


VARIANTS: dict[type, type] = {GSA: CompiledGSA, SCA: CompiledSCA}
