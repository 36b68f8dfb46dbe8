"""The law by which methods fall behind: gap to the curve's optimum against the number of segments, with bootstrap bands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from study.analysis.formatting import percent, plural
from study.analysis.tables import Grid, markdown
from study.cases.records import known_times
from study.cases.suites import Suite
from study.comparison.statistics import Interval
from study.errors import StudyError
from study.suites.growth import MARKS, VISIBLE, Axis, Growth, growths
from study.suites.measures import Field, best_in
from study.suites.runs import read_runs, runs_file

OF_THE_PAPERS = ("golds-pso", "dynamic-adaptive-pso", "chaotic-spso", "tadf-ssa", "smwoa")
"""The search that each of the five papers proposes."""


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
    """Tell the law of several suites' committed runs, each in one point of a list, at the largest budget that all have."""
    fields = [(suite.name, committed_field(suite)) for suite in suites]
    budget = min(largest_budget(field) for _, field in fields)
    return "\n".join(f"- *{name}*: {paragraph(field, budget)}" for name, field in fields)


def committed_field(suite: Suite) -> Field:
    """Committed runs of a suite with the best known times."""
    runs = read_runs(runs_file(suite))
    return Field(tuple(runs), best_in(runs, known_times(suite)))


def grown_at(field: Field, evaluations: int, axis: Axis = "segments", jerk: bool = False) -> list[Growth]:
    """Growth at one budget of the searches that were run on at least three sizes."""
    return [each for each in growths(field, axis, jerk) if each.evaluations == evaluations and len(each.points) > 2]


def largest_budget(field: Field) -> int:
    """Largest budget with which searches were run on the largest of growing problems; 0 where none was run."""
    reached = [(each.points[-1].size, each.evaluations) for each in growths(field) if len(each.points) > 2]
    return max(reached, default=(0, 0))[1]


def paragraph(field: Field, evaluations: int) -> str:
    """Tell the law in numbers at one budget, of the searches that were run on every size; empty where none was."""
    known = grown_at(field, evaluations)
    most = max((len(each.points) for each in known), default=0)
    grown = [each for each in known if len(each.points) == most]
    if not grown:
        return ""
    first, last = grown[0].points[0].size, grown[0].points[-1].size
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


def law_grid(field: Field, evaluations: int, axis: Axis = "segments", jerk: bool = False) -> Grid:
    """Table of the law at one budget: gaps with their bands, where they pass the marks, and the exponent."""
    grown = grown_at(field, evaluations, axis, jerk)
    sizes = sorted({point.size for each in grown for point in each.points})
    head = ["Search", *(plural(size, axis[:-1]) for size in sizes), *(f"passes {100 * m:g} %" for m in MARKS), "Power"]
    rows = []
    for each in grown:
        gaps = {point.size: _banded(point.gap) for point in each.points}
        passes = ["–" if at is None else f"{at:.0f}" for at in each.passes.values()]
        power = each.exponent
        told = "–" if power is None else f"{power.estimate:.1f} [{power.lower:.1f}, {power.upper:.1f}]"
        rows.append([each.planner, *(gaps.get(size, "–") for size in sizes), *passes, told])
    caption = (
        f"Median gap to the optimum of the same curve at {evaluations:,} evaluations, {'with' if jerk else 'without'} jerk limits, the "
        f"{axis} at which it passes a mark, and the power of the number of {axis} with which it grows where it is visible; in square "
        "brackets 95 % bootstrap intervals over problems and seeds."
    )
    return Grid(caption, head, rows)


def _banded(gap: Interval) -> str:
    if gap.upper < VISIBLE:
        return percent(gap.estimate, signed=False)
    low, high = percent(gap.lower, signed=False), percent(gap.upper, signed=False)
    return f"{percent(gap.estimate, signed=False)} [{low}, {high}]"
