"""Time to target, expected running time, empirical distribution and anytime quartiles, from stored histories.

References
----------
Hansen, Auger, Ros, Mersmann, Tusar, Brockhoff: COCO, Optim. Methods Softw. 36 (2021).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from study.problem import Floats

TARGETS = (0.10, 0.05, 0.01, 0.001, 0.0001)
"""Fractions above the reference."""


def first_hit(history: Floats, target: float) -> float:
    """Evaluations after which the best value so far is at or below a target; infinity if it never is.

    Parameters
    ----------
    history : array of shape (n_records, 2)
        Evaluations so far and best value so far. Populations are recorded whole, so a hit is known to the generation.
    target : float
    """
    reached = history[:, 1] <= target
    return float(history[reached.argmax(), 0]) if reached.any() else np.inf


def hits(histories: Sequence[Floats], reference: float, targets: Sequence[float] = TARGETS) -> Floats:
    """Evaluations to every target of every run, shape (n_runs, n_targets).

    Parameters
    ----------
    histories : sequence of arrays of shape (n_records, 2)
    reference : float
        What the targets are fractions above.
    targets : sequence of float
    """
    costs = [[first_hit(history, reference * (1.0 + t)) for t in targets] for history in histories]
    return np.array(costs, dtype=float).reshape(-1, len(targets))


def average_runtime(hits: ArrayLike, spent: ArrayLike) -> float:
    """Evaluations to a target if a failed run is followed by another: all that was spent over the number of successes.

    Parameters
    ----------
    hits : array of shape (n_runs,)
        Evaluations to the target, infinity where it was missed.
    spent : array of shape (n_runs,)
        What each run cost in all; it counts only where the target was missed.

    Returns
    -------
    float
        Infinity if no run reached the target.
    """
    reached = np.isfinite(np.asarray(hits, dtype=float))
    if not reached.any():
        return np.inf
    return float(np.where(reached, hits, spent).sum() / reached.sum())


def ecdf(costs: ArrayLike, grid: ArrayLike) -> Floats:
    """Share of all (run, target) pairs reached within every cost of a grid, shape (n_grid,)."""
    flat = np.sort(np.ravel(np.asarray(costs, dtype=float)))
    return np.searchsorted(flat, np.asarray(grid, dtype=float), side="right") / flat.size


def on_grid(history: Floats, grid: Floats) -> Floats:
    """Best value so far at every number of evaluations of a grid; infinity before the first record."""
    row = np.searchsorted(history[:, 0], grid, side="right") - 1
    return np.where(row >= 0, history[np.maximum(row, 0), 1], np.inf)


def quartiles(histories: Sequence[Floats], grid: Floats) -> Floats:
    """Lower quartile, median and upper quartile over runs of the best value so far, shape (3, n_grid).

    Order statistics without interpolation, so that runs that have nothing yet (infinity) do no harm.
    """
    values = np.array([on_grid(history, grid) for history in histories])
    return np.quantile(values, [0.25, 0.5, 0.75], axis=0, method="higher")
