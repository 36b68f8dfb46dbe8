"""Slime mould algorithm (SMA).

References
----------
UR5 paper on SMWOA, Section 2.2, Eqs. (8)-(11), after Li et al. (2020).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from study.choices import Choice, Options
from study.problem import Floats
from study.search.bounds import BoundsRule, bounded_positions
from study.search.population import Generational, PopulationState, check_share, normalised_fitness
from study.search.reading import PaperReading
from study.search.state import Box, evolved

LARGEST = np.finfo(float).max


class Restart(Choice):
    """Random numbers of a restart, first line of Eq. (8)."""

    SAME_NUMBER = "same-number"
    DIAGONAL = "diagonal"
    COMPONENT = "component"


@dataclass(frozen=True)
class SMA(Generational, Options):
    """Slime mould algorithm: members approach the incumbent by the difference of two others, shrink, or restart.

    Attributes
    ----------
    reading : PaperReading
        `as-printed` takes Eq. (8) at its word: the restart uses the very number that is smaller than z, so it
        lands in the lowest corner of the box, and v_c is the falling number itself, never negative. `standard` takes
        the algorithm's own paper: a fresh number, and v_c uniform in [-b, b] with b falling from 1 to 0.
    restart_share : float
        z of Eq. (8). The paper gives no value; 0.03 in the algorithm's own paper.
    restart : Restart
        `diagonal` draws one number for all dimensions, as Eq. (8) and the circulated code do, a bias towards the box's
        main diagonal; `component` one for each dimension; `same-number` takes the number compared with z, and is the
        only one in the printed reading.
    log_base : float
        Base of the logarithm in Eq. (11), printed as log; 10 in the circulated code.
    bounds : BoundsRule
        A rule of `study.search.bounds`; ours.
    """

    reading: PaperReading = PaperReading.STANDARD
    restart_share: float = 0.03
    restart: Restart = Restart.DIAGONAL
    log_base: float = 10.0
    bounds: BoundsRule = BoundsRule.CLIP

    def __post_init__(self) -> None:
        super().__post_init__()
        check_share("SMA", "restart_share", self.restart_share)

    def ask(self, state: PopulationState, rng: np.random.Generator) -> PopulationState:
        """Move every member by Eq. (8)."""
        x, x_b = state.members, state.incumbent
        n, d = x.shape
        w = fitness_weights(state.values, rng.random((n, d)), self.log_base)  # eq. (11)
        v_b = arctanh_factor(state.progress) * (2.0 * rng.random((n, d)) - 1.0)  # uniform in [-a, a], eq. (10)
        x_a, x_c = x[rng.integers(n, size=(2, n, d)), np.arange(d)]  # random members, X_A and X_B in the paper
        p = approach_probability(state)  # eq. (9)
        nears = rng.random((n, d)) < p
        v_c = feedback(state, self.reading, rng)
        moved = np.where(nears, x_b + v_b * (w * x_a - x_c), v_c * x)  # eq. (8), second and third line
        moved = restarted(moved, state.box, rng, self.restart_share, self._restart())  # eq. (8), first line
        return evolved(state, candidates=bounded_positions(self.bounds, state.box, moved))

    def _restart(self) -> Restart:
        return Restart.SAME_NUMBER if self.reading is PaperReading.AS_PRINTED else self.restart


def arctanh_factor(progress: float) -> float:
    """Convergence factor a = arctanh(1 - t / t_max), Eq. (10); t counts from 1, because arctanh(1) is infinite."""
    return math.atanh(1.0 - progress)


def approach_probability(state: PopulationState) -> Floats:
    """Approach probability p = tanh |F_i - F_best|, Eq. (9), shape (n_candidates, 1); 1 while nothing is finite."""
    known = np.minimum(state.incumbent_value, LARGEST)
    return np.tanh(np.abs(state.values - known))[:, None]


def feedback(state: PopulationState, reading: PaperReading, rng: np.random.Generator) -> Floats:
    """Feedback factor v_c of Eq. (8), shape (n_candidates, n_dimensions)."""
    b = 1.0 - state.progress
    if reading is PaperReading.AS_PRINTED:
        return np.full(state.members.shape, b)
    return b * (2.0 * rng.random(state.members.shape) - 1.0)


def restarted(moved: Floats, box: Box, rng: np.random.Generator, share: float, how: Restart) -> Floats:
    """Restart of a share of the members anywhere in the box, first line of Eq. (8).

    Parameters
    ----------
    moved : array of shape (n_candidates, n_dimensions)
    box : Box
    rng : numpy.random.Generator
    share : float
        Probability z.
    how : Restart
    """
    n, d = moved.shape
    r1 = rng.random((n, 1))
    anywhere = r1 if how is Restart.SAME_NUMBER else rng.random((n, 1 if how is Restart.DIAGONAL else d))
    return np.where(r1 < share, box.at(anywhere), moved)


def fitness_weights(values: Floats, r: Floats, log_base: float) -> Floats:
    """Fitness weights: above 1 for the better half and below 1 for the rest, Eq. (11).

    Parameters
    ----------
    values : array of shape (n_candidates,)
        Objective values of this generation; infinite ones weigh as the worst finite one.
    r : array of shape (n_candidates, n_dimensions)
        Random numbers in [0, 1].
    log_base : float

    Returns
    -------
    array of shape (n_candidates, n_dimensions)
    """
    span = np.log1p(normalised_fitness(values)) / math.log(log_base)
    worse = values.argsort(kind="stable")[(len(values) + 1) // 2 :]
    span[worse] = -span[worse]
    return 1.0 + r * span[:, None]
