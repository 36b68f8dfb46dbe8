"""Measures over a suite: what was solved, how far behind the best known, and how fast; failures count and are never dropped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from itertools import groupby
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from study.bounds import is_stochastic
from study.cases.case import Case
from study.cases.suite_file import suites_folder
from study.cases.suites import Suite
from study.errors import StudyError
from study.planning import Planner
from study.registry import method_named
from study.store.results import Result

SHIFT = 0.01
"""Gap that is added before logarithms are averaged, and taken off afterwards."""

FAILED = 10.0
"""Gap that a run without a feasible motion counts with: eleven times the best known."""

NEAR = 0.01
"""Gap within which a problem counts as solved."""

TIMES = (0.1, 1.0, 10.0)
"""Seconds within which shares of solved problems are counted."""


@dataclass(frozen=True)
class Run:
    """One run in plain numbers, as it is committed.

    Attributes
    ----------
    problem : str
        `SUITE:NAME`.
    segments, joints : int
    jerk : bool
        Whether the problem limits jerk.
    planner, kind : str
        Registry name, and its freedom or `bound`.
    evaluations : int
        Budget of a search; 0 for a deterministic planner.
    seed : int
    status : str
    feasible : bool
    duration : float, s
        Of the motion, feasible or not; infinite where there is none.
    stretch : float
        Factor by which the motion would have to be slowed to keep its limits of rates; infinite where there is none.
    wall_time : float, s
    bound : float, s
        Proved by the run; 0 where it proved nothing.
    reason : str
        Sentence of the judge or the planner where there is no feasible motion.
    """

    problem: str
    segments: int
    joints: int
    jerk: bool
    planner: str
    kind: str
    evaluations: int
    seed: int
    status: str
    feasible: bool
    duration: float
    stretch: float
    wall_time: float
    bound: float
    reason: str

    @property
    def method(self) -> str:
        """Planner and budget."""
        return f"{self.planner}, {self.evaluations:,} evaluations" if self.evaluations else self.planner


def runs_of(results: Iterable[Result], cases: Mapping[str, Case]) -> list[Run]:
    """Plain numbers of results."""
    return [_run(result, cases[result.cell.case]) for result in results]


def _run(result: Result, case: Case) -> Run:
    cell, problem, verdict = result.cell, case.problem, result.verdict
    method = method_named(cell.planner)
    return Run(
        problem=case.name,
        segments=problem.n_segments,
        joints=problem.n_joints,
        jerk=bool(np.isfinite(problem.limits.jerk).any()),
        planner=cell.planner,
        kind=str(method.freedom) if isinstance(method, Planner) else "bound",
        evaluations=cell.settings.evaluations if is_stochastic(method) else 0,
        seed=cell.settings.seed,
        status=result.status.name,
        feasible=result.feasible,
        duration=result.duration,
        stretch=verdict.stretch if verdict else np.inf,
        wall_time=result.wall_time,
        bound=result.lower_bound or 0.0,
        reason="" if result.feasible else result.reason[:200],
    )


def runs_file(suite: Suite) -> Path:
    """Place of a suite's committed runs."""
    return suites_folder() / "results" / f"{suite.name}.parquet"


def write_runs(path: Path, runs: Sequence[Run]) -> None:
    """Write runs as a Parquet file."""
    pq.write_table(pa.Table.from_pylist([asdict(run) for run in runs]), path, compression="zstd")


def read_runs(path: Path) -> list[Run]:
    """Read committed runs.

    Raises
    ------
    StudyError
        If the file is not there or has other columns.
    """
    if not path.is_file():
        raise StudyError(f"there are no committed runs at {path}")
    table = pq.read_table(path).to_pylist()
    names = [field.name for field in fields(Run)]
    if table and not set(names) <= table[0].keys():
        raise StudyError(f"file {path.name!r} holds no runs of a suite; write it with `study suite keep`")
    return [Run(**{name: row[name] for name in names}) for row in table]


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


def scores(field: Field) -> list[Score]:
    """Score every method, the smallest gap to the best known of any kind first."""
    return sorted(
        (_score(field, name, runs) for name, runs in field.by_method.items()), key=lambda score: score.gap_any
    )


def _score(field: Field, name: str, runs: Sequence[Run]) -> Score:
    gaps = np.array([field.gap(run, own_kind=False) for run in runs])
    walls = np.array([run.wall_time for run in runs])
    near = gaps <= NEAR
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
    )


def _ending(run: Run) -> str:
    if run.status == "NOT_APPLICABLE":
        return "does not apply"
    if np.isfinite(run.duration):
        return "breaks limits" if run.stretch > 1.0 else "misses another demand"
    return "out of time" if run.status == "TIMED_OUT" else "no motion"


@dataclass(frozen=True, eq=False)
class Profile:
    """Share of runs whose ratio or cost is at most `x`, a step function."""

    method: str
    x: np.ndarray
    share: np.ndarray


def performance_profiles(field: Field) -> list[Profile]:
    """Share of runs within a factor of the best known of any kind (Dolan and More 2002)."""
    return _profiles(field, lambda run: 1.0 + field.gap(run, own_kind=False))


def data_profiles(field: Field, near: float = NEAR) -> list[Profile]:
    """Share of runs that are near the best known of any kind within a wall time, s (More and Wild 2009)."""
    return _profiles(field, lambda run: run.wall_time if field.gap(run, own_kind=False) <= near else np.inf)


def _profiles(field: Field, cost: Callable[[Run], float]) -> list[Profile]:
    lines = []
    for name, runs in field.by_method.items():
        costs = np.sort([cost(run) for run in runs])
        finite = costs[np.isfinite(costs)]
        lines.append(Profile(name, finite, np.arange(1, len(finite) + 1) / len(costs)))
    return lines


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
