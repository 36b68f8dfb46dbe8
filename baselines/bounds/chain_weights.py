"""Linear program for the best joint weights, given the chains of cells so far; see `baselines.bounds.lower_bounds`."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from study.problem import Floats


def chain_weights(pool: list[list[Floats]]) -> tuple[Floats, float]:
    """Maximise the sum over joints of the smallest weighted sum of times along the joint's chains.

    Parameters
    ----------
    pool : list of lists of arrays of shape (n_segments,), s
        For every joint the times along some chains.

    Returns
    -------
    weights : array of shape (n_segments, n_joints)
        They add up to 1 over the joints of every segment; equal ones where the solver gives up.
    value : float, s
        Infinite where the solver gives up.
    """
    n_joints, n_segments = len(pool), len(pool[0][0])
    blocks = [
        [sparse.csr_array(-np.array(chains)) if i == j else None for i in range(n_joints)]
        + [sparse.csr_array(np.ones((len(chains), 1))) if i == j else None for i in range(n_joints)]
        for j, chains in enumerate(pool)
    ]
    shares: Any = sparse.hstack(
        [sparse.kron(np.ones((1, n_joints)), sparse.eye(n_segments)), sparse.csr_array((n_segments, n_joints))]
    )
    rows: Any = sparse.block_array(blocks, format="csr")
    solved = linprog(
        np.append(np.zeros(n_joints * n_segments), -np.ones(n_joints)),
        A_ub=rows,
        b_ub=np.zeros(rows.shape[0]),
        A_eq=shares,
        b_eq=np.ones(n_segments),
        bounds=(0, None),
        method="highs",
    )
    if solved.x is None or solved.fun is None:
        return np.full((n_segments, n_joints), 1.0 / n_joints), np.inf
    weights = np.maximum(solved.x[: n_joints * n_segments], 0.0).reshape(n_joints, n_segments).T
    return weights / weights.sum(axis=1, keepdims=True), float(-solved.fun)
