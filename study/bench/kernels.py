"""Peak rates of whole populations against the papers' way, compiled and in NumPy."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from study import engine
from study.bench import papers_way
from study.bench.measuring import Call, Measurement, interleaved
from study.curves import CURVES
from study.curves.compiled import with_engine
from study.problem import Floats

TOPIC = "Kernels"
POPULATION = 100
FEW = 4
"""Candidates that the papers' way works off in one measured call; it takes as long for each."""

TARGETS = {("poly353", "numba"): 2000.0, ("poly353", "numpy"): 150.0}
TARGETS |= {("cubic-spline", "numba"): 700.0, ("cubic-spline", "numpy"): 100.0}
SETTINGS = {
    "poly353": ("3-5-3, 6 joints", 4, 6, (1, 2)),
    "cubic-spline": ("cubic spline, 19 segments, 5 joints", 20, 5, (1, 2, 3)),
}


def engines() -> tuple[str, ...]:
    """Engines that can be measured here."""
    return (engine.NUMPY, engine.NUMBA) if engine.installed() else (engine.NUMPY,)


def sample(n_waypoints: int, n_joints: int, population: int, seed: int = 1) -> tuple[Floats, Floats]:
    """Random waypoints and durations of a population."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n_waypoints, n_joints)), rng.uniform(0.8, 1.6, (population, n_waypoints - 1))


def peaks_call(curve: str, by: str, waypoints: Floats, durations: Floats, orders: tuple[int, ...]) -> Call:
    """Evaluate a population once, by one engine."""
    chosen = with_engine(CURVES[curve]) if by == engine.NUMBA else CURVES[curve]
    return lambda: chosen.peaks(waypoints, durations, orders)


def kernel_rows(repetitions: int) -> list[Measurement]:
    """Measure both curve families that have a papers' way."""
    rows = []
    for curve, (label, n_waypoints, n_joints, orders) in SETTINGS.items():
        waypoints, durations = sample(n_waypoints, n_joints, POPULATION)
        peaks = papers_way.peaks_353 if curve == "poly353" else papers_way.peaks_spline
        calls: dict[str, Call] = {"papers": partial(_papers, peaks, waypoints, durations)}
        calls |= {by: peaks_call(curve, by, waypoints, durations, orders) for by in engines()}
        counts = {"papers": FEW} | dict.fromkeys(engines(), POPULATION)
        taken = interleaved(calls, repetitions, counts)
        for by in (engine.NUMBA, engine.NUMPY):
            name, target = f"{label}, {by}", TARGETS[curve, by]
            seconds, absent = ((taken[by], taken["papers"]), "") if by in taken else (((), ()), NOT_THERE)
            rows.append(Measurement(TOPIC, name, "the papers' way", "candidate", *seconds, target, absent))
    return rows + _bspline_rows(repetitions)


def _papers(peaks: Callable[[Floats, Floats], Floats], waypoints: Floats, durations: Floats) -> None:
    for row in durations[:FEW]:
        peaks(waypoints, row)


NOT_THERE = "numba is not installed; install the extra `fast`"


def _bspline_rows(repetitions: int) -> list[Measurement]:
    """B-spline, compiled against NumPy: no library has its exact extrema, so it has no papers' way."""
    label, peer = "B-spline, 5 segments, 6 joints, numba", "NumPy"
    if not engine.installed():
        return [Measurement(TOPIC, label, peer, "", missing=NOT_THERE)]
    waypoints, durations = sample(6, 6, POPULATION)
    calls = {by: peaks_call("bspline", by, waypoints, durations, (1, 2)) for by in engines()}
    taken = interleaved(calls, repetitions, dict.fromkeys(calls, POPULATION))
    return [Measurement(TOPIC, label, peer, "candidate", taken[engine.NUMBA], taken[engine.NUMPY])]
