"""Sparrow search algorithm, with the improvements of the UR5 paper as switches.

References
----------
Improved sparrow paper, Section 4, Eqs. (13)-(19) and Algorithm 1, after Xue and Shen (2020).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from study.problem import Floats
from study.search.bounds import brought_back
from study.search.chaos import chaotic_population, map_named
from study.search.draws import Generators, Rng, members_at, places
from study.search.loop import Box, SideBySide, evolved
from study.search.population import PopulationState, check_choice, check_share, new_population
from study.search.pso import uniform_population
from study.search.reading import is_printed

STARTS = ("uniform", "tent")
SIGNS = np.array([-1.0, 1.0])
LARGEST = np.finfo(float).max
LARGEST_EXPONENT = 700.0  # e^709 is the largest double


@lru_cache(maxsize=64)
def _ranks(n: int) -> Floats:
    """Ranks from the best, 1, to the worst, shape (n, 1)."""
    return np.arange(1.0, n + 1)[:, None]


@dataclass(frozen=True)
class SSA(SideBySide):
    """Producers contract, joiners follow the best producer or leave, scouts are drawn to the incumbent.

    `start="tent"` makes it the paper's T-SSA, both adaptive factors its ADF-SSA, all three its TADF-SSA.

    Attributes
    ----------
    reading : str
        `as-printed` keeps the signs of Eq. (14), has no absolute value in the second line of Eq. (15), no pi in
        Eq. (18), and takes the adaptive factors as they are: steps of one sign. `standard` follows Xue and Shen and
        multiplies the adaptive factors by the random numbers that they replace.
    start : str
        `uniform`, or `tent`: the perturbed tent map of Eq. (17), one sequence per sparrow.
    adaptive_beta, adaptive_k : bool
        Eq. (18) for beta and Eq. (19) for K; otherwise a normal number per dimension and a uniform number in [-1, 1].
    beta_limits : tuple of two floats
        beta_min and beta_max of Eq. (18). The paper gives none; ours.
    k_limits : tuple of two floats
        K_min and K_max of Eq. (19). The paper gives none; ours.
    producers, scouts : float
        Shares of the population, 20 % and 10 % in the paper's Section 5.
    safety : float
        ST of Eq. (13), 0.5 in the paper's Section 5.
    bounds : str
        A rule of `study.search.bounds`; ours.

    Notes
    -----
    Every sparrow is evaluated once per generation, as Algorithm 1 has it: the joiners follow the new position of the
    producer that was best before, and a scout's move replaces the move it would have made. Xue and Shen's own code
    evaluates scouts twice and the producers first. Eq. (14) prints A^T (A A^T)^-1 A^-1, where A has no inverse; both
    readings take the original A^T (A A^T)^-1, which makes the joiners' step the same number in every dimension.
    """

    reading: str = "standard"
    start: str = "uniform"
    adaptive_beta: bool = False
    adaptive_k: bool = False
    beta_limits: tuple[float, float] = (0.0, 1.0)
    k_limits: tuple[float, float] = (0.0, 1.0)
    producers: float = 0.2
    scouts: float = 0.1
    safety: float = 0.5
    bounds: str = "clip"

    def __post_init__(self) -> None:
        is_printed(self.reading)
        check_choice("SSA", "start", self.start, STARTS)
        for field in ("producers", "scouts", "safety"):
            check_share("SSA", field, getattr(self, field))

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> PopulationState:
        """Spread sparrows uniformly or by the tent map."""
        if self.start == "tent":
            positions = chaotic_population(map_named("perturbed-tent"), box, population, rng, along="dimensions")
        else:
            positions = uniform_population(box, population, rng)
        return new_population(box, positions, generations)

    def ask(self, state: PopulationState, rng: Rng) -> PopulationState:
        """Rank the sparrows and move each by its role."""
        order = state.values.argsort(axis=-1, kind="stable")
        x, n = members_at(state.members, order), order.shape[-1]
        n_producers = min(n, max(1, round(self.producers * n)))
        produced = self._producers(x[..., :n_producers, :], state.generations, rng)
        moved = np.concatenate([produced, self._joiners(x, n_producers, produced[..., :1, :], rng)], axis=-2)
        scouts = rng.permutation(n)[..., : round(self.scouts * n)]
        moved[places(scouts)] = self._scouts(state, x, scouts, rng)
        candidates = np.empty_like(moved)
        candidates[places(order)] = brought_back(self.bounds, state.box, moved)
        return evolved(state, candidates=candidates)

    def tell(self, state: PopulationState, values: Floats, rng: Rng) -> PopulationState:
        """Keep what is better, Algorithm 1, line 14."""
        return state.kept_better(values)

    def _producers(self, x: Floats, generations: int, rng: Rng) -> Floats:
        """New positions of the best sparrows, Eq. (13); i is the rank, counted from 1."""
        if isinstance(rng, Generators):  # each run is alarmed by itself
            runs = zip(x, rng.each, strict=True)
            return np.stack([self._producers(own, generations, its) for own, its in runs])
        alarm = rng.random()  # R_2
        if alarm >= self.safety:
            return x + rng.standard_normal((len(x), 1))  # x + Q L
        alpha = 1.0 - rng.random((len(x), 1))  # in (0, 1]
        return x * np.exp(-_ranks(len(x)) / (alpha * generations))

    def _joiners(self, x: Floats, first: int, leader: Floats, rng: Rng) -> Floats:
        """New positions of the others, Eq. (14); the hungry ones, ranked in the lower half, leave."""
        n, d = x.shape[-2:]
        q = rng.standard_normal((n - first, 1))
        signs = SIGNS.take(rng.integers(2, size=(n - first, d)))  # A; A^+ = A^T (A A^T)^-1 = A^T / d
        half = max(n // 2, first)
        hungry, worst = x[..., half:, :], x[..., -1:, :]
        fall = hungry - worst if is_printed(self.reading) else worst - hungry
        leaving = q[..., half - first :, :] * np.exp(np.minimum(fall / _ranks(n)[half:] ** 2, LARGEST_EXPONENT))
        step = (np.abs(x[..., first:half, :] - leader) * signs[..., : half - first, :]).sum(axis=-1, keepdims=True) / d
        return np.concatenate([leader + step, leaving], axis=-2)

    def _scouts(self, state: PopulationState, x: Floats, scouts: np.ndarray, rng: Rng) -> Floats:
        """New positions of the sparrows that sense danger, given by their ranks, Eq. (15)."""
        own, values = members_at(x, scouts), np.sort(state.values, axis=-1)
        to_best = state.incumbent + self._beta(state, own, rng) * np.abs(own - state.incumbent)
        k = self._k(state, scouts.shape[-1], rng)
        behind = values[places(scouts)] > state.incumbent_value
        if behind.all():
            return to_best
        away = own - x[..., -1:, :] if is_printed(self.reading) else np.abs(own - x[..., -1:, :])
        fall = np.minimum(state.incumbent_value, LARGEST) - values[..., -1:]
        return np.where(behind[..., None], to_best, own + k * away / (fall[..., None] + 1e-50))

    def _beta(self, state: PopulationState, x: Floats, rng: Rng) -> Floats | float:
        printed = is_printed(self.reading)
        if not self.adaptive_beta:
            return rng.standard_normal(x.shape[-2:])
        low, high = self.beta_limits
        angle = state.progress if printed else math.pi * state.progress
        beta = low + 0.5 * (high - low) * (1.0 - math.cos(angle))  # eq. (18)
        return beta if printed else beta * rng.standard_normal(x.shape[-2:])

    def _k(self, state: PopulationState, n: int, rng: Rng) -> Floats | float:
        low, high = self.k_limits
        if not self.adaptive_k:
            return 2.0 * rng.random((n, 1)) - 1.0
        k = state.progress * math.exp(math.sin(math.pi * state.progress) - low) / high  # eq. (19)
        return k if is_printed(self.reading) else k * (2.0 * rng.random((n, 1)) - 1.0)
