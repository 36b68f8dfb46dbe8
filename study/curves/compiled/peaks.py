"""Peak rates of the curve families by compiled kernels; importing this file imports numba.

Each agrees with its NumPy form to rounding (1e-12 of the peak). Without the jerk of the B-spline and without the smooth
spline, which no published case needs, so that these stay with NumPy.
"""

from __future__ import annotations

import time
from functools import lru_cache

import numpy as np

from study.curves import bspline, poly353
from study.curves.compiled import bspline as compiled_bspline
from study.curves.compiled import cubic_spline as compiled_spline
from study.curves.compiled import demand as compiled_demand
from study.curves.compiled import poly353 as compiled_353
from study.problem import Floats

Orders = tuple[int, ...]


def _in_order(result: Floats, orders: Orders) -> Floats:
    """View rows by order as the NumPy path lays them out, shape (n_candidates, len(orders), n_joints)."""
    first, last = orders[0], orders[-1]
    neighbours = last - first + 1 == len(orders)  # these need no copy
    rows = slice(first - 1, last) if neighbours else [order - 1 for order in orders]
    return result[rows].transpose(2, 0, 1)


def peaks_353(waypoints: Floats, durations: Floats, orders: Orders = (1, 2, 3)) -> Floats:
    """Peak rates of the 3-5-3 curve; see `study.curves.poly353.peaks`.

    Raises
    ------
    StudyError
        If there are not four waypoints.
    """
    poly353.check_waypoints(waypoints)
    result = np.empty((3 if 3 in orders else 2, waypoints.shape[1], len(durations)))
    compiled_353.fill(waypoints, np.ascontiguousarray(durations), result)
    return _in_order(result, orders)


def peaks_spline(waypoints: Floats, durations: Floats, orders: Orders = (1, 2, 3)) -> Floats:
    """Peak rates of the clamped cubic spline; see `study.curves.cubic_spline.peaks`."""
    result = np.empty((3, waypoints.shape[1], len(durations)))
    compiled_spline.fill(waypoints, np.ascontiguousarray(durations), result)
    return _in_order(result, orders)


def peaks_bspline(waypoints: Floats, durations: Floats, orders: Orders = (1, 2, 3)) -> Floats:
    """Peak rates of the parametric B-spline; see `study.curves.bspline.peaks`."""
    if 3 in orders:
        return bspline.peaks(waypoints, durations, orders)
    powers = np.array([1.0, 2.0, 3.0])
    position = np.ascontiguousarray(np.moveaxis(bspline.unit_coefficients(waypoints), 1, 2)[:, :, 1:] * powers)
    result = np.empty((2, waypoints.shape[1], len(durations)))
    compiled_bspline.fill(position, _unit_rates(durations.shape[1]), np.ascontiguousarray(durations), result)
    return _in_order(result, orders)


@lru_cache
def _unit_rates(n_segments: int) -> Floats:
    """t'(u) of each unit duration, shape (n_segments, 3, n_segments): the same for every candidate."""
    unit = np.moveaxis(bspline.time_coefficients(np.eye(n_segments)), 0, -1)[:, 1:]
    return np.ascontiguousarray(unit * np.array([1.0, 2.0, 3.0])[:, None])


def demand(peaks: Floats, limits: Floats, orders: Orders) -> Floats:
    """Factor on all durations that peak rates demand; see `study.curves.demanded`."""
    result = np.empty(len(peaks))
    compiled_demand.fill(peaks, limits, orders, result)
    return result


def penalty(durations: Floats, factors: Floats, charge: float) -> Floats:
    """Penalised total times; see `study.curves.penalised`."""
    result = np.empty(len(durations))
    compiled_demand.penalise(durations, factors, charge, result)
    return result


PEAKS = {"poly353": peaks_353, "cubic-spline": peaks_spline, "bspline": peaks_bspline}


def warm_up() -> dict[str, float]:
    """Compile every kernel, or read it from numba's cache; seconds for each curve."""
    seconds = {}
    for name, peaks in PEAKS.items():
        begun = time.perf_counter()
        peaks(np.arange(4.0)[:, None], np.ones((2, 3)), (1, 2))
        seconds[name] = time.perf_counter() - begun
    return seconds
