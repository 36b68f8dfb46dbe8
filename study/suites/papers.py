"""The papers' cases among the suites: each with its own paper's search, from the committed runs."""

from __future__ import annotations

from statistics import median

from study.cases.suites import PAPERS, suite_named
from study.suites.law import committed_field
from study.suites.measures import Field
from study.suites.runs import Run, runs_file


def papers_marks() -> list[tuple[str, int, float, str]]:
    """Case, segments, median gap to the optimum of its curve, and its own paper's search, at the largest committed budget;
    empty where no runs of the papers are committed."""
    suite = suite_named(PAPERS)
    if not runs_file(suite).is_file():
        return []
    field = committed_field(suite)
    marks = []
    for name, case in suite.cases.items():
        own = [run for run in field.runs if run.problem == name and run.planner == case.planner]
        if own:
            marks.append((name, case.problem.n_segments, _gap(field, own), case.planner))
    return marks


def _gap(field: Field, runs: list[Run]) -> float:
    budget = max(run.evaluations for run in runs)
    return median(field.gap(run) for run in runs if run.evaluations == budget)
