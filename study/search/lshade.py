"""L-SHADE: differential evolution with success-history parameter adaptation and linear population size reduction.

References
----------
Tanabe and Fukunaga (2014), whose equation numbers stand beside the lines. None of the papers compares with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.search.population import PopulationState, check_share, spread_population
from study.search.state import Box, evolved

SMALLEST_POPULATION = 4  # N_min
TERMINAL = np.nan
"""The paper's terminal value of a crossover memory: from then on its crossover rates are 0."""


class Memory(NamedTuple):
    """Success history of both control parameters.

    Attributes
    ----------
    factors, crossovers : arrays of shape (H,)
        M_F, and M_CR, where `TERMINAL` is possible.
    slot : int
        Place k of the next update.
    """

    factors: Floats
    crossovers: Floats
    slot: int

    def updated(self, factors: Floats, crossovers: Floats, gains: Floats) -> Memory:
        """Write the weighted Lehmer means of the successful parameters into the next slot, Eqs. (7), (8).

        Parameters
        ----------
        factors, crossovers : arrays of shape (n_successes,)
            S_F and S_CR.
        gains : array of shape (n_successes,)
            Improvements of the objective; an infinite one weighs as the largest finite one.
        """
        if not len(gains):
            return self
        finite = gains[np.isfinite(gains)]
        weights = np.minimum(gains / finite.max(), 1.0) if finite.size else np.ones(len(gains))
        m_f, m_cr, k = self.factors.copy(), self.crossovers.copy(), self.slot
        m_f[k] = lehmer_mean(factors, weights)
        spent = np.isnan(m_cr[k]) or crossovers.max() == 0.0
        m_cr[k] = TERMINAL if spent else lehmer_mean(crossovers, weights)
        return Memory(m_f, m_cr, (k + 1) % len(m_f))


def lehmer_mean(values: Floats, weights: Floats) -> float:
    """Weighted Lehmer mean, Eq. (9): sum of w s^2 over sum of w s."""
    return float((weights * values**2).sum() / (weights * values).sum())


@dataclass(frozen=True, eq=False)
class LSHADEState(PopulationState):
    """A shrinking population, its archive and its success history.

    Attributes
    ----------
    memory : Memory
    archive : array of shape (n_archived, n_dimensions)
        Parents that lost to their trials.
    factors, crossovers : arrays of shape (n_candidates,)
        F and CR of the candidates.
    first_population : int
        N_init.
    evaluations, budget : int
        Candidates told so far, and MAX_NFE.
    """

    memory: Memory
    archive: Floats
    factors: Floats
    crossovers: Floats
    first_population: int
    evaluations: int
    budget: int

    @property
    def progress(self) -> float:
        """Share of the evaluations told so far, in [0, 1]; generations shrink."""
        return min(self.evaluations / self.budget, 1.0)

    @property
    def next_population(self) -> int:
        """Population size that the linear reduction leaves, Eq. (10)."""
        return round((SMALLEST_POPULATION - self.first_population) * self.progress + self.first_population)


