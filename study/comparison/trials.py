"""Runs of bare searches on tasks: what a trial is, and how the repetitions of one are run together."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from study.comparison.tasks import Task, function_task, trajectory_task
from study.planning import Meter
from study.problem import Floats, Problem
from study.search.loop import minimise, minimise_many
from study.search.state import Search


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
    def group(self) -> tuple[Trial, str, str, Problem | None, str]:
        """What the repetitions of a trial have in common: all but the seed, whatever name the search goes by."""
        shared = replace(self.trial, search="", seed=0)
        return shared, repr(self.search), type(self.search).__module__, self.problem, self.curve

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


def run_trials(jobs: Sequence[Job]) -> list[Outcome]:
    """Run the repetitions of one trial, jobs of one group, side by side; every outcome is what it is alone.

    Wall time is shared out evenly. Where a run breaks down each is run by itself, so that the others do not suffer.
    """
    first, rngs = jobs[0].trial, [np.random.default_rng(job.trial.seed) for job in jobs]
    tasks = [job.task() for job in jobs] if jobs[0].problem is None else [jobs[0].task()] * len(jobs)
    budget, population, box = first.evaluations, first.population, tasks[0].box
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):  # searches overflow on purpose at the end of their scales
            meters = minimise_many(jobs[0].search, _together(tasks), budget, box, population, rngs)
    except Exception:  # a search may raise anything
        return [run_trial(job) for job in jobs]
    wall = (time.perf_counter() - started) / len(jobs)
    return [Outcome(_error(meter, task), "", wall) for meter, task in zip(meters, tasks, strict=True)]


def _together(tasks: Sequence[Task]) -> Callable[[Floats], Floats]:
    """One objective for the candidates of all runs, which stand run after run; functions differ by seed."""
    if all(task is tasks[0] for task in tasks):
        return tasks[0].objective

    def objective(points: Floats) -> Floats:
        parts = np.split(points, len(tasks))
        return np.concatenate([task.objective(part) for task, part in zip(tasks, parts, strict=True)])

    return objective


def run_trial(job: Job) -> Outcome:
    """Run one search by itself; whatever it raises becomes the outcome's reason."""
    trial, reason = job.trial, ""
    task = job.task()
    meter = Meter(task.objective, trial.evaluations)
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):
            minimise(job.search, meter, task.box, trial.population, np.random.default_rng(trial.seed))
    except Exception as error:  # it is a record, not a crash
        reason = f"{type(error).__name__}: {error}"
    return Outcome(_error(meter, task), reason, time.perf_counter() - started)


def _error(meter: Meter, task: Task) -> float:
    return float(meter.incumbent_value - task.minimum)
