"""The law by which methods fall behind: gap to the curve's optimum against the number of segments, with bootstrap bands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby

import numpy as np

from study.analysis.formatting import listed, percent, plural
from study.cases.records import known_times
from study.cases.suites import Suite
from study.comparison.statistics import Interval
from study.errors import StudyError
from study.planning import Freedom
from study.problem import Floats
from study.suites.measures import Field, Run, best_in, read_runs, runs_file

RESAMPLES, LEVEL = 1000, 0.95
MARKS = (0.01, 0.1)
"""Gaps whose number of segments the law tells."""

VISIBLE = 1e-4
"""Gap from which on growth is fitted; below it a method has found the optimum."""

LAST_RESORT = 10.0
"""Gap in the place of infinity where logarithms are taken."""


@dataclass(frozen=True)
class Point:
    """Median gap of a method at one number of segments, with its band."""

    segments: int
    gap: Interval
    runs: int
    failed: int


@dataclass(frozen=True)
class Growth:
    """One method over the number of segments.

    Attributes
    ----------
    planner : str
    evaluations : int
    points : tuple of Point
    exponent : Interval, optional
        Of the number of segments in the gap, fitted where the gap is visible; None with fewer than two such points.
    passes : mapping of float to float, optional
        Number of segments at which the median gap passes each of `MARKS`; None where it does not within the suite.
    """

    planner: str
    evaluations: int
    points: tuple[Point, ...]
    exponent: Interval | None
    passes: Mapping[float, float | None]


@lru_cache(maxsize=4)
def growths(field: Field, seed: int = 0) -> list[Growth]:
    """Growth of every search on problems with the usual number of joints and no jerk limit, by budget, worst last.

    The gap is to the best known motion of the same curve, so that nothing but the search is measured.

    Parameters
    ----------
    field : Field
    seed : int
        Of the bootstrap.
    """
    usual = max((run.joints for run in field.runs), key=[run.joints for run in field.runs].count, default=0)
    runs = [r for r in field.runs if r.evaluations and r.joints == usual and not r.jerk and r.kind == Freedom.CURVE]
    key = lambda run: (run.evaluations, run.planner)  # noqa: E731
    grown = [_growth(field, list(group), seed) for _, group in groupby(sorted(runs, key=key), key)]
    return sorted(grown, key=lambda each: (each.evaluations, each.points[-1].gap.estimate))


def _growth(field: Field, runs: Sequence[Run], seed: int) -> Growth:
    rng = np.random.default_rng(seed)
    by_size = {
        size: list(group) for size, group in groupby(sorted(runs, key=lambda r: r.segments), lambda r: r.segments)
    }
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
    slopes = np.array([_exponent(sizes, column) for column in drawn.T])
    slope, known = _exponent(sizes, estimates), slopes[np.isfinite(slopes)]
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


def _exponent(sizes: Floats, gaps: Floats) -> float:
    """Slope of the logarithm of the gap over that of the number of segments, where the gap is visible; NaN where it is not."""
    seen = gaps > VISIBLE
    if seen.sum() < 2:
        return np.nan
    return float(np.polyfit(np.log(sizes[seen]), np.log(np.minimum(gaps[seen], LAST_RESORT)), 1)[0])


def _passing(sizes: Floats, gaps: Floats, mark: float) -> float | None:
    """Number of segments at which the gap first passes a mark, between sizes on a logarithmic scale."""
    above = np.flatnonzero(gaps > mark)
    if not len(above):
        return None
    last = int(above[0])
    if last == 0:
        return float(sizes[0])
    low, high = np.log(np.clip(gaps[[last - 1, last]], VISIBLE, LAST_RESORT))
    share = (np.log(mark) - low) / (high - low)
    return float(np.exp(np.log(sizes[last - 1]) + share * (np.log(sizes[last]) - np.log(sizes[last - 1]))))


def committed_law(suite: Suite) -> str:
    """Tell the law of a suite's committed runs, budget by budget.

    Raises
    ------
    StudyError
        If no runs of searches on growing problems are committed.
    """
    runs = read_runs(runs_file(suite))
    field = Field(tuple(runs), best_in(runs, known_times(suite)))
    budgets = sorted({run.evaluations for run in runs if run.evaluations})
    texts = [text for budget in budgets if (text := paragraph(field, budget))]
    if not texts:
        raise StudyError(f"suite {suite.name!r} has no committed runs of searches on growing problems")
    return "\n\n".join(texts)


def paragraph(field: Field, evaluations: int | None = None) -> str:
    """Tell the law in numbers, at one budget, by default the largest; empty where no search was run on growing problems."""
    every = growths(field)
    budget = max((each.evaluations for each in every), default=0) if evaluations is None else evaluations
    grown = [each for each in every if each.evaluations == budget and len(each.points) > 2]
    if not grown:
        return ""
    sizes = [point.segments for point in grown[0].points]
    optimum = [run for run in field.runs if run.planner == "casadi-nlp" and run.segments == sizes[-1] and not run.jerk]
    took = (
        f", where casadi-nlp, the deterministic optimum, took {np.median([r.wall_time for r in optimum]):.1f} s"
        if optimum
        else ""
    )
    joints = plural(next(run.joints for run in field.runs if run.segments == sizes[-1]), "joint")
    failed = sum(point.failed for each in grown for point in each.points)
    runs = sum(point.runs for each in grown for point in each.points)
    return (
        f"With {joints}, limits of velocity and acceleration and {budget:,} evaluations, the median gap to the optimum of the same "
        f"curve at {sizes[0]} and at {sizes[-1]} segments is {listed([_spread(each) for each in grown])}{took}. It passes 1 % at "
        f"{listed([_passed(each, 0.01) for each in grown])}. Where it is visible the gap grows with the number of segments to the "
        f"power of {listed([_power(each) for each in grown if each.exponent])}. In square brackets are 95 % bootstrap intervals over "
        f"problems and seeds; {failed} of {runs} runs brought no feasible motion and count as infinitely far behind."
    )


def _spread(growth: Growth) -> str:
    first, last = growth.points[0].gap, growth.points[-1].gap
    band = f"[{percent(last.lower, signed=False)}, {percent(last.upper, signed=False)}]"
    return f"{percent(first.estimate, signed=False)} and {percent(last.estimate, signed=False)} {band} for {growth.planner}"


def _passed(growth: Growth, mark: float) -> str:
    at = growth.passes[mark]
    return f"{at:.0f} segments for {growth.planner}" if at is not None else f"none of these sizes for {growth.planner}"


def _power(growth: Growth) -> str:
    exponent = growth.exponent
    if exponent is None:
        return ""
    return f"{exponent.estimate:.1f} [{exponent.lower:.1f}, {exponent.upper:.1f}] for {growth.planner}"
