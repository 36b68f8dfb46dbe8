"""A generator that draws chosen numbers, for steps worked by hand."""

from __future__ import annotations

import numpy as np


class Fixed:
    """Every uniform number is `u`, every normal number `z`, every integer the lowest."""

    def __init__(self, u: float, z: float = 1.0) -> None:
        self.u, self.z = u, z

    def random(self, size=None):
        return self.u if size is None else np.full(size, self.u)

    def standard_normal(self, size=None):
        return self.z if size is None else np.full(size, self.z)

    def integers(self, high, size=None, dtype=int, endpoint=False):
        return np.zeros(size, dtype=dtype)

    def permutation(self, n):
        return np.arange(n)
