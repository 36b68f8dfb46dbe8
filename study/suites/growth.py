"""Growth of the gap to the curve's optimum with the size of the problem, segments or joints, with bootstrap bands."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby
from operator import attrgetter
from typing import Literal

import numpy as np

from study.comparison.statistics import Interval
from study.planning import Freedom
from study.problem import Floats
from study.suites.measures import Field
from study.suites.runs import Run

Axis = Literal["segments", "joints"]
"""Size that grows; the other one stays as it is."""

RESAMPLES, LEVEL = 1000, 0.95
MARKS = (0.01, 0.1)
"""Gaps whose size the law tells."""

VISIBLE = 1e-4
"""Gap from which on growth is fitted; below it a method has found the optimum."""

LAST_RESORT = 10.0
"""Gap in the place of infinity where logarithms are taken."""


@dataclass(frozen=True)
class Point:
    """Median gap of a method at one size, with its band."""

    size: int
    gap: Interval
    runs: int
    failed: int


@dataclass(frozen=True)
class Growth:
    """One method over the size.

    Attributes
    ----------
    planner : str
    evaluations : int
    points : tuple of Point
    exponent : Interval, optional
        Of the size in the gap, fitted where the gap is visible; None with fewer than two such points.
    passes : mapping of float to float, optional
        Size at which the median gap passes each of `MARKS`; None where it does not within the suite.
    """

    planner: str
    evaluations: int
    points: tuple[Point, ...]
    exponent: Interval | None
    passes: Mapping[float, float | None]


@lru_cache(maxsize=16)
def growths(field: Field, axis: Axis = "segments", jerk: bool = False, seed: int = 0) -> list[Growth]:
    """Growth of every search on problems that differ by one size alone, by budget, worst last.

    The gap is to the best known motion of the same curve, so that nothing but the search is measured.

    Parameters
    ----------
    field : Field
    axis : str
        `segments` or `joints`.
    jerk : bool
        Whether the problems limit jerk.
    seed : int
        Of the bootstrap.
    """
    runs = growing(field, axis, jerk)
    key = lambda run: (run.evaluations, run.planner)  # noqa: E731
    grown = [_growth(field, list(group), axis, seed) for _, group in groupby(sorted(runs, key=key), key)]
    return sorted(grown, key=lambda each: (each.evaluations, each.points[-1].gap.estimate))


def growing(field: Field, axis: Axis = "segments", jerk: bool = False) -> list[Run]:
    """Runs of searches on the curve that differ by one size: with the usual number of joints, or the segments of most numbers of joints."""
    usual: int
    if axis == "segments":
        joints = [run.joints for run in field.runs]
        usual = max(joints, key=joints.count, default=0)
    else:
        pairs = {(run.segments, run.joints) for run in field.runs}
        segments = sorted(size for size, _ in pairs)
        usual = max(segments, key=segments.count, default=0)
    other = attrgetter("joints" if axis == "segments" else "segments")
    return [r for r in field.runs if r.evaluations and other(r) == usual and r.jerk is jerk and r.kind == Freedom.CURVE]


def _growth(field: Field, runs: Sequence[Run], axis: Axis, seed: int) -> Growth:
    rng = np.random.default_rng(seed)
    size_of: Callable[[Run], int] = attrgetter(axis)
    by_size = {size: list(group) for size, group in groupby(sorted(runs, key=size_of), size_of)}
    sizes = np.array(list(by_size))
    gaps = [_table(field, group) for group in by_size.values()]
    drawn = np.array([_medians(rows, rng) for rows in gaps])
    estimates = np.array([_median(np.concatenate(rows)) for rows in gaps])
    points = [
        Point(
            int(size),
            Interval(float(now), *_ends(band)),
            sum(map(len, rows)),
            int(sum(np.isinf(r).sum() for r in rows)),
        )
        for size, now, band, rows in zip(sizes, estimates, drawn, gaps, strict=True)
    ]
    slopes = _exponents(sizes, drawn)
    slope, known = float(_exponents(sizes, estimates[:, None])[0]), slopes[np.isfinite(slopes)]
    exponent = Interval(slope, *_ends(known)) if np.isfinite(slope) and len(known) > len(slopes) / 2 else None
    passes = {mark: _passing(sizes, estimates, mark) for mark in MARKS}
    return Growth(runs[0].planner, runs[0].evaluations, tuple(points), exponent, passes)


def _table(field: Field, runs: Sequence[Run]) -> list[Floats]:
    """Gaps of every problem's runs."""
    ordered = sorted(runs, key=lambda run: run.problem)
    return [np.array([field.gap(run) for run in group]) for _, group in groupby(ordered, lambda run: run.problem)]


def _median(gaps: Floats) -> float:
    return float(np.quantile(gaps, 0.5, method="higher"))


def _medians(rows: Sequence[Floats], rng: np.random.Generator) -> Floats:
    """Medians of resamples, of the problems first and then of the runs on each, shape (RESAMPLES,)."""
    width = max(map(len, rows))
    table = np.array([np.resize(row, width) for row in rows])  # a run that was stopped may lack some seeds
    chosen = rng.integers(len(rows), size=(RESAMPLES, len(rows), 1))
    drawn = table[chosen, rng.integers(width, size=(RESAMPLES, len(rows), width))].reshape(RESAMPLES, -1)
    return np.asarray(np.quantile(drawn, 0.5, axis=1, method="higher"))


def _ends(values: Floats) -> tuple[float, float]:
    ends = np.quantile(values, [(1 - LEVEL) / 2, (1 + LEVEL) / 2], method="nearest")
    return float(ends[0]), float(ends[1])


def _exponents(sizes: Floats, gaps: Floats) -> Floats:
    """Slopes of the logarithm of the gap over that of the size by least squares, where the gap is visible.

    Parameters
    ----------
    sizes : array of shape (n_sizes,)
    gaps : array of shape (n_sizes, n_resamples)

    Returns
    -------
    array of shape (n_resamples,)
        NaN where fewer than two gaps are visible.
    """
    seen = gaps > VISIBLE
    logs = np.log(np.clip(gaps, VISIBLE, LAST_RESORT))
    n = np.maximum(seen.sum(axis=0), 1)
    apart = np.where(seen, np.log(sizes)[:, None] - (np.log(sizes)[:, None] * seen).sum(axis=0) / n, 0.0)
    spread = (apart**2).sum(axis=0)
    slopes: Floats = (apart * logs).sum(axis=0) / np.where(n > 1, spread, np.nan)
    return slopes


def _passing(sizes: Floats, gaps: Floats, mark: float) -> float | None:
    """Size at which the gap first passes a mark, between sizes on a logarithmic scale."""
    above = np.flatnonzero(gaps > mark)
    if not len(above):
        return None
    last = int(above[0])
    if last == 0:
        return float(sizes[0])
    low, high = np.log(np.clip(gaps[[last - 1, last]], VISIBLE, LAST_RESORT))
    share = (np.log(mark) - low) / (high - low)
    return float(np.exp(np.log(sizes[last - 1]) + share * (np.log(sizes[last]) - np.log(sizes[last - 1]))))
