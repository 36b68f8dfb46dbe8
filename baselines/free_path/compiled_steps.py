"""The compiled variant of the blocks' steps; importing this file imports numba.

It follows `baselines.free_path.elimination.Blocks`, whose equations it solves.
"""

from __future__ import annotations

import numpy as np

from baselines.free_path.compiled import SHARED
from baselines.free_path.compiled_algebra import kernel
from study.problem import Floats


@kernel
def begin(
    right: Floats, errors: Floats, blocks: tuple[Floats, Floats, Floats, Floats, Floats], out: tuple[Floats, Floats]
) -> None:
    """y0 and the share of every block in the right side of the reduced system; `out` is filled."""
    inverse, half, inner, cross, follow = blocks
    start, shared = out
    ny = inner.shape[2]
    rest, image = np.empty(ny), np.empty(ny)
    for i in range(inner.shape[0]):
        for j in range(inner.shape[1]):
            own, root, place = inner[i, j], half[i, j], start[i, j]
            for p in range(ny):
                place[p] = 0.0
                for c in range(3):
                    place[p] -= inverse[i, j, p, c] * errors[i, j, c]
            _remainder(right[i, j], own, place, rest)
            image[:] = 0.0
            for p in range(ny):
                for r in range(ny):
                    image[r] += root[p, r] * rest[p]
            for p in range(ny):
                for r in range(ny):
                    place[p] += root[p, r] * image[r]
            _remainder(right[i, j], own, place, rest)
            shared[i, j] = 0.0
            for p in range(ny):
                for a in range(SHARED):
                    shared[i, j, a] += follow[i, j, p, a] * rest[p] - cross[i, j, p, a] * place[p]


@kernel
def _remainder(right: Floats, matrix: Floats, vector: Floats, rest: Floats) -> None:
    """Remainder of a right side."""
    for p in range(len(right)):
        total = right[p]
        for q in range(len(vector)):
            total -= matrix[p, q] * vector[q]
        rest[p] = total


@kernel
def complete(
    right: Floats,
    shared: Floats,
    blocks: tuple[Floats, Floats, Floats, Floats, Floats],
    inside: Floats,
    multipliers: Floats,
) -> None:
    """The step inside of every block, on from y0, and in its multipliers; both are filled."""
    inverse, _, inner, cross, follow = blocks
    rest = np.empty(inner.shape[2])
    for i in range(inner.shape[0]):
        for j in range(inner.shape[1]):
            for p in range(len(rest)):
                for a in range(SHARED):
                    inside[i, j, p] += follow[i, j, p, a] * shared[i, j, a]
            _remainder(right[i, j], inner[i, j], inside[i, j], rest)
            multipliers[i, j] = 0.0
            for p in range(len(rest)):
                for a in range(SHARED):
                    rest[p] -= cross[i, j, p, a] * shared[i, j, a]
                for c in range(3):
                    multipliers[i, j, c] += inverse[i, j, p, c] * rest[p]
