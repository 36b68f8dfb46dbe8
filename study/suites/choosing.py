"""Sums for every method and problem, from which the page makes the scores of the problems that are chosen."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from study.cases.suites import Suite
from study.report.live import data_element
from study.suites.measures import FAILED, NEAR, SHIFT, TIMES, Field
from study.suites.runs import Run
from study.suites.tables import chosen_traits


def score_sums(suite: Suite, field: Field) -> Markup:
    """Traits of all problems, and by method and problem: runs, feasible ones, logarithms of shifted gaps to the best known of any kind
    and of the own kind, and runs that are near within each of `TIMES`; `report.js` reads it."""
    problems = {run.problem: run for run in field.runs}
    numbers = {name: number for number, name in enumerate(problems)}
    traits = {head: [trait(run) for run in problems.values()] for head, trait in chosen_traits(suite).items()}
    methods: dict[str, list[list[float]]] = {}
    for method, runs in field.by_method.items():
        sums: dict[int, np.ndarray] = {}
        for run in runs:
            number = numbers[run.problem]
            sums[number] = sums.get(number, 0.0) + _parts(field, run)
        methods[method] = [[number, *(float(f"{value:.7g}") for value in row)] for number, row in sums.items()]
    return data_element({"traits": traits, "shift": SHIFT, "methods": methods}, "sums")


def _parts(field: Field, run: Run) -> np.ndarray:
    gaps = np.array([field.gap(run, own_kind) for own_kind in (False, True)])
    logs = np.log(np.clip(gaps, 0.0, FAILED) + SHIFT)
    near = [gaps[0] <= NEAR and run.wall_time <= limit for limit in TIMES]
    return np.array([1.0, run.feasible, *logs, *near])
