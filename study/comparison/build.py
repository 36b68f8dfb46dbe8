"""Run what is missing, draw every finding from the store, and gather all that the pages and the files show."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from study.cases.library import Case
from study.comparison import ablations, audit, claims, outcomes, ranking, statistics, targets
from study.comparison.audit_functions import function_jobs, functions_audited
from study.comparison.audit_trajectories import trajectories_audited, trajectory_jobs
from study.comparison.contestants import (
    LEVELS,
    Contestant,
    Level,
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

FLAGS, SAID = "flags", "audit"
Run = Callable[[str, Sequence[Job[Any]]], None]
"""Runs the jobs of a part that are not stored yet."""


@dataclass(frozen=True, eq=False)
class Field:
    """The planners' runs.

    Attributes
    ----------
    references : mapping of str to Reference
    levels : mapping of Level to list of Contestant
        Contestants at equal budgets, by level.
    solvers : list of Contestant
        Compared on wall time and duration.
    """

    references: Mapping[str, Reference]
    levels: Mapping[Level, list[Contestant]]
    solvers: list[Contestant]


@dataclass(frozen=True, eq=False)
class Comparison:
    """Every finding of the comparison, by subject.

    Attributes
    ----------
    cases : mapping of str to Case
    effort : Effort
    field : Field
    measured : mapping of Level to list of Performance
    pairings : mapping of Level to list of Pairing
    omnibus : list of Omnibus
    audit : Audit
    ablations : list of AblationFinding
    claims : list of Counterpart
    failures : mapping of str to int
        Searches that broke down in trials, and how often.
    """

    cases: Mapping[str, Case]
    effort: Effort
    field: Field
    measured: Mapping[Level, list[targets.Performance]]
    pairings: Mapping[Level, list[ranking.Pairing]]
    omnibus: list[ranking.Omnibus]
    audit: audit.Audit
    ablations: list[ablations.AblationFinding]
    claims: list[claims.Counterpart]
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
    tried = {name: _tried(name, part, store, run) for name, part in trial_jobs(chosen, effort).items()}
    audited = audit.audit_of(tried["functions"], tried["trajectories"])
    store.note(FLAGS, audited.flags)
    store.note(SAID, [functions_audited(audited.functions), trajectories_audited(audited.trajectories)])
    known, levels = references(chosen, runs), {level: contestants(runs, group, level) for level, group in cells.items()}
    tests = [ranking.omnibus(group, known, level) for level, group in levels.items()]
    return Comparison(
        cases=cases,
        effort=effort,
        field=Field(known, levels, contestants(runs, solving, Level.SOLVER)),
        measured={level: targets.performances(group, known) for level, group in levels.items()},
        pairings={level: ranking.pairings(group, known) for level, group in levels.items()},
        omnibus=[test for test in tests if test is not None],
        audit=audited,
        ablations=ablations.ablation_findings(tried["ablations"]),
        claims=claims.counterparts(cases, runs, own, known),
        failures=outcomes.failures(tried.values()),
    )


def trial_jobs(cases: Sequence[Case], effort: Effort) -> dict[str, list[TrialJob]]:
    """List the trials of the audit and the ablations."""
    searches = audit.audited_searches(effort.printed)
    names = effort.audited([case.name for case in cases])
    audited = [case for case in cases if case.name in names]
    return {
        "functions": function_jobs(searches, effort),
        "trajectories": trajectory_jobs(searches, audited, effort, effort.formulations),
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
    return dict(_noted(store_path, FLAGS) or {})


def said(store_path: Path) -> list[str]:
    """Sentences of the last audit; none where none was made. For errors see `flags`."""
    return list(_noted(store_path, SAID) or [])


def _noted(store_path: Path, name: str) -> Any:
    if not store_path.exists():
        return None
    with Store(store_path, write=False) as store:
        return store.noted(name)


def _tried(name: str, jobs: Sequence[TrialJob], store: Store, run: Run) -> outcomes.Outcomes:
    run(name, jobs)
    ends = zip(jobs, (ends for _, ends in store.outcomes(jobs)), strict=True)
    return {trial: end for job, several in ends for trial, end in zip(job.trials, several, strict=True)}
