"""Trials that no comparison asks for any more, because whoever bears their names now makes other ones.

A trial's key is a checksum of all that determines it, so it does not tell which code it came from. But what goes by the
trial's names today, its search and its function or case, has a key too: where that is another one, something has changed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import Any

from study.cases.library import case_names, load_case
from study.comparison.build import trial_jobs
from study.comparison.effort import FULL
from study.comparison.trials import Job, Trial
from study.comparison.trialstore import TrialStore, key_of
from study.problem import Problem
from study.search.state import Search

Task = tuple[Problem | None, str]
"""Problem, none for a function, and curve."""


def drop_stale_trials(path: Path) -> int:
    """Drop trials whose search or task has changed since they were made; return how many.

    Trials of searches that are not installed and of cases of one's own stay, and so do damaged ones.

    Parameters
    ----------
    path : Path
        The results file.

    Raises
    ------
    StudyError
        If the file is damaged or being written to.
    """
    searches, tasks = _today()

    @cache
    def asked(trial: Trial) -> frozenset[str]:
        return frozenset(key_of(Job(trial, search, *tasks[trial.task])) for search in searches.values())

    def stale(key: str, content: Mapping[str, Any]) -> bool:
        if content.keys() != {field.name for field in fields(Trial)}:
            return True
        trial = Trial(**content)
        known = trial.search in searches and trial.task in tasks
        return known and key not in asked(replace(trial, search=""))  # equal trials are stored under one of their names

    with TrialStore(path) as store:
        keys = [key for key, content in store.contents().items() if stale(key, content)]
        store.drop(keys)
    return len(keys)


def _today() -> tuple[dict[str, Search[Any]], dict[str, Task]]:
    """What goes by every name in a comparison of everything."""
    every = replace(FULL, trial_seeds=1, function_seeds=1)
    jobs = [job for part in trial_jobs([*map(load_case, case_names())], every).values() for job in part]
    return {job.trial.search: job.search for job in jobs}, {job.trial.task: (job.problem, job.curve) for job in jobs}
