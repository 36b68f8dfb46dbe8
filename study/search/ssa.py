"""Sparrow search algorithm (SSA), with the improvements of the UR5 paper as switches.

References
----------
Improved sparrow paper, Section 4, Eqs. (13)-(19) and Algorithm 1, after Xue and Shen (2020).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from study.choices import Choice, Options
from study.problem import Floats
from study.search.bounds import BoundsRule, bounded_positions
from study.search.chaos import Direction, chaotic_population, map_named
from study.search.population import PopulationState, check_share, new_population
from study.search.reading import PaperReading
from study.search.state import Box, evolved, uniform_population

SIGNS = np.array([-1.0, 1.0])
LARGEST = np.finfo(float).max
LARGEST_EXPONENT = 700.0  # e^709 is the largest double


class Start(Choice):
    """Initial population: uniform, or one perturbed tent map per sparrow, Eq. (17)."""

    UNIFORM = "uniform"
    TENT = "tent"


@lru_cache(maxsize=64)
def _ranks(n: int) -> Floats:
    """Ranks from the best, 1, to the worst, shape (n, 1)."""
    return np.arange(1.0, n + 1)[:, None]


@dataclass(frozen=True)
class SSA(Options):
    """Sparrow search: producers contract, joiners follow the best producer or leave, scouts are drawn to the incumbent.

    `Start.TENT` makes it the paper's T-SSA, both adaptive factors its ADF-SSA, all three its TADF-SSA.

    Attributes
    ----------
    reading : PaperReading
        `as-printed` keeps the signs of Eq. (14), has no absolute value in the second line of Eq. (15), no pi in
        Eq. (18), and takes the adaptive factors as they are: steps of one sign. `standard` follows Xue and Shen and
        multiplies the adaptive factors by the random numbers that they replace.
    start : Start
    rescaled : bool
        Stretch every sparrow's tent sequence to fill the box, one way to read x_min and x_max in Eq. (17).
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
    bounds : BoundsRule
        A rule of `study.search.bounds`; ours.

    Notes
    -----
    Every sparrow is evaluated once per generation, as Algorithm 1 has it: the joiners follow the new position of the
    producer that was best before, and a scout's move replaces the move it would have made. Xue and Shen's own code
    evaluates scouts twice and the producers first. Eq. (14) prints A^T (A A^T)^-1 A^-1, where A has no inverse; both
    readings take the original A^T (A A^T)^-1, which makes the joiners' step the same number in every dimension.
    """

    reading: PaperReading = PaperReading.STANDARD
    start: Start = Start.UNIFORM
    rescaled: bool = False
    adaptive_beta: bool = False
    adaptive_k: bool = False
    beta_limits: tuple[float, float] = (0.0, 1.0)
    k_limits: tuple[float, float] = (0.0, 1.0)
    producers: float = 0.2
    scouts: float = 0.1
    safety: float = 0.5
    bounds: BoundsRule = BoundsRule.CLIP

    def __post_init__(self) -> None:
        super().__post_init__()
        for field in ("producers", "scouts", "safety"):
            check_share("SSA", field, getattr(self, field))

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> PopulationState:
        """Spread sparrows uniformly or by the tent map."""
        if self.start is Start.TENT:
            positions = chaotic_population(
                map_named("perturbed-tent"), box, population, rng, Direction.DIMENSIONS, self.rescaled
            )
        else:
            positions = uniform_population(box, population, rng)
        return new_population(box, positions, generations)

    def ask(self, state: PopulationState, rng: np.random.Generator) -> PopulationState:
        """Rank the sparrows and move each by its role."""
        order = state.values.argsort(kind="stable")
        x, n = state.members[order], len(order)  # x[i - 1] is the sparrow of rank i
        n_producers = min(n, max(1, round(self.producers * n)))
        produced = self._producers(x[:n_producers], state.generations, rng)
        moved = np.concatenate([produced, self._joiners(x, n_producers, produced[0], rng)])
        scouts = rng.permutation(n)[: round(self.scouts * n)]
        moved[scouts] = self._scouts(state, x, scouts, rng)
        candidates = np.empty_like(moved)
        candidates[order] = bounded_positions(self.bounds, state.box, moved)
        return evolved(state, candidates=candidates)

    def tell(self, state: PopulationState, values: Floats, rng: np.random.Generator) -> PopulationState:
        """Keep what is better, Algorithm 1, line 14."""
        return state.kept_better(values)

    def _producers(self, x: Floats, t_max: int, rng: np.random.Generator) -> Floats:
        """New positions of the best sparrows, Eq. (13)."""
        n = len(x)
        r_2 = rng.random()
        if r_2 >= self.safety:
            return x + rng.standard_normal((n, 1))  # X + Q L
        alpha = 1.0 - rng.random((n, 1))  # in (0, 1]
        return x * np.exp(-_ranks(n) / (alpha * t_max))  # X exp(-i / (alpha T))

    def _joiners(self, x: Floats, first: int, x_p: Floats, rng: np.random.Generator) -> Floats:
        """New positions of the others, Eq. (14); those ranked in the lower half are hungry and leave."""
        n, d = x.shape
        q = rng.standard_normal((n - first, 1))
        a = SIGNS.take(rng.integers(2, size=(n - first, d)))  # A; A^+ = A^T (A A^T)^-1 = A^T / d
        half = max(n // 2, first)
        hungry, fed, i = x[half:], x[first:half], _ranks(n)[half:]
        fall = (
            hungry - x[-1] if self.reading is PaperReading.AS_PRINTED else x[-1] - hungry
        )  # X_worst - X_i, its sign as read
        leaving = q[half - first :] * np.exp(np.minimum(fall / i**2, LARGEST_EXPONENT))  # i > n / 2
        joined = x_p + (np.abs(fed - x_p) * a[: half - first]).sum(axis=1, keepdims=True) / d  # X_P + |X_i - X_P| A^+ L
        return np.concatenate([joined, leaving])

    def _scouts(self, state: PopulationState, x: Floats, scouts: np.ndarray, rng: np.random.Generator) -> Floats:
        """New positions of the sparrows that sense danger, given by their ranks, Eq. (15)."""
        x_i, x_best, x_worst = x[scouts], state.incumbent, x[-1]
        f = np.sort(state.values)
        f_i, f_g, f_w = f[scouts], state.incumbent_value, f[-1]
        to_best = x_best + self._beta(state, x_i, rng) * np.abs(x_i - x_best)  # f_i > f_g
        k = self._k(state, len(scouts), rng)
        if (f_i > f_g).all():
            return to_best
        away = x_i - x_worst if self.reading is PaperReading.AS_PRINTED else np.abs(x_i - x_worst)
        fall = min(f_g, LARGEST) - f_w  # the paper's f_i - f_w, where f_i = f_g
        return np.where((f_i > f_g)[:, None], to_best, x_i + k * away / (fall + 1e-50))

    def _beta(self, state: PopulationState, x: Floats, rng: np.random.Generator) -> Floats | float:
        printed = self.reading is PaperReading.AS_PRINTED
        if not self.adaptive_beta:
            return rng.standard_normal(x.shape)
        low, high = self.beta_limits
        angle = state.progress if printed else math.pi * state.progress
        beta = low + 0.5 * (high - low) * (1.0 - math.cos(angle))  # eq. (18)
        return beta if printed else beta * rng.standard_normal(x.shape)

    def _k(self, state: PopulationState, n: int, rng: np.random.Generator) -> Floats | float:
        low, high = self.k_limits
        if not self.adaptive_k:
            return 2.0 * rng.random((n, 1)) - 1.0
        k = state.progress * math.exp(math.sin(math.pi * state.progress) - low) / high  # eq. (19)
        return k if self.reading is PaperReading.AS_PRINTED else k * (2.0 * rng.random((n, 1)) - 1.0)
