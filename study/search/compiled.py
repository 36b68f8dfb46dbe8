"""Compiled twins of what moves candidates: the same numbers to the last bit; importing this file imports numba.

For the steps that NumPy is slow at: many small arrays, and more numbers than the cache holds.
"""

from __future__ import annotations

from dataclasses import is_dataclass, replace
from typing import Any

import numpy as np

from study.curves.kernels import exact
from study.problem import Floats
from study.search.bounds import Moved, walls
from study.search.gsa import GSA
from study.search.loop import Search
from study.search.population import PopulationState
from study.search.pso import Flight, SwarmState, Weights, clamps
from study.search.sca import SCA

EPS = np.finfo(float).eps


def twin(search: Search[Any]) -> Search[Any]:
    """Give a search its compiled steps; one without any comes back as it is."""
    if type(search) in OWN:
        return OWN[type(search)](**vars(search))
    if is_dataclass(search) and type(getattr(search, "flight", None)) is Flight:
        return replace(search, flight=CompiledFlight(**vars(search.flight)))
    return search


class CompiledFlight(Flight):
    """Moves one swarm that is clipped at the walls in one pass; leaves others to NumPy."""

    def moved(self, state: SwarmState, weights: Weights, draws: Floats) -> Moved:
        """See `study.search.pso.Flight.moved`."""
        x = state.candidates
        if x.ndim > 2 or self.bounds != "clip":
            return super().moved(state, weights, draws)
        swarm = x, state.velocities, state.own_best, state.incumbent
        w, c1, c2 = weights
        ends = *clamps(self, state.box, x.shape), *walls(state.box, x.shape)
        v, moved = np.empty(x.shape), np.empty(x.shape)
        _fly(swarm, draws, (float(w), float(c1), float(c2)), ends, v, moved)
        return moved, v


@exact
def _fly(
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
    """Pulls masses with one pass for each puller."""

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
    """Swings one population that is clipped at the walls in one pass; leaves others to NumPy."""

    def moved(self, state: PopulationState, swing: Floats, r3: Floats) -> Floats:
        """See `study.search.sca.SCA.moved`."""
        x = state.members
        if x.ndim > 2 or self.bounds != "clip":
            return super().moved(state, swing, r3)
        moved = np.empty(x.shape)
        _swing(x, state.incumbent, swing, r3, walls(state.box, x.shape), moved)
        return moved


@exact
def _swing(x: Floats, incumbent: Floats, swing: Floats, r3: Floats, ends: tuple[Floats, Floats], moved: Floats) -> None:
    lower, upper = ends
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            to = x[i, j] + swing[i, j] * abs(r3[i, j] * (2.0 * incumbent[j]) - x[i, j])
            moved[i, j] = min(max(to, lower[i, j]), upper[i, j])


OWN: dict[type, type] = {GSA: CompiledGSA, SCA: CompiledSCA}
