"""Run what is missing, draw every finding from the store, and gather all that the pages and the files show."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

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
from study.comparison.trials import TrialJob
from study.runs.execute import cell_jobs, stored_results
from study.runs.job import Job
from study.store.store import Store

FLAGS = "flags"
Run = Callable[[str, Sequence[Job[Any]]], None]
"""Runs the jobs of a part that are not stored yet."""


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


def compare(cases: Mapping[str, Case], effort: Effort, store: Store, run: Run) -> Comparison:
    """Run what the store does not have and draw all findings; the numbers depend on what is stored only.

    Parameters
    ----------
    cases : mapping of str to Case
    effort : Effort
    store : Store
    run : callable (part, jobs)
        Runs those of a part's jobs that are not stored.

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
    run("planners", cell_jobs(wanted, cases))
    runs = {result.cell: result for result in stored_results(store, wanted, cases)}
    outcomes = {name: _tried(name, part, store, run) for name, part in trial_jobs(chosen, effort).items()}
    functions = audit.function_findings(outcomes["functions"])
    trajectories = audit.trajectory_findings(outcomes["trajectories"])
    flags = audit.flags_of(functions, trajectories)
    store.note(FLAGS, flags)
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


def trial_jobs(cases: Sequence[Case], effort: Effort) -> dict[str, list[TrialJob]]:
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
    with Store(store_path, write=False) as store:
        return dict(store.noted(FLAGS) or {})


def _tried(name: str, jobs: Sequence[TrialJob], store: Store, run: Run) -> audit.Outcomes:
    run(name, jobs)
    ends = zip(jobs, (ends for _, ends in store.outcomes(jobs)), strict=True)
    return {trial: end for job, several in ends for trial, end in zip(job.trials, several, strict=True)}


def _failures(outcomes: Iterable[audit.Outcomes]) -> dict[str, int]:
    counts: dict[str, int] = {}
    for part in outcomes:
        for trial, end in part.items():
            if end.reason:
                counts[trial.search] = counts.get(trial.search, 0) + 1
    return counts