@dataclass(frozen=True)
class LSHADE:
    """L-SHADE: differential evolution that learns F and CR from its successes while its population shrinks to four.

    Attributes
    ----------
    own_population : bool
        Start with the paper's own size, 18 for each dimension, instead of the size asked for.
    history : int
        Memory size H.
    best_share : float
        p of current-to-pbest: share of the population to pick the best from, at least two members.
    archive_share : float
        Archive size as a multiple of the population.

    Notes
    -----
    Once terminal, a crossover memory stays so, as Algorithm 1 of the paper has it; the circulated code overwrites it.
    """

    own_population: bool = False
    history: int = 6
    best_share: float = 0.11
    archive_share: float = 2.6

    def __post_init__(self) -> None:
        check_share("L-SHADE", "best_share", self.best_share)

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> LSHADEState:
        """Spread members uniformly.

        Raises
        ------
        StudyError
            If there are fewer than four members.
        """
        n = 18 * len(box.lower) if self.own_population else population
        if n < SMALLEST_POPULATION:
            raise StudyError(
                f"L-SHADE needs a population of at least {SMALLEST_POPULATION}, got {n}; "
                "raise the population and the number of evaluations"
            )
        half = np.full(self.history, 0.5)
        return LSHADEState(
            **vars(spread_population(box, n, -(-population * generations // n), rng)),
            memory=Memory(half, half, 0),
            archive=np.empty((0, len(box.lower))),
            factors=np.zeros(n),
            crossovers=np.zeros(n),
            first_population=n,
            evaluations=0,
            budget=population * generations,
        )

    def ask(self, state: LSHADEState, rng: np.random.Generator) -> LSHADEState:
        """Build one trial for every member by current-to-pbest/1/bin."""
        x = state.members
        n, d = x.shape
        f, cr = parameters(state.memory, n, rng)
        best = state.values.argsort(kind="stable")[: max(2, round(self.best_share * n))]
        x_pbest = x[rng.choice(best, size=n)]
        r1, r2 = two_others(n, n + len(state.archive), rng)
        x_r1, x_r2 = x[r1], np.concatenate([x, state.archive])[r2]
        v = x + f[:, None] * (x_pbest - x) + f[:, None] * (x_r1 - x_r2)  # eq. (3)
        v = np.where(v < state.box.lower, (state.box.lower + x) / 2, v)  # eq. (4)
        v = np.where(v > state.box.upper, (state.box.upper + x) / 2, v)  # eq. (4)
        crossed = rng.random((n, d)) < cr[:, None]
        crossed |= rng.integers(d, size=(n, 1)) == np.arange(d)
        return evolved(state, candidates=np.where(crossed, v, x), factors=f, crossovers=cr)  # eq. (5)

    def tell(self, state: LSHADEState, values: Floats, rng: np.random.Generator) -> LSHADEState:
        """Select, archive the losers, learn from the successes, and shrink the population."""
        if not state.generation:
            return evolved(state.replaced(values), evaluations=len(values))
        improved = values < state.values
        gains = state.values[improved] - values[improved]
        kept = values <= state.values
        selected = evolved(
            state.replaced(values),
            members=np.where(kept[:, None], state.candidates, state.members),  # eq. (6)
            values=np.where(kept, values, state.values),
            memory=state.memory.updated(state.factors[improved], state.crossovers[improved], gains),
            evaluations=state.evaluations + len(values),
        )
        return self._shrunk(selected, state.members[improved], rng)

    def _shrunk(self, state: LSHADEState, losers: Floats, rng: np.random.Generator) -> LSHADEState:
        """Drop the worst members, Eq. (10), and what is too much for the archive, at random."""
        kept = np.sort(state.values.argsort(kind="stable")[: state.next_population])
        room = round(self.archive_share * len(kept))
        old = rng.permutation(len(state.archive))[: max(room - len(losers), 0)]
        archive = np.concatenate([state.archive[np.sort(old)], losers])[:room]
        return evolved(state, members=state.members[kept], values=state.values[kept], archive=archive)


def parameters(memory: Memory, n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Draw F and CR of n trials, each around a random slot of the success history.

    Returns
    -------
    two arrays of shape (n,)
        F in (0, 1], Cauchy numbers drawn anew until positive; CR in [0, 1], normal numbers, 0 where terminal.
    """
    slots = rng.integers(len(memory.factors), size=n)
    m_f, m_cr = memory.factors[slots], memory.crossovers[slots]
    normal = m_cr + 0.1 * rng.standard_normal(n)
    cr = np.where(np.isnan(m_cr), 0.0, np.clip(normal, 0.0, 1.0))  # eq. (1)
    f = m_f + 0.1 * rng.standard_cauchy(n)  # eq. (2)
    while (again := f <= 0.0).any():
        f[again] = m_f[again] + 0.1 * rng.standard_cauchy(int(again.sum()))
    return np.minimum(f, 1.0), cr


def two_others(n: int, n_pool: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Draw for each of n members another member r1, and r2 from the pool of members and archive, all three different."""
    own = np.arange(n)
    first, second = rng.integers(n - 1, size=n), rng.integers(n_pool - 2, size=n)
    first += first >= own  # count past those that are taken, from the lowest
    second += second >= np.minimum(own, first)
    second += second >= np.maximum(own, first)
    return first, second
