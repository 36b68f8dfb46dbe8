"""Scaling of a population's evaluation with waypoints, joints and population: time and peak memory."""

from __future__ import annotations

import tracemalloc
from collections.abc import Iterator
from dataclasses import dataclass

from study.bench.kernels import engines, peaks_call, sample
from study.bench.measuring import Call, interleaved

WAYPOINTS, JOINTS, POPULATIONS = (5, 10, 20, 50, 100, 200), (1, 2, 4, 6, 10, 14), (10, 100, 1000, 10_000, 100_000)
LABELS = {"poly353": "3-5-3", "cubic-spline": "cubic spline", "bspline": "B-spline"}
USUAL = 100, 6
"""Population and joints where neither grows."""


@dataclass(frozen=True)
class Point:
    """One size of one curve by one engine.

    Attributes
    ----------
    axis : str
        `waypoints`, `joints` or `population`: what grows.
    curve, engine : str
    size : int
    seconds : tuple of float
        For each candidate, of every repetition.
    peak_bytes : int
        Most memory that one evaluation of the population held, as Python's allocator counts it.
    """

    axis: str
    curve: str
    engine: str
    size: int
    seconds: tuple[float, ...]
    peak_bytes: int


def growth_points(repetitions: int) -> list[Point]:
    """Measure every size."""
    points = []
    for axis, size, curve, shape in _sizes():
        waypoints, durations = sample(*shape)
        calls = {by: peaks_call(curve, by, waypoints, durations, (1, 2)) for by in engines()}
        taken = interleaved(calls, repetitions, dict.fromkeys(calls, len(durations)))
        points += [Point(axis, curve, by, size, taken[by], peak_bytes(call)) for by, call in calls.items()]
    return points


def _sizes() -> Iterator[tuple[str, int, str, tuple[int, int, int]]]:
    """Axis, size, curve and (n_waypoints, n_joints, population) of every measurement."""
    population, joints = USUAL
    for curve in ("cubic-spline", "bspline"):
        for n in WAYPOINTS:
            yield "waypoints", n, curve, (n, joints, population)
    for curve, n_waypoints in (("poly353", 4), ("cubic-spline", 20)):
        for n in JOINTS:
            yield "joints", n, curve, (n_waypoints, n, population)
    for n in POPULATIONS:
        yield "population", n, "poly353", (4, joints, n)


def peak_bytes(call: Call) -> int:
    """Most memory held during a call, bytes, above what was held before; the call is made once before."""
    call()
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        call()
        return tracemalloc.get_traced_memory()[1] - before
    finally:
        tracemalloc.stop()
