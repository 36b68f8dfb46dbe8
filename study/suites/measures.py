"""Measures over a suite: what was solved, how far behind the best known, and how fast; failures count and are never dropped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np

from study.suites.runs import Run

SHIFT = 0.01
"""Gap that is added before logarithms are averaged, and taken off afterwards."""

FAILED = 10.0
"""Gap that a run without a feasible motion counts with: eleven times the best known."""

NEAR = 0.01
"""Gap within which a problem counts as solved."""

TIMES = (0.1, 1.0, 10.0)
"""Seconds within which shares of solved problems are counted."""


@dataclass(frozen=True, eq=False)
class Field:
    """Runs of a suite against the best known times.

    Attributes
    ----------
    runs : tuple of Run
    best : mapping of (problem, kind) to float, s
        Best known of every kind of motion.
    """

    runs: tuple[Run, ...]
    best: Mapping[tuple[str, str], float]

    @cached_property
    def best_of_any(self) -> dict[str, float]:
        """Best known time of every problem, whatever the kind of motion, s."""
        known: dict[str, float] = {}
        for (problem, _), value in self.best.items():
            known[problem] = min(value, known.get(problem, np.inf))
        return known

    def gap(self, run: Run, own_kind: bool = True) -> float:
        """Duration above the best known, relative; infinite for a run without a feasible motion."""
        known = (
            self.best.get((run.problem, run.kind), np.inf) if own_kind else self.best_of_any.get(run.problem, np.inf)
        )
        return run.duration / known - 1.0 if run.feasible else np.inf

    @cached_property
    def by_method(self) -> dict[str, list[Run]]:
        """Runs of every method that brings motions, by name and budget."""
        moving = sorted((run for run in self.runs if run.kind != "bound"), key=lambda run: run.method)
        return {name: list(group) for name, group in groupby(moving, key=lambda run: run.method)}


def best_in(runs: Iterable[Run], known: Mapping[tuple[str, str], float] | None = None) -> dict[tuple[str, str], float]:
    """Best known time of every problem and kind of motion: the records, or what runs bring below them."""
    best = dict(known or {})
    for run in runs:
        if run.feasible:
            key = run.problem, run.kind
            best[key] = min(run.duration, best.get(key, np.inf))
    return best


def shifted_mean(gaps: Sequence[float]) -> float:
    """Shifted geometric mean of gaps, those of failures counted as `FAILED`."""
    counted = np.minimum(np.asarray(gaps, dtype=float), FAILED)
    return float(np.exp(np.log(np.maximum(counted, 0.0) + SHIFT).mean()) - SHIFT)


BROKEN = "breaks limits"


@dataclass(frozen=True)
class Score:
    """One method over a suite.

    Attributes
    ----------
    method, kind : str
    problems, runs, feasible : int
    near : float
        Share of runs within `NEAR` of the best known of any kind.
    within : tuple of float
        Share of runs that are near within each of `TIMES`.
    gap_own, gap_any : float
        Shifted geometric mean of the gap to the best known of the method's own kind, and of any.
    wall_time : float, s
        Median.
    failures : mapping of str to int
        Reasons, by how the runs ended.
    excess : float
        By how much more time the runs that break limits would keep them, the median; 0 where none does.
    """

    method: str
    kind: str
    problems: int
    runs: int
    feasible: int
    near: float
    within: tuple[float, ...]
    gap_own: float
    gap_any: float
    wall_time: float
    failures: Mapping[str, int]
    excess: float


def scores(field: Field) -> list[Score]:
    """Score every method, the smallest gap to the best known of any kind first."""
    return sorted(
        (_score(field, name, runs) for name, runs in field.by_method.items()), key=lambda score: score.gap_any
    )


def _score(field: Field, name: str, runs: Sequence[Run]) -> Score:
    gaps = np.array([field.gap(run, own_kind=False) for run in runs])
    walls = np.array([run.wall_time for run in runs])
    near = gaps <= NEAR
    broken = [run.stretch for run in runs if not run.feasible and _ending(run) == BROKEN]
    return Score(
        method=name,
        kind=runs[0].kind,
        problems=len({run.problem for run in runs}),
        runs=len(runs),
        feasible=sum(run.feasible for run in runs),
        near=float(near.mean()),
        within=tuple(float((near & (walls <= limit)).mean()) for limit in TIMES),
        gap_own=shifted_mean([field.gap(run) for run in runs]),
        gap_any=shifted_mean(gaps.tolist()),
        wall_time=float(np.median(walls)),
        failures=Counter(_ending(run) for run in runs if not run.feasible),
        excess=float(np.median(broken)) - 1.0 if broken else 0.0,
    )


def _ending(run: Run) -> str:
    if run.status == "NOT_APPLICABLE":
        return "does not apply"
    if np.isfinite(run.duration):
        return BROKEN if run.stretch > 1.0 else "misses another demand"
    return "out of time" if run.status == "TIMED_OUT" else "no motion"


def table_of_problems(field: Field) -> tuple[list[str], list[str], np.ndarray]:
    """Methods, problems and the median duration of every method on every problem, infinite where it failed."""
    methods = sorted(field.by_method)
    problems = sorted({run.problem for run in field.runs})
    values = np.full((len(problems), len(methods)), np.inf)
    for column, name in enumerate(methods):
        for problem, group in groupby(
            sorted(field.by_method[name], key=lambda run: run.problem), lambda run: run.problem
        ):
            durations = [run.duration if run.feasible else np.inf for run in group]
            values[problems.index(problem), column] = np.quantile(durations, 0.5, method="higher")
    return methods, problems, values
