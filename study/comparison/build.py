"""Run what is missing, draw every finding from the store, and gather all that the pages and the files show."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from study.cases.library import Case
from study.comparison import ablations, audit, claims, differences, performance, statistics
from study.comparison.contestants import (
    LEVELS,
    Contestant,
    Reference,
    contestants,
    level_cells,
    references,
    solver_cells,
)
from study.comparison.effort import Effort
from study.comparison.trials import Job
from study.comparison.trialstore import TrialStore, run_jobs
from study.runs.pool import WorkerPool
from study.runs.runner import default_jobs, run_cells
from study.store.results import Cell, Result
from study.store.store import Store

FLAGS = "flags"
Progress = Callable[[str, int, int], None]
"""Told of every part: its name, how many are done and how many there are."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Every finding of the comparison.

    Attributes
    ----------
    cases : mapping of str to Case
    effort : Effort
    references : mapping of str to Reference
    levels : mapping of str to list of Contestant
        Contestants at equal budgets, by level.
    solvers : list of Contestant
        Compared on wall time and duration.
    measured : mapping of str to list of Performance
    pairings : mapping of str to list of Pairing
    omnibus : list of Omnibus
    functions : list of FunctionFinding
    trajectories : list of TrajectoryFinding
    ablations : list of AblationFinding
    claims : list of Counterpart
    flags : mapping of str to str
        Searches whose result depends on the view, and why.
    failures : mapping of str to int
        Searches that broke down in trials, and how often.
    """

    cases: Mapping[str, Case]
    effort: Effort
    references: Mapping[str, Reference]
    levels: Mapping[str, list[Contestant]]
    solvers: list[Contestant]
    measured: Mapping[str, list[performance.Performance]]
    pairings: Mapping[str, list[differences.Pairing]]
    omnibus: list[differences.Omnibus]
    functions: list[audit.FunctionFinding]
    trajectories: list[audit.TrajectoryFinding]
    ablations: list[ablations.AblationFinding]
    claims: list[claims.Counterpart]
    flags: Mapping[str, str]
    failures: Mapping[str, int]


def compare(
    cases: Mapping[str, Case],
    effort: Effort,
    store_path: Path,
    jobs: int | None = None,
    progress: Progress = lambda part, done, total: None,
) -> Comparison:
    """Run what the store does not have and draw all findings; the numbers depend on what is stored only.

    Parameters
    ----------
    cases : mapping of str to Case
    effort : Effort
    store_path : Path
        The results file; made if need be.
    jobs : int, optional
        Worker processes; all processors by default.
    progress : callable, optional

    Raises
    ------
    StudyError
        If the store cannot be used or the library of the post hoc test is missing.
    """
    statistics.posthocs()  # a missing library shows before any work is done
    chosen = list(cases.values())
    cells = {level: level_cells(chosen, level, effort) for level in LEVELS}
    own, solving = claims.claim_cells(chosen, effort), solver_cells(chosen, effort)
    wanted = list(dict.fromkeys([*own, *solving, *(cell for group in cells.values() for cell in group)]))
    runs = _planned(wanted, cases, store_path, jobs, progress)
    parts = trial_jobs(chosen, effort)
    with TrialStore(store_path) as store, _pool(jobs) as pool:
        outcomes = {name: _tried(name, part, store, pool, progress) for name, part in parts.items()}
        functions = audit.function_findings(outcomes["functions"])
        trajectories = audit.trajectory_findings(outcomes["trajectories"])
        flags = audit.flags_of(functions, trajectories)
        store.note(FLAGS, json.dumps(flags, sort_keys=True))
    known = references(chosen, runs)
    levels = {level: contestants(runs, group, level) for level, group in cells.items()}
    rankings = [differences.omnibus(found, known, level) for level, found in levels.items()]
    return Comparison(
        cases,
        effort,
        known,
        levels,
        contestants(runs, solving, "solver"),
        {level: performance.performances(found, known) for level, found in levels.items()},
        {level: differences.pairings(found, known) for level, found in levels.items()},
        [found for found in rankings if found is not None],
        functions,
        trajectories,
        ablations.ablation_findings(outcomes["ablations"]),
        claims.counterparts(cases, runs, own, known),
        flags,
        _failures(outcomes.values()),
    )


def trial_jobs(cases: Sequence[Case], effort: Effort) -> dict[str, list[Job]]:
    """List the trials of the audit and the ablations."""
    searches = audit.audited_searches(effort.printed)
    audited = [case for case in cases if case.name in effort.audited([one.name for one in cases])]
    return {
        "functions": audit.function_jobs(searches, effort),
        "trajectories": audit.trajectory_jobs(searches, audited, effort, effort.formulations),
        "ablations": ablations.ablation_jobs(cases, effort),
    }


def flags(store_path: Path) -> dict[str, str]:
    """Searches that the last audit flagged and why, by planner name; empty where none was made.

    Parameters
    ----------
    store_path : Path
        The results file.

    Raises
    ------
    StudyError
        If the file is damaged or not a results file.
    """
    if not store_path.exists():
        return {}
    with TrialStore(store_path, write=False) as store:
        text = store.noted(FLAGS)
    return {} if text is None else dict(json.loads(text))


def _planned(
    cells: Sequence[Cell], cases: Mapping[str, Case], path: Path, jobs: int | None, progress: Progress
) -> dict[Cell, Result]:
    """Run the planners' cells that are missing; results of all by cell."""
    with Store(path, cases) as store:
        done = len(cells) - len(store.missing(cells))

        def finished(result: Result) -> None:
            nonlocal done
            done += 1
            progress("planners", done, len(cells))

        progress("planners", done, len(cells))
        run_cells(cells, cases, store, jobs=jobs, on_result=finished)
        return {result.cell: result for result in store.results(cells)}


def _tried(name: str, jobs: Sequence[Job], store: TrialStore, pool: Executor, progress: Progress) -> audit.Outcomes:
    return run_jobs(jobs, store, pool, lambda done: progress(name, done, len(jobs)))


@contextmanager
def _pool(jobs: int | None) -> Iterator[Executor]:
    """Worker processes, started when first needed and ended at once, whatever ends the block."""
    pool = WorkerPool(default_jobs() if jobs is None else jobs)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _failures(outcomes: Iterable[audit.Outcomes]) -> dict[str, int]:
    counts: dict[str, int] = {}
    for part in outcomes:
        for trial, one in part.items():
            if one.reason:
                counts[trial.search] = counts.get(trial.search, 0) + 1
    return counts
