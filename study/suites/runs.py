"""Runs of a suite in plain numbers, with how near each came after how many evaluations, and their Parquet files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from study.bounds import is_stochastic
from study.cases.case import Case
from study.cases.suite_file import suites_folder
from study.cases.suites import Suite
from study.errors import StudyError
from study.planning import Planner
from study.problem import Floats
from study.registry import method_named
from study.store.results import Result

FINENESS = 1.05
"""Of improvements whose evaluations are nearer to each other than this factor, the last is kept."""


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
    spent : int
        Evaluations that were made; 0 where they were not kept.
    curve_evaluations : tuple of int
        Evaluations after which the best so far had improved, see `improvements`; empty without a feasible motion.
    curve_above : tuple of float
        Best value so far at each of them, above `duration`, relative; the last is 0.
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
    spent: int = 0
    curve_evaluations: tuple[int, ...] = ()
    curve_above: tuple[float, ...] = ()

    @property
    def method(self) -> str:
        """Planner and budget."""
        return f"{self.planner}, {self.evaluations:,} evaluations" if self.evaluations else self.planner

    @property
    def cost(self) -> int:
        """Evaluations that the run cost: those made, or the budget where they were not kept."""
        return self.spent or self.evaluations

    @cached_property
    def curve(self) -> Floats:
        """Evaluations so far and duration of the best motion so far, s, shape (n_points, 2)."""
        values = self.duration * (1.0 + np.array(self.curve_above, dtype=float))
        return np.column_stack([np.array(self.curve_evaluations, dtype=float), values])


TYPES = {
    "str": pa.string(),
    "int": pa.int64(),
    "bool": pa.bool_(),
    "float": pa.float64(),
    "tuple[int, ...]": pa.list_(pa.int32()),
    "tuple[float, ...]": pa.list_(pa.float32()),
}
SCHEMA = pa.schema([(field.name, TYPES[str(field.type)]) for field in fields(Run)])
SPLIT = ["duration", "wall_time", "curve_above.list.element"]
"""Columns of real numbers, whose bytes are kept place by place in the file, which is a third smaller so."""


def runs_of(results: Iterable[Result], cases: Mapping[str, Case]) -> list[Run]:
    """Plain numbers of results."""
    return [_run(result, cases[result.cell.case]) for result in results]


def _run(result: Result, case: Case) -> Run:
    cell, problem, verdict = result.cell, case.problem, result.verdict
    method = method_named(cell.planner)
    curve = improvements(result.history, result.duration) if result.feasible else np.empty((0, 2))
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
        spent=result.evaluations,
        curve_evaluations=tuple(curve[:, 0].astype(int).tolist()),
        curve_above=tuple(curve[:, 1].tolist()),
    )


def improvements(history: Floats, duration: float) -> Floats:
    """Thin a history to its improvements, of those within `FINENESS` the last, so that a mark is reached at most 5 % late.

    Parameters
    ----------
    history : array of shape (n_records, 2)
        Evaluations so far and best value so far, s.
    duration : float, s
        Of the motion that came out. A penalised value lies above every feasible one, so it is late, never too good.

    Returns
    -------
    array of shape (n_points, 2)
        Evaluations, and the value above the duration, relative, to the precision in which it is kept.
    """
    known = history[np.isfinite(history[:, 1]) & (history[:, 0] > 0)]
    if not len(known):
        return np.empty((0, 2))
    better = known[np.concatenate([[True], np.diff(known[:, 1]) < 0.0])]
    bins = np.floor(np.log(better[:, 0]) / np.log(FINENESS))
    kept = better[np.concatenate([np.diff(bins) > 0, [True]])]
    above = np.maximum(kept[:, 1] / duration - 1.0, 0.0).astype(np.float32)
    above[-1] = 0.0
    return np.column_stack([kept[:, 0], above])


def runs_file(suite: Suite) -> Path:
    """Place of a suite's committed runs."""
    return suites_folder() / "results" / f"{suite.name}.parquet"


def write_runs(path: Path, runs: Sequence[Run]) -> None:
    """Write runs as a Parquet file."""
    columns = {name: [getattr(run, name) for run in runs] for name in SCHEMA.names}
    table = pa.table(columns, schema=SCHEMA)
    pq.write_table(table, path, compression="zstd", use_dictionary=False, use_byte_stream_split=SPLIT)


def added(runs: Sequence[Run], committed: Sequence[Run]) -> list[Run]:
    """Committed runs and new ones, problem by problem; a new one takes the place of the same planner, budget and seed."""
    both = {(run.problem, run.planner, run.evaluations, run.seed): run for run in (*committed, *runs)}
    return [both[key] for key in sorted(both)]


def plain(runs: Sequence[Run]) -> list[dict[str, Any]]:
    """Runs as rows of a table, without their curves."""
    names = [name for name in SCHEMA.names if not name.startswith("curve_")]
    return [{name: getattr(run, name) for name in names} for run in runs]


def read_runs(path: Path) -> list[Run]:
    """Read committed runs; columns that an older file lacks have their defaults.

    Raises
    ------
    StudyError
        If the file is not there or has other columns.
    """
    if not path.is_file():
        raise StudyError(f"there are no committed runs at {path}")
    table = pq.read_table(path)
    names = [field.name for field in fields(Run) if field.name in table.column_names]
    if missing := [f.name for f in fields(Run) if f.default is MISSING and f.name not in names]:
        raise StudyError(
            f"file {path.name!r} holds no runs of a suite, it has no column {missing[0]!r}; write it with `study suite keep`"
        )
    rows: list[dict[str, Any]] = table.select(names).to_pylist()
    for row in rows:
        row.update({name: tuple(row[name]) for name in names if name.startswith("curve_")})
    return [Run(**row) for row in rows]
