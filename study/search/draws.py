"""Random numbers for runs side by side: each run draws from its own generator, exactly as it would alone."""

from __future__ import annotations

from dataclasses import dataclass

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


Rng = np.random.Generator | Generators
"""Where a search's random numbers come from: one run's generator, or those of runs side by side."""
