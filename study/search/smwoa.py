"""Slime mould whale optimisation algorithm (SMWOA): WOA with SMA's convergence factor and fitness weight.

References
----------
UR5 paper on SMWOA, Section 3, Eqs. (12)-(15).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.problem import Floats
from study.search.bounds import bounded_positions
from study.search.population import PopulationState, check_share
from study.search.reading import PaperReading
from study.search.sma import Restart, approach_probability, arctanh_factor, feedback, fitness_weights, restarted
from study.search.state import evolved
from study.search.woa import WOA, WhaleDraws, whale_moves


@dataclass(frozen=True)
class SMWOA(WOA):
    """Whales with the slime mould's factor a, oscillation v_b and weight omega.

    With `arctanh`, `weighted` and `oscillating` off it is WOA, number for number.

    Attributes
    ----------
    reading : PaperReading
        `as-printed` takes Eq. (15), where D'' repeats D' and so uses the incumbent; `standard` puts the random whale of
        Eq. (7) there, weighted by omega.
    arctanh : bool
        a = arctanh(1 - t / t_max), Eq. (15), instead of 2 - 2 t / t_max. t counts from 1.
    weighted : bool
        The weight omega of Eq. (11) in D' and D''; otherwise 1 and C.
    oscillating : bool
        The factor v_b in Eq. (13), undefined in the paper; uniform in [-a, a] as in SMA.
    restart_share : float
        SMA's probability z of a restart; ours: the paper's text says nothing of it. 0 leaves it out.
    shrinking : bool
        SMA's branch v_c x with probability 1 - p; the paper's text says nothing of it.
    log_base : float
        Base of the logarithm in Eq. (11).
    """

    reading: PaperReading = PaperReading.STANDARD
    arctanh: bool = True
    weighted: bool = True
    oscillating: bool = True
    restart_share: float = 0.0
    shrinking: bool = False
    log_base: float = 10.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_share("SMWOA", "restart_share", self.restart_share)

    def ask(self, state: PopulationState, rng: np.random.Generator) -> PopulationState:
        """Move every whale by Eqs. (12)-(14), then by the branches of SMA that are switched on."""
        draws = WhaleDraws.of(self, state, rng)
        a = arctanh_factor(state.progress) if self.arctanh else 2.0 - 2.0 * state.progress
        distances = self._distances(state, draws, rng)
        v_b = a * (2.0 * rng.random(state.members.shape) - 1.0) if self.oscillating else 1.0
        moved = whale_moves(draws, a, (state.incumbent, draws.leaders), distances, self.spiral, v_b)
        if self.shrinking:
            nears = rng.random(moved.shape) < approach_probability(state)
            moved = np.where(nears, moved, feedback(state, PaperReading.STANDARD, rng) * state.members)
        if self.restart_share > 0.0:
            moved = restarted(moved, state.box, rng, self.restart_share, Restart.DIAGONAL)
        return evolved(state, candidates=bounded_positions(self.bounds, state.box, moved))

    def _distances(
        self, state: PopulationState, draws: WhaleDraws, rng: np.random.Generator
    ) -> tuple[Floats, Floats, Floats]:
        """D, D' and D'' of Eq. (15)."""
        x, best = state.members, state.incumbent
        omega: Floats | float = 1.0
        c = draws.c
        if self.weighted:
            omega = c = fitness_weights(state.values, rng.random(x.shape), self.log_base)
        to_best = np.abs(omega * best - x)
        to_other = to_best if self.reading is PaperReading.AS_PRINTED else np.abs(c * draws.leaders - x)
        return np.abs(draws.c * best - x), to_best, to_other
