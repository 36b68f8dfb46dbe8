"""Whale optimisation algorithm (WOA).

References
----------
UR5 paper on SMWOA, Section 2.1, Eqs. (1)-(7), after Mirjalili and Lewis (2016).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from study.choices import Choice, Options
from study.problem import Floats
from study.search.bounds import BoundsRule, bounded_positions
from study.search.population import Generational, PopulationState
from study.search.state import evolved


class Draws(Choice):
    """Random numbers per whale or per component of a position."""

    WHALE = "whale"
    COMPONENT = "component"


@dataclass(frozen=True)
class WOA(Generational, Options):
    """Whale optimisation: whales encircle the incumbent, spiral towards it, or follow a random whale.

    Attributes
    ----------
    spiral : float
        Shape b of the logarithmic spiral, Eq. (5). The paper gives no value; 1 in the circulated code.
    coefficients : Draws
        `whale` draws one A and one C for each whale, as the circulated code does and as the choice by |A| needs;
        `component` reads the paper's "coefficient vector" literally and chooses by |A| in every dimension.
    leader : Draws
        `component` draws the random whale of Eq. (7) anew in every dimension, as the circulated code does; `whale`
        once.
    bounds : BoundsRule
        A rule of `study.search.bounds`; ours, the paper is silent.

    Notes
    -----
    All whales move at once, where the circulated code moves them one after the other, so that late whales can follow
    those that have already moved.
    """

    spiral: float = 1.0
    coefficients: Draws = Draws.WHALE
    leader: Draws = Draws.COMPONENT
    bounds: BoundsRule = BoundsRule.CLIP

    def ask(self, state: PopulationState, rng: np.random.Generator) -> PopulationState:
        """Move every whale."""
        draws = WhaleDraws.of(self, state, rng)
        a = 2.0 - 2.0 * state.progress  # below eq. (4)
        x, best, r = state.members, state.incumbent, draws.leaders

        def around(leader: Floats) -> Floats:
            return np.abs(draws.c * leader - x)  # D, D'', eqs. (4), (7)

        moved = whale_moves(draws, a, (best, r), (around(best), np.abs(best - x), around(r)), self.spiral)
        return evolved(state, candidates=bounded_positions(self.bounds, state.box, moved))


class WhaleDraws(NamedTuple):
    """Random numbers of one generation of whales.

    Attributes
    ----------
    u, c : arrays of shape (n_candidates, 1) or (n_candidates, n_dimensions)
        Random numbers behind A = 2 a u - a, and C in [0, 2].
    p, turn : arrays of shape (n_candidates, 1)
        Choice P of the spiral, and its angle l in [-1, 1].
    leaders : array of shape (n_candidates, n_dimensions)
        Positions of random whales.
    """

    u: Floats
    c: Floats
    p: Floats
    turn: Floats
    leaders: Floats

    @classmethod
    def of(cls, search: WOA, state: PopulationState, rng: np.random.Generator) -> WhaleDraws:
        """Draw for every whale of the population."""
        n, d = state.members.shape
        u, c = rng.random((2, n, 1 if search.coefficients is Draws.WHALE else d))
        p, turn = rng.random((2, n, 1))
        rows = rng.integers(n, size=(n, 1 if search.leader is Draws.WHALE else d))
        return cls(u, 2.0 * c, p, 2.0 * turn - 1.0, state.members[rows, np.arange(d)])


def whale_moves(
    draws: WhaleDraws,
    a: float,
    leaders: tuple[Floats, Floats],
    distances: tuple[Floats, Floats, Floats],
    spiral: float,
    oscillation: Floats | float = 1.0,
) -> Floats:
    """Move every whale by encircling, spiral or exploration.

    Parameters
    ----------
    draws : WhaleDraws
    a : float
        Convergence factor.
    leaders : incumbent and random whales
    distances : D, D' and D'', each of shape (n_candidates, n_dimensions)
    spiral : float
    oscillation : array of shape (n_candidates, n_dimensions), optional
        v_b of Eq. (13); 1 in plain WOA.

    Returns
    -------
    array of shape (n_candidates, n_dimensions)
    """
    (best, other), (d, d1, d2) = leaders, distances
    big_a = 2.0 * a * draws.u - a  # eq. (4)
    circling = best - big_a * d  # eqs. (3), (12)
    exploring = other - big_a * d2  # eqs. (7), (14)
    coil = np.exp(spiral * draws.turn) * np.cos(2.0 * np.pi * draws.turn)
    spiralling = best + oscillation * coil * d1  # eqs. (5), (13)
    return np.where(draws.p >= 0.5, spiralling, np.where(np.abs(big_a) < 1.0, circling, exploring))
