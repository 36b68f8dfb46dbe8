"""Runs of bare searches on tasks, stored by content in the results file beside the planners' runs."""

from __future__ import annotations

import hashlib
import sqlite3
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from study.comparison.tasks import Task, function_task, trajectory_task
from study.experiment.codec import canonical, problem_content
from study.experiment.store import Store
from study.experiment.storefile import explained, locked
from study.planning import Meter
from study.problem import Problem
from study.search.loop import Search, minimise

CHUNK = 24
"""Trials sent to a worker, and stored, together."""

TABLE = """
CREATE TABLE IF NOT EXISTS trials (
  key TEXT PRIMARY KEY, trial TEXT NOT NULL, value REAL NOT NULL, reason TEXT NOT NULL, wall_time REAL NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS findings (name TEXT PRIMARY KEY, text TEXT NOT NULL) WITHOUT ROWID;
"""


@dataclass(frozen=True)
class Trial:
    """One run of a search on a view of a function or of a trajectory problem.

    Attributes
    ----------
    search : str
        Name under which it is reported.
    task : str
        Function or case.
    view : str
    seed : int
    evaluations, population : int
    dimensions : int
        Of a function; 0 for a trajectory problem.
    formulation : str
        Of a trajectory problem; empty for a function.
    """

    search: str
    task: str
    view: str
    seed: int
    evaluations: int
    population: int
    dimensions: int = 0
    formulation: str = ""


@dataclass(frozen=True, eq=False)
class Job:
    """A trial with everything that determines its outcome; it travels to a worker.

    Attributes
    ----------
    trial : Trial
    search : Search
    problem : Problem, optional
    curve : str
    """

    trial: Trial
    search: Search[Any]
    problem: Problem | None = None
    curve: str = ""

    @property
    def key(self) -> str:
        """Checksum of the content: the search with all its parameters, the problem, the settings and the version."""
        content = {
            "trial": {name: value for name, value in asdict(self.trial).items() if name != "search"},
            "search": repr(self.search),
            "problem": problem_content(self.problem) if self.problem else None,
            "curve": self.curve,
            "version": version("time-optimal-study"),
        }
        return hashlib.sha256(canonical(content).encode()).hexdigest()

    def task(self) -> Task:
        """Build the objective and its box."""
        trial = self.trial
        if self.problem is None:
            return function_task(trial.task, trial.dimensions, trial.view, trial.seed)
        return trajectory_task(self.problem, self.curve, trial.formulation, trial.view)


@dataclass(frozen=True)
class Outcome:
    """What came of a trial.

    Attributes
    ----------
    value : float
        Best value above the task's minimum; infinity where there is none.
    reason : str
        Why the search broke down; empty if it did not.
    wall_time : float, s
    """

    value: float
    reason: str
    wall_time: float


def run_trial(job: Job) -> Outcome:
    """Run one search; whatever it raises becomes the outcome's reason."""
    trial, reason = job.trial, ""
    task = job.task()
    meter = Meter(task.objective, trial.evaluations)
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):  # searches overflow on purpose at the end of their scales
            minimise(job.search, meter, task.box, trial.population, np.random.default_rng(trial.seed))
    except Exception as error:  # a search may raise anything; it is a record, not a crash
        reason = f"{type(error).__name__}: {error}"
    return Outcome(meter.incumbent_value - task.minimum, reason, time.perf_counter() - started)


def _run_all(jobs: Sequence[Job]) -> list[Outcome]:
    return [run_trial(job) for job in jobs]


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
                self._connection.executescript(TABLE)
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

    def outcomes(self, jobs: Iterable[Job]) -> dict[Trial, Outcome]:
        """Stored outcomes of jobs; those without one are left out."""
        with explained(self.path):
            rows = self._connection.execute("SELECT key, value, reason, wall_time FROM trials").fetchall()
        known = {key: Outcome(*row) for key, *row in rows}
        return {job.trial: known[key] for job in jobs if (key := job.key) in known}

    def add(self, jobs: Sequence[Job], outcomes: Sequence[Outcome]) -> None:
        """Keep outcomes, all of them or none."""
        rows = [
            (job.key, canonical(asdict(job.trial)), one.value, one.reason, one.wall_time)
            for job, one in zip(jobs, outcomes, strict=True)
        ]
        with explained(self.path):
            self._connection.execute("BEGIN IMMEDIATE")
            self._connection.executemany("INSERT OR IGNORE INTO trials VALUES (?, ?, ?, ?, ?)", rows)
            self._connection.execute("COMMIT")

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
        Written as every chunk finishes.
    executor : concurrent.futures.Executor
    on_done : callable (n_finished)
        Told of every chunk.
    """
    stored = store.outcomes(jobs)
    missing = list({job.key: job for job in jobs if job.trial not in stored}.values())
    if not missing:
        return stored
    chunks = [missing[i : i + CHUNK] for i in range(0, len(missing), CHUNK)]
    running = {executor.submit(_run_all, chunk): chunk for chunk in chunks}
    while running:
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in done:
            chunk = running.pop(future)
            store.add(chunk, future.result())
            on_done(len(chunk))
    return store.outcomes(jobs)
