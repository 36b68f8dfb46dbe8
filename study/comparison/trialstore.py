"""Outcomes of trials, stored by content in the results file beside the planners' runs.

A trial is named by everything that determines its outcome, the sources of its search and of its task among them, so a
changed search makes its own trials anew and no others. Every row carries a checksum that is compared when it is read.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from dataclasses import asdict
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any

from study.code_digest import code_digest
from study.comparison import trials
from study.comparison.trials import Job, Outcome, Trial, run_trials
from study.errors import StudyError
from study.problem import Problem
from study.store.codec import canonical, problem_digest
from study.store.file import explained, locked, transaction
from study.store.store import Store, row_digest

TOGETHER = 30
"""Repetitions of a trial that are run, and stored, together."""

TABLE = """
CREATE TABLE IF NOT EXISTS trials (
  key TEXT PRIMARY KEY, trial TEXT NOT NULL, value REAL NOT NULL, reason TEXT NOT NULL, wall_time REAL NOT NULL,
  digest TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS findings (name TEXT PRIMARY KEY, text TEXT NOT NULL) WITHOUT ROWID;
"""

_digest_of_problem = cache(problem_digest)


def key_of(job: Job) -> str:
    """Checksum of a trial's content: the search with all its parameters, the task, the settings and the code."""
    return hashlib.sha256(canonical([_shared_content(*job.group), job.trial.seed]).encode()).hexdigest()


@cache
def _shared_content(trial: Trial, search: str, module: str, problem: Problem | None, curve: str) -> str:
    """What all repetitions have in common, the sources behind it among them."""
    sources = [code_digest(module), code_digest(trials.__name__)]
    task = [_digest_of_problem(problem) if problem else None, curve]
    return canonical([asdict(trial), search, task, version("time-optimal-study"), sources])


class TrialStore:
    """Outcomes of trials in the results file; use it as a context manager.

    Parameters
    ----------
    path : Path
        Made when it does not exist and `write` is true.
    write : bool
        Whether to become the file's one writer.

    Raises
    ------
    StudyError
        If the file is damaged, of another program, cannot be written, or another run is writing to it.
    """

    def __init__(self, path: Path, *, write: bool = True) -> None:
        self.path = path
        Store(path, {}, write=write).close()  # makes or checks the file
        self._lock = locked(path) if write else None
        with explained(path):
            self._connection = sqlite3.connect(path, isolation_level=None)
            if write:
                self._lay_out()
            else:
                self._connection.execute("PRAGMA query_only = 1")

    def __enter__(self) -> TrialStore:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._connection.close()
        if self._lock is not None:
            self._lock.close()

    def _lay_out(self) -> None:
        columns = [row[1] for row in self._connection.execute("PRAGMA table_info(trials)")]
        if columns and "digest" not in columns:  # of a version that named its trials otherwise: none is asked for now
            self._connection.execute("DROP TABLE trials")
        self._connection.executescript(TABLE)

    def outcomes(self, jobs: Iterable[Job]) -> dict[Trial, Outcome]:
        """Stored outcomes of jobs; those without one are left out.

        Raises
        ------
        StudyError
            If a row does not match its checksum.
        """
        with explained(self.path):
            rows = self._connection.execute(
                "SELECT key, trial, value, reason, wall_time, digest FROM trials"
            ).fetchall()
        known = {row[0]: row for row in rows}
        found = [(job.trial, known[key]) for job in jobs if (key := key_of(job)) in known]
        return {trial: self._checked(trial, row) for trial, row in found}

    def _checked(self, trial: Trial, row: tuple[str, str, float, str, float, str]) -> Outcome:
        key, content, value, reason, wall_time, digest = row
        if trial_digest(key, content, value, reason) != digest:
            raise StudyError(
                f"results file {self.path}: the trial of {trial.search} on {trial.task} (seed {trial.seed}) is damaged; "
                "move the file away and run again"
            )
        return Outcome(value, reason, wall_time)

    def add(self, jobs: Sequence[Job], outcomes: Sequence[Outcome]) -> None:
        """Keep outcomes, all of them or none."""
        rows = []
        for job, one in zip(jobs, outcomes, strict=True):
            key, content = key_of(job), canonical(asdict(job.trial))
            digest = trial_digest(key, content, one.value, one.reason)
            rows.append((key, content, one.value, one.reason, one.wall_time, digest))
        with explained(self.path), transaction(self._connection):
            self._connection.executemany("INSERT OR IGNORE INTO trials VALUES (?, ?, ?, ?, ?, ?)", rows)

    def contents(self) -> dict[str, dict[str, Any]]:
        """Fields of every stored trial by its key; those that do not match their checksums are left out."""
        with explained(self.path):
            rows = self._connection.execute("SELECT digest, key, trial, value, reason FROM trials").fetchall()
        return {key: json.loads(text) for digest, key, text, *rest in rows if trial_digest(key, text, *rest) == digest}

    def drop(self, keys: Iterable[str]) -> None:
        """Forget trials by key, all of them or none."""
        with explained(self.path), transaction(self._connection):
            self._connection.executemany("DELETE FROM trials WHERE key = ?", [(key,) for key in keys])

    def note(self, name: str, text: str) -> None:
        """Keep a finding drawn from the outcomes, in the place of an older one of that name."""
        with explained(self.path):
            self._connection.execute("INSERT OR REPLACE INTO findings VALUES (?, ?)", (name, text))

    def noted(self, name: str) -> str | None:
        """Return a finding by name; None where there is none."""
        with explained(self.path):
            tables = self._connection.execute("SELECT count(*) FROM sqlite_master WHERE name = 'findings'").fetchone()
            if not tables[0]:
                return None
            row = self._connection.execute("SELECT text FROM findings WHERE name = ?", (name,)).fetchone()
        return None if row is None else str(row[0])


def trial_digest(key: str, content: str, value: float, reason: str) -> str:
    """Checksum of one row; wall time, which no two runs share, is outside it."""
    return row_digest((key, content, value, reason), "", b"")


def run_jobs(
    jobs: Sequence[Job],
    store: TrialStore,
    executor: Executor,
    on_done: Callable[[int], None] = lambda count: None,
) -> Mapping[Trial, Outcome]:
    """Run the jobs that are not stored yet, and return the outcomes of all.

    Parameters
    ----------
    jobs : sequence of Job
    store : TrialStore
        Written as every batch of repetitions finishes.
    executor : concurrent.futures.Executor
    on_done : callable (n_finished)
        Told how many jobs have an outcome, at first and after every batch.
    """
    stored = store.outcomes(jobs)
    done = len(stored)
    on_done(done)
    running = {executor.submit(run_trials, batch): batch for batch in batches(jobs, stored)}
    while running:
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            batch = running.pop(future)
            store.add(batch, future.result())
            done += len(batch)
            on_done(done)
    return store.outcomes(jobs)


def batches(jobs: Iterable[Job], stored: Mapping[Trial, Outcome]) -> list[list[Job]]:
    """Repetitions that are not stored, in groups that differ by their seed alone; equal trials once, whatever their name."""
    missing = {key_of(job): job for job in jobs if job.trial not in stored}
    groups: dict[tuple[object, ...], list[Job]] = {}
    for job in missing.values():
        groups.setdefault(job.group, []).append(job)
    return [group[i : i + TOGETHER] for group in groups.values() for i in range(0, len(group), TOGETHER)]
