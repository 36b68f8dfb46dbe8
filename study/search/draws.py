"""Random numbers for runs side by side: each run draws from its own generator, exactly as it would alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from study.problem import Floats


@dataclass(frozen=True)
class Generators:
    """The generators of several runs, in the place of one.

    Attributes
    ----------
    each : tuple of numpy.random.Generator
    """

    each: tuple[np.random.Generator, ...]

    def random(self, shape: tuple[int, ...] = (1, 1)) -> Floats:
        """Draw uniform numbers in [0, 1).

        Parameters
        ----------
        shape : tuple of ints
            Of one run's numbers: a population's (n_candidates, n_dimensions), or several of them, (k, n_candidates,
            n_dimensions). Without it each run draws a single number.

        Returns
        -------
        array of shape (n_runs, n_candidates, n_dimensions), or (k, n_runs, n_candidates, n_dimensions)
        """
        drawn = np.empty((len(self.each), *shape))
        for rng, one in zip(self.each, drawn, strict=True):
            rng.random(out=one)
        return drawn.swapaxes(0, len(shape) - 2)

    def standard_normal(self, shape: tuple[int, ...]) -> Floats:
        """Draw normal numbers, laid out as those of `random`."""
        drawn = np.stack([rng.standard_normal(shape) for rng in self.each])
        return drawn.swapaxes(0, len(shape) - 2)

    def permutation(self, n: int) -> np.ndarray:
        """Shuffle the numbers from 0 to n - 1 for each run, shape (n_runs, n)."""
        return np.stack([rng.permutation(n) for rng in self.each])

    def integers(self, below: int | np.ndarray, size: tuple[int, ...] | None = None) -> np.ndarray:
        """Draw whole numbers from 0, below a bound or an array of bounds; laid out as those of `random`.

        Parameters
        ----------
        below : int or array
        size : tuple of ints, optional
            Of one run's numbers, at least two, as in `random`; that of the bounds if left out.
        """
        drawn = np.stack([rng.integers(below, size=size) for rng in self.each])
        return drawn.swapaxes(0, drawn.ndim - 3)


def places(rows: np.ndarray) -> Any:
    """Index of members by number, shape (n,) or (..., n_runs, n), each run its own."""
    return rows if rows.ndim == 1 else (np.arange(rows.shape[-2])[:, None], rows)


def members_at(x: Floats, rows: np.ndarray) -> Floats:
    """Look members up by number, each run its own.

    Parameters
    ----------
    x : array of shape (n_candidates, n_dimensions) or (n_runs, n_candidates, n_dimensions)
    rows : int array of shape (..., n_candidates) or (..., n_runs, n_candidates)
    """
    return x.take(rows, axis=0) if x.ndim == 2 else x[places(rows)]


def coordinates_at(x: Floats, rows: np.ndarray) -> Floats:
    """Look coordinates up by the number of the member, as `members_at`; `rows` has an axis of dimensions, or of length 1."""
    columns = np.arange(x.shape[-1])
    return x[rows, columns] if x.ndim == 2 else x[np.arange(len(x))[:, None, None], rows, columns]


Rng = np.random.Generator | Generators
"""Where a search's random numbers come from: one run's generator, or those of runs side by side."""
