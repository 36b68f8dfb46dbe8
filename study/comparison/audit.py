"""The invariance audit: does a search's result depend on where the origin is, or on how the durations are written?

References
----------
Kudela, A critical problem in benchmarking and analysis of evolutionary computation methods, Nat. Mach. Intell. 4
(2022); The evolutionary computation methods no one should use (2023): the ratio of the errors with the optimum moved
away from and at the centre, its geometric mean over functions, and the alarm level of 10.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.analysis.formatting import ratio as times
from study.cases.library import Case
from study.comparison import statistics, tasks
from study.comparison.effort import Effort
from study.comparison.trials import Trial, TrialJob, TrialOutcome, repeated
from study.planners.segment_times import SegmentTimePlanner
from study.registry import planner_named, planner_names, unavailable_planners
from study.search.state import Search

ALARM = 10.0
FLOOR = 1e-8
"""Errors below it count as it, so that a ratio of two numbers that are both as good as zero is 1."""

AXES = "↻"
"""Marks a search whose error grows beyond the alarm when the axes are turned."""

SIGNIFICANT = 0.05
Outcomes = Mapping[Trial, TrialOutcome]


def audited_searches(printed: bool) -> dict[str, Search[Any]]:
    """Searches of all installed segment-time planners, by planner name; as-printed readings only if asked for."""
    broken = unavailable_planners()
    planners = {name: planner_named(name) for name in planner_names() if name not in broken}
    return {
        name: planner.search
        for name, planner in planners.items()
        if isinstance(planner, SegmentTimePlanner) and (printed or not name.endswith("-as-printed"))
    }


def function_jobs(searches: Mapping[str, Search[Any]], effort: Effort) -> list[TrialJob]:
    """List every search on every view of every function, from every seed."""
    budget = effort.population * effort.generations
    return [
        job
        for name, search in searches.items()
        for function in effort.functions
        for view in (tasks.FUNCTION_VIEWS if function in effort.dosed else (tasks.ORIGIN, tasks.SHIFTED, tasks.ROTATED))
        for job in repeated(
            Trial(name, function, view, 0, budget, effort.population, effort.dimensions), search, effort.function_seeds
        )
    ]


def trajectory_jobs(
    searches: Mapping[str, Search[Any]],
    cases: Iterable[Case],
    effort: Effort,
    formulations: Sequence[str],
) -> list[TrialJob]:
    """List every search on every view of every case's durations, from every seed."""
    n, population = effort.trial_evaluations, effort.population
    return [
        job
        for name, search in searches.items()
        for case in cases
        for formulation in formulations
        for view in tasks.TRAJECTORY_VIEWS
        for job in repeated(
            Trial(name, case.name, view, 0, n, population, formulation=formulation),
            search,
            effort.trial_seeds,
            case.problem,
            case.curve,
        )
    ]


def grouped(outcomes: Outcomes) -> dict[tuple[str, str, str, str], np.ndarray]:
    """Values by (search, task, formulation, view), in the order of the seeds."""
    found: dict[tuple[str, str, str, str], list[float]] = {}
    for trial in sorted(outcomes, key=lambda trial: trial.seed):
        found.setdefault((trial.search, trial.task, trial.formulation, trial.view), []).append(outcomes[trial].value)
    return {key: np.array(values) for key, values in found.items()}


Average = Callable[[np.ndarray], Any]


def error_ratio(moved: np.ndarray, home: np.ndarray, average: Average = np.mean) -> float:
    """Average error in one view over that in another, neither taken below the floor."""
    return float(max(float(average(moved)), FLOOR) / max(float(average(home)), FLOOR))


def geometric_mean(ratios: Sequence[float]) -> float:
    """Geometric mean; not a number where there is none."""
    return float(np.exp(np.mean(np.log(ratios)))) if len(ratios) else float("nan")


@dataclass(frozen=True)
class FunctionFinding:
    """What the functions say of one search.

    Attributes
    ----------
    search : str
    by_function : mapping of str to float
        Error with the optimum shifted over error with it at the origin.
    shifted : float
        Geometric mean of these.
    rotated : float
        Shifted and rotated over shifted, geometric mean: what turning the axes costs.
    doses : mapping of str to float
        Every shift of the dose test over the origin, geometric mean.
    diagonal : float
        Optimum off the diagonal over on it, geometric mean of ratios of medians: a few runs stuck on a wall of the box
        would decide over a mean.
    """

    search: str
    by_function: Mapping[str, float]
    shifted: float
    rotated: float
    doses: Mapping[str, float]
    diagonal: float

    @property
    def on_axes(self) -> bool:
        """Whether the result depends on the directions of the axes."""
        return self.rotated > ALARM


