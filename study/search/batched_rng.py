"""Random numbers for batched runs: every run draws from its own generator, exactly as it would alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.problem import Floats


@dataclass(frozen=True)
class BatchedRng:
    """The random generators of several runs, called as one.

    Attributes
    ----------
    rngs : tuple of numpy.random.Generator
        One for each run.
    """

    rngs: tuple[np.random.Generator, ...]

    def random(self, shape: tuple[int, ...] = (1, 1)) -> Floats:
        """Draw uniform numbers in [0, 1).

        Parameters
        ----------
        shape : tuple of ints
            Of one run's numbers: a population's (n_candidates, n_dimensions), or several of them, (k, n_candidates,
            n_dimensions). Without a shape each run draws a single number.

        Returns
        -------
        array of shape (n_runs, n_candidates, n_dimensions), or (k, n_runs, n_candidates, n_dimensions)
        """
        numbers = np.empty((len(self.rngs), *shape))
        for rng, own in zip(self.rngs, numbers, strict=True):
            rng.random(out=own)
        return numbers.swapaxes(0, len(shape) - 2)

    def integers(self, below: int | np.ndarray, size: tuple[int, ...] | None = None) -> np.ndarray:
        """Draw whole numbers from 0, below a bound or an array of bounds; laid out as those of `random`.

        Parameters
        ----------
        below : int or array
        size : tuple of ints, optional
            Of one run's numbers, at least two axes, as in `random`; that of the bounds if left out.
        """
        numbers = np.stack([rng.integers(below, size=size) for rng in self.rngs])
        return numbers.swapaxes(0, numbers.ndim - 3)


def members_at(x: Floats, rows: np.ndarray) -> Floats:
    """Look up the members of a population by number, for batched runs each in its own population.

    Parameters
    ----------
    x : array of shape (n_candidates, n_dimensions) or (n_runs, n_candidates, n_dimensions)
    rows : int array of shape (..., n_candidates) or (..., n_runs, n_candidates)
    """
    return x.take(rows, axis=0) if x.ndim == 2 else x[np.arange(len(x))[:, None], rows]


Rng = np.random.Generator | BatchedRng
"""Random numbers of a search: the generator of one run, or those of batched runs."""
