"""The compiled variant of the elimination and of the blocks' steps; importing this file imports numba.

It follows `baselines.free_path.elimination.Blocks`, whose equations it solves, in the coordinates of
`baselines.free_path.compiled`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from baselines.free_path.compiled import finish, prepare
from baselines.free_path.compiled_algebra import kernel, reflected, reflected_back, solve_one
from baselines.free_path.elimination import SHARED, SHIFTS, WIDE, equations_of
from baselines.free_path.model import Model
from baselines.free_path.pieces import Pieces
from baselines.free_path.question import Integers
from study.problem import Floats

Arrays = tuple[Floats, Floats, Floats, Floats, Floats, Floats, Floats]
Equations = tuple[Integers, Integers]


@kernel
def begin(right: Floats, errors: Floats, blocks: Arrays, equations: Equations, out: tuple[Floats, Floats]) -> None:
    """y0 and the share of every block in the right side of the reduced system; `out` is filled."""
    inner, cross, triangle, normals, factors, shifts, follow = blocks
    counts, which = equations
    start, shared = out
    ny = inner.shape[2]
    turned = np.empty(ny)
    for i in range(inner.shape[0]):
        for j in range(inner.shape[1]):
            count, own, place, lower = counts[j], inner[i, j], start[i, j], triangle[i, j]
            turned[:] = right[i, j]
            reflected(normals[i, j], count, turned)
            for c in range(count):
                total = -errors[i, j, which[j, c]]
                for r in range(c):
                    total -= lower[c, r] * place[r]
                place[c] = total / lower[c, c]
            for p in range(count, ny):
                place[p] = turned[p]
                for c in range(count):
                    place[p] -= own[p, c] * place[c]
            solve_one(factors[i, j], ny - count, place[count:])
            shared[i, j] = 0.0
            for c in range(count):
                rest = _rest(turned, own, shifts[i, j], place, c)
                for a in range(SHARED):
                    shared[i, j, a] += follow[i, j, c, a] * rest
            for p in range(ny):
                for a in range(SHARED):
                    shared[i, j, a] -= cross[i, j, p, a] * place[p]


@kernel
def _rest(turned: Floats, own: Floats, shift: float, place: Floats, row: int) -> float:
    """One row of a right side less B times what stands inside of the block."""
    rest = turned[row] - shift * place[row]
    for p in range(len(place)):
        rest -= own[row, p] * place[p]
    return float(rest)


@kernel
def complete(right: Floats, shared: Floats, blocks: Arrays, equations: Equations, out: tuple[Floats, Floats]) -> None:
    """The step inside of every block, on from y0, and in its multipliers; `out` is filled, its first part holds y0."""
    inner, cross, triangle, normals, _, shifts, follow = blocks
    counts, which = equations
    inside, multipliers = out
    turned = np.empty(inner.shape[2])
    for i in range(inner.shape[0]):
        for j in range(inner.shape[1]):
            count, own, place, lower = counts[j], inner[i, j], inside[i, j], triangle[i, j]
            turned[:] = right[i, j]
            reflected(normals[i, j], count, turned)
            for p in range(len(place)):
                for a in range(SHARED):
                    place[p] += follow[i, j, p, a] * shared[i, j, a]
            multipliers[i, j] = 0.0
            for c in range(count - 1, -1, -1):
                rest = _rest(turned, own, shifts[i, j], place, c)
                for a in range(SHARED):
                    rest -= cross[i, j, c, a] * shared[i, j, a]
                for r in range(c + 1, count):
                    rest -= lower[r, c] * multipliers[i, j, which[j, r]]
                multipliers[i, j, which[j, c]] = rest / lower[c, c]
            reflected_back(normals[i, j], count, place)


class CompiledElimination:
    """The same elimination by compiled loops over the blocks, in coordinates of their own."""

    def __init__(self, model: Model, at: Pieces, local: Floats, free: bool, shares: Floats) -> None:
        pieces = model.pieces
        between, wide = 2 + 2 * np.arange(1, pieces), 3 + 2 * np.arange(pieces)
        inside = np.concatenate([between, wide]) if free else between
        ends = np.array([2, 0, 1, 2 + 2 * pieces])
        shape, size = model.shape[:2], len(inside)
        self._inner, self._cross = np.empty((*shape, size, size)), np.empty((*shape, size, WIDE))
        self._outer, self._lead = np.empty((*shape, SHARED, SHARED)), np.empty((*shape, 3, WIDE))
        self._triangle, self._normals = np.empty((*shape, 3, size)), np.empty((*shape, 3, size))
        self._equations = _equations(model.kinds, free)
        out = self._inner, self._cross, self._outer, self._lead, self._triangle, self._normals
        places, shares = (inside, ends), np.ascontiguousarray(shares)
        prepare(local, at.states, model.gains, model.closures, model.kinds, places, shares, out)

    def blocks(self, regularisation: float) -> CompiledBlocks:
        """Eliminate the inside of all blocks, with a multiple of the identity added to it."""
        factors, shifts = np.empty_like(self._inner), np.empty(self._inner.shape[:2])
        follow, reduced = np.empty_like(self._cross), np.empty_like(self._outer)
        given = self._inner, self._cross, self._outer, self._lead
        counts = self._equations[0]
        finish(float(regularisation), counts, SHIFTS, given, (factors, shifts, follow, reduced))
        arrays = self._inner, self._cross, self._triangle, self._normals, factors, shifts, follow
        return CompiledBlocks(reduced, arrays, self._equations)


@dataclass(frozen=True, eq=False)
class CompiledBlocks:
    """The same blocks; `start` is in coordinates of their own.

    Attributes
    ----------
    reduced : array of shape (n_segments, n_moving, 7, 7)
    arrays : tuple
        As `baselines.free_path.compiled` names them: B, C, L, the normals, U, the shifts, Y.
    equations : tuple of int arrays
        How many closing equations every joint has, and which.
    """

    reduced: Floats
    arrays: Arrays
    equations: Equations

    def begin(self, right: Floats, errors: Floats) -> tuple[Floats, Floats]:
        """y0, and the blocks' shares in the right side of the reduced system."""
        out = np.empty_like(right), np.empty((*right.shape[:2], SHARED))
        begin(right, errors, self.arrays, self.equations, out)
        return out

    def complete(self, right: Floats, start: Floats, shared: Floats) -> tuple[Floats, Floats]:
        """Step inside of the blocks, and in the multipliers of their equations."""
        out = start.copy(), np.empty((*right.shape[:2], 3))
        complete(right, shared, self.arrays, self.equations, out)
        return out


def _equations(kinds: Integers, free: bool) -> Equations:
    """Number of closing equations that every joint has, and their rows."""
    rows = [equations_of(kind, free) for kind in range(4)]
    counts, which = np.array([len(own) for own in rows]), np.array([(own + 3 * [0])[:3] for own in rows])
    return counts[kinds], which[kinds]