def function_findings(outcomes: Outcomes) -> list[FunctionFinding]:
    """Judge every search on the functions, in the order of their ratios."""
    values = grouped({trial: one for trial, one in outcomes.items() if trial.dimensions})
    names = dict.fromkeys(key[0] for key in values)
    functions = list(dict.fromkeys(key[1] for key in values))

    def ratios(name: str, moved: str, home: str, average: Average = np.mean) -> dict[str, float]:
        pairs = {f: (values.get((name, f, "", moved)), values.get((name, f, "", home))) for f in functions}
        return {f: error_ratio(a, b, average) for f, (a, b) in pairs.items() if a is not None and b is not None}

    def mean(name: str, moved: str, home: str, average: Average = np.mean) -> float:
        return geometric_mean(list(ratios(name, moved, home, average).values()))

    found = [
        FunctionFinding(
            search=name,
            by_function=ratios(name, tasks.SHIFTED, tasks.ORIGIN),
            shifted=mean(name, tasks.SHIFTED, tasks.ORIGIN),
            rotated=mean(name, tasks.ROTATED, tasks.SHIFTED),
            doses={dose: mean(name, dose, tasks.ORIGIN) for dose in tasks.DOSES},
            diagonal=mean(name, tasks.OFF_DIAGONAL, tasks.DIAGONAL, np.median),
        )
        for name in names
    ]
    return sorted(found, key=lambda finding: (-finding.shifted, finding.search))


@dataclass(frozen=True)
class TrajectoryFinding:
    """One search on one case and formulation: its durations as they are against another way to write them.

    Attributes
    ----------
    search, case, formulation, view : str
    as_they_are, seen : float, s
        Median best total time, as they are and in the view.
    a12 : float
        Probability that a run with the durations as they are ends shorter.
    p : float
        Rank sum, adjusted by Holm for all findings of the audit.
    """

    search: str
    case: str
    formulation: str
    view: str
    as_they_are: float
    seen: float
    a12: float
    p: float

    @property
    def depends(self) -> bool:
        """Whether the result depends on how the durations are written, significantly and by a large effect."""
        return self.p < SIGNIFICANT and max(self.a12, 1.0 - self.a12) >= statistics.LARGE

    @property
    def flattered(self) -> bool:
        """Whether it is better with the durations as they are."""
        return self.depends and self.a12 > 0.5


def trajectory_findings(outcomes: Outcomes) -> list[TrajectoryFinding]:
    """Compare the views of every search, case and formulation."""
    values = grouped({trial: one for trial, one in outcomes.items() if trial.formulation})
    keys = [
        (name, case, form, view)
        for name, case, form, view in values
        if view != tasks.AS_IT_IS and (name, case, form, tasks.AS_IT_IS) in values
    ]
    pairs = [
        (values[name, case, form, tasks.AS_IT_IS], values[name, case, form, view]) for name, case, form, view in keys
    ]
    adjusted = statistics.holm([statistics.rank_sum(home, seen) for home, seen in pairs])
    return [
        TrajectoryFinding(*key, float(np.median(home)), float(np.median(seen)), statistics.a12(home, seen), float(p))
        for key, (home, seen), p in zip(keys, pairs, adjusted, strict=True)
    ]


def flags_of(functions: Iterable[FunctionFinding], trajectories: Iterable[TrajectoryFinding]) -> dict[str, str]:
    """Name every search whose result depends on the view, with the reasons."""
    reasons: dict[str, list[str]] = {}
    for one in functions:
        tested = (("the optimum leaves the origin", one.shifted), ("the optimum leaves the diagonal", one.diagonal))
        for what, ratio in tested:
            if ratio > ALARM:
                reasons.setdefault(one.search, []).append(
                    f"on functions its error grows {times(ratio)}-fold when {what}"
                )
    by_search: dict[str, list[TrajectoryFinding]] = {}
    for found in trajectories:
        if found.depends:
            by_search.setdefault(found.search, []).append(found)
    for name, several in by_search.items():
        cases = sorted({found.case for found in several})
        reasons.setdefault(name, []).append(
            f"on {', '.join(cases)} its result depends on how the durations are written"
        )
    return {name: "; ".join(texts) for name, texts in reasons.items()}
