"""Compiled stretch factor and penalty; see `study.curves.demanded` and `penalised`."""

from __future__ import annotations

import math

import numpy as np

from study.curves.compiled.kernels import kernel
from study.problem import Floats


@kernel
def fill(peaks: Floats, limits: Floats, orders: tuple[int, ...], result: Floats) -> None:
    """Write the factors.

    Parameters
    ----------
    peaks : array of shape (n_candidates, n_orders, n_joints)
    limits : array of shape (n_orders, n_joints)
    orders : tuple of int
    result : array of shape (n_candidates,)
    """
    for i in range(peaks.shape[0]):
        result[i] = 0.0
        for k in range(len(orders)):
            ratio = 0.0
            for j in range(peaks.shape[2]):
                ratio = max(ratio, peaks[i, k, j] / limits[k, j])
            if orders[k] == 2:
                ratio = math.sqrt(ratio)
            elif orders[k] == 3:
                ratio = np.cbrt(ratio)
            result[i] = max(result[i], ratio)


@kernel
def penalise(durations: Floats, factors: Floats, charge: float, result: Floats) -> None:
    """Write penalised total times.

    Parameters
    ----------
    durations : array of shape (n_candidates, n_segments), s
    factors : array of shape (n_candidates,)
    charge : float, s
    result : array of shape (n_candidates,)
    """
    for i in range(durations.shape[0]):
        total = 0.0
        for k in range(durations.shape[1]):
            total += durations[i, k]
        result[i] = total + charge * factors[i] if factors[i] > 1.0 else total
