"""The law by which methods fall behind: gap to the curve's optimum against the number of segments, with bootstrap bands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby

import numpy as np

from study.analysis.formatting import percent, plural
from study.analysis.tables import Grid, markdown
from study.cases.records import known_times
from study.cases.suites import Suite
from study.comparison.statistics import Interval
from study.errors import StudyError
from study.planning import Freedom
from study.problem import Floats
from study.suites.measures import Field, best_in
from study.suites.runs import Run, read_runs, runs_file

RESAMPLES, LEVEL = 1000, 0.95
MARKS = (0.01, 0.1)
"""Gaps whose number of segments the law tells."""

VISIBLE = 1e-4
"""Gap from which on growth is fitted; below it a method has found the optimum."""

OF_THE_PAPERS = ("golds-pso", "dynamic-adaptive-pso", "chaotic-spso", "tadf-ssa", "smwoa")
"""The search that each of the five papers proposes."""

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
    runs = growing(field)
    key = lambda run: (run.evaluations, run.planner)  # noqa: E731
    grown = [_growth(field, list(group), seed) for _, group in groupby(sorted(runs, key=key), key)]
    return sorted(grown, key=lambda each: (each.evaluations, each.points[-1].gap.estimate))


def growing(field: Field) -> list[Run]:
    """Runs of searches on problems with the usual number of joints and no jerk limit, which differ by their segments."""
    usual = max((run.joints for run in field.runs), key=[run.joints for run in field.runs].count, default=0)
    return [r for r in field.runs if r.evaluations and r.joints == usual and not r.jerk and r.kind == Freedom.CURVE]


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
    """Slopes of the logarithm of the gap over that of the number of segments by least squares, where the gap is visible.

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
    """Tell the law of a suite's committed runs, budget by budget: a paragraph and a table in Markdown each.

    Raises
    ------
    StudyError
        If no runs of searches on growing problems are committed.
    """
    field = committed_field(suite)
    parts = []
    for budget in sorted({run.evaluations for run in field.runs if run.evaluations}):
        if text := paragraph(field, budget):
            table = law_grid(field, budget)
            parts += [text, markdown(table)]
    if not parts:
        raise StudyError(f"suite {suite.name!r} has no committed runs of searches on growing problems")
    return "\n\n".join(parts)


def law_in_markdown(suites: Sequence[Suite]) -> str:
    """Tell the law of several suites' committed runs at the largest budget, each in one point of a list."""
    fields = [(suite.name, committed_field(suite)) for suite in suites]
    return "\n".join(f"- *{name}*: {paragraph(field, largest_budget(field))}" for name, field in fields)


def committed_field(suite: Suite) -> Field:
    """Committed runs of a suite with the best known times."""
    runs = read_runs(runs_file(suite))
    return Field(tuple(runs), best_in(runs, known_times(suite)))


def _at_budget(field: Field, evaluations: int) -> list[Growth]:
    return [each for each in growths(field) if each.evaluations == evaluations and len(each.points) > 2]


def largest_budget(field: Field) -> int:
    """Largest budget of a search on growing problems; 0 where none was run."""
    return max((each.evaluations for each in growths(field) if len(each.points) > 2), default=0)


def paragraph(field: Field, evaluations: int) -> str:
    """Tell the law in numbers at one budget; empty where no search was run on growing problems."""
    grown = _at_budget(field, evaluations)
    if not grown:
        return ""
    first, last = grown[0].points[0].segments, grown[0].points[-1].segments
    joints = plural(max({run.joints for run in field.runs if run.segments == last}), "joint")
    passes = [at for each in grown if (at := each.passes[MARKS[0]]) is not None]
    powers = [each.exponent.estimate for each in grown if each.exponent]
    failed = sum(point.failed for each in grown for point in each.points)
    runs = sum(point.runs for each in grown for point in each.points)
    own = [each for each in grown if each.planner in OF_THE_PAPERS]
    papers = f", the papers' own searches {_range(own, -1)}" if own else ""
    growth = (
        f" Where it is visible it grows with the number of segments to the power of {min(powers):.1f} to {max(powers):.1f}."
        if powers
        else ""
    )
    passing = f" The gap passes 1 % at {min(passes):.0f} to {max(passes):.0f} segments." if passes else ""
    return (
        f"With {joints}, limits of velocity and acceleration and {evaluations:,} evaluations, the median gap of "
        f"{plural(len(grown), 'search')} to the optimum of the same curve is {_range(grown, 0)} at {first} segments and "
        f"{_range(grown, -1)} at {last}{papers}{_optimum(field, last)}.{passing}{growth} {failed} of {runs} runs brought no feasible "
        "motion; such a run counts as infinitely far behind."
    ).replace("searchs", "searches")


def _range(grown: Sequence[Growth], number: int) -> str:
    ranked = sorted(grown, key=lambda each: each.points[number].gap.estimate)
    low, high = (
        f"{percent(each.points[number].gap.estimate, signed=False)} ({each.planner})"
        for each in (ranked[0], ranked[-1])
    )
    return f"{low} to {high}"


def _optimum(field: Field, segments: int) -> str:
    walls = [r.wall_time for r in field.runs if r.planner == "casadi-nlp" and r.segments == segments and not r.jerk]
    return f"; casadi-nlp finds that optimum in {np.median(walls):.1f} s there" if walls else ""


def law_grid(field: Field, evaluations: int) -> Grid:
    """Table of the law at one budget: gaps with their bands, where they pass the marks, and the exponent."""
    grown = _at_budget(field, evaluations)
    sizes = [str(point.segments) for point in grown[0].points] if grown else []
    head = [
        "Search",
        *(f"{size} segments" for size in sizes),
        *(f"passes {percent(m, signed=False)}" for m in MARKS),
        "Power",
    ]
    rows = [
        [
            each.planner,
            *(_banded(point.gap) for point in each.points),
            *("–" if at is None else f"{at:.0f}" for at in each.passes.values()),
            "–"
            if each.exponent is None
            else f"{each.exponent.estimate:.1f} [{each.exponent.lower:.1f}, {each.exponent.upper:.1f}]",
        ]
        for each in grown
    ]
    caption = (
        f"Median gap to the optimum of the same curve at {evaluations:,} evaluations, the segments at which it passes a mark, and the "
        "power of the number of segments with which it grows where it is visible; in square brackets 95 % bootstrap intervals over "
        "problems and seeds."
    )
    return Grid(caption, head, rows)


def _banded(gap: Interval) -> str:
    if gap.upper < VISIBLE:
        return percent(gap.estimate, signed=False)
    low, high = percent(gap.lower, signed=False), percent(gap.upper, signed=False)
    return f"{percent(gap.estimate, signed=False)} [{low}, {high}]"
