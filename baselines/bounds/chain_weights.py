"""Linear program for the best weights of strands, given some chains of cells; see `baselines.bounds.lower_bounds`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import linprog

from study.problem import Floats

Covers = list[NDArray[np.intp]]
"""For every strand the part of it that each segment of the problem lies in, shape (n_segments,)."""


def chain_weights(pool: list[list[Floats]], covers: Covers) -> tuple[list[Floats], float]:
    """Maximise the sum over strands of the smallest weighted sum of times along the strand's chains.

    Parameters
    ----------
    pool : list of lists of arrays of shape (n_parts,), s
        For every strand the times along some chains.
    covers : list of arrays of shape (n_segments,)

    Returns
    -------
    weights : list of arrays of shape (n_parts,)
        In every segment of the problem they add up to at most 1; equal ones where the solver gives up.
    value : float, s
        Infinite where the solver gives up.
    """
    blocks = [
        [sparse.csr_array(-np.array(chains)) if i == j else None for i in range(len(pool))]
        + [sparse.csr_array(np.ones((len(chains), 1))) if i == j else None for i in range(len(pool))]
        for j, chains in enumerate(pool)
    ]
    chains: Any = sparse.block_array(blocks, format="csr")
    shares: Any = sparse.hstack([sparse.eye_array(int(cover[-1]) + 1, format="csr")[cover] for cover in covers])
    empty: Any = sparse.csr_array((shares.shape[0], len(pool)))
    solved = linprog(
        np.append(np.zeros(shares.shape[1]), -np.ones(len(pool))),
        A_ub=sparse.vstack([chains, sparse.hstack([shares, empty])], format="csr"),
        b_ub=np.append(np.zeros(chains.shape[0]), np.ones(shares.shape[0])),
        bounds=(0, None),
        method="highs",
    )
    if solved.x is None or solved.fun is None:
        return equal_weights(covers), np.inf
    ends = np.cumsum([cover[-1] + 1 for cover in covers])
    return within_one(np.split(np.maximum(solved.x[: ends[-1]], 0.0), ends[:-1]), covers), float(-solved.fun)


def equal_weights(covers: Covers) -> list[Floats]:
    """The same weight for every part of every strand."""
    return [np.full(int(cover[-1]) + 1, 1.0 / len(covers)) for cover in covers]


def within_one(weights: list[Floats], covers: Covers) -> list[Floats]:
    """Lower weights until they add up to at most 1 in every segment."""
    total = np.maximum(np.sum([weight[cover] for weight, cover in zip(weights, covers, strict=True)], axis=0), 1.0)
    result = []
    for weight, cover in zip(weights, covers, strict=True):
        largest = np.ones(len(weight))
        np.maximum.at(largest, cover, total)
        result.append(weight / largest)
    return result
