"""Bare searches on tasks: the trial, and the job that runs its repetitions together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from study.comparison.tasks import Task, function_task, trajectory_task
from study.errors import unforeseen
from study.planning import Meter, Status
from study.problem import Floats, Problem
from study.runs.job import PATIENCE
from study.search.loop import minimise, minimise_many
from study.search.state import Search
from study.store.codec import canonical, checksum, plain, problem_digest
from study.store.kept import Encoded
from study.store.provenance import code_behind

TOGETHER = 30
"""Repetitions of a trial that are run, and kept, together."""


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


@dataclass(frozen=True)
class TrialOutcome:
    """End of a trial.

    Attributes
    ----------
    value : float
        Best value above the task's minimum; infinity where there is none.
    reason : str
        Why the search broke down; empty if it did not.
    """

    value: float
    reason: str = ""


@dataclass(frozen=True, eq=False)
class TrialJob:
    """Repetitions of a trial, run and kept together, with everything that determines their outcomes.

    Attributes
    ----------
    trial : Trial
        That of the first seed.
    search : Search
    seeds : range
    problem : Problem, optional
    curve : str
    """

    trial: Trial
    search: Search[Any]
    seeds: range
    problem: Problem | None = None
    curve: str = ""
    kind: ClassVar[str] = "trial"
    time_limit: ClassVar[float] = PATIENCE

    @property
    def trials(self) -> list[Trial]:
        """Every repetition."""
        return [replace(self.trial, seed=seed) for seed in self.seeds]

    @property
    def subject(self) -> str:
        """Name of the function or case."""
        return self.trial.task

    @property
    def method(self) -> str:
        """Class of the search; equal trials are kept once, whatever name the search goes by."""
        return type(self.search).__name__

    @property
    def label(self) -> str:
        """Name under which the search is reported."""
        return self.trial.search

    @property
    def seed(self) -> int:
        """First seed."""
        return self.seeds[0]

    @cached_property
    def _content(self) -> list[object]:
        shared = plain(replace(self.trial, search="", seed=0))
        return [shared, plain(self.search), None if self.problem is None else problem_digest(self.problem), self.curve]

    def settings(self) -> str:
        """Write trial and search without the first seed."""
        return canonical([*self._content[:2], len(self.seeds)])

    def content(self) -> str:
        """Checksum of trial, search, task and number of repetitions."""
        return checksum([self._content, len(self.seeds)])

    def code(self) -> str:
        """Name the code of the search and of the task."""
        return code_behind(modules=(__name__, type(self.search).__module__))

    def encode(self, outcome: tuple[TrialOutcome, ...]) -> Encoded:
        """Turn the outcomes of all repetitions into plain data."""
        document = {"values": [end.value for end in outcome], "reasons": [end.reason for end in outcome]}
        return Encoded(document, evaluations=self.trial.evaluations * len(outcome))

    def decode(self, encoded: Encoded) -> tuple[TrialOutcome, ...]:
        """Turn plain data back into outcomes."""
        values, reasons = encoded.document["values"], encoded.document["reasons"]
        if len(values) != len(self.seeds):
            raise ValueError(f"{len(values)} outcomes of {len(self.seeds)} trials")
        if not all(isinstance(v, int | float) and isinstance(r, str) for v, r in zip(values, reasons, strict=True)):
            raise ValueError("an outcome is no number, or its reason no text")
        return tuple(map(TrialOutcome, values, reasons))

    def failed(self, reason: str, wall_time: float, status: Status) -> tuple[TrialOutcome, ...]:
        """Build the outcomes of repetitions that were stopped or crashed."""
        return (TrialOutcome(np.inf, reason),) * len(self.seeds)

    def task(self, seed: int) -> Task:
        """Build the objective of one repetition and its box."""
        trial = self.trial
        if self.problem is None:
            return function_task(trial.task, trial.dimensions, trial.view, seed)
        return trajectory_task(self.problem, self.curve, trial.formulation, trial.view)

    def run(self) -> tuple[TrialOutcome, ...]:
        """Run all repetitions side by side; every outcome is what it is alone.

        Where a run breaks down each is run by itself, so that the others do not suffer.
        """
        tasks = list(map(self.task, self.seeds)) if self.problem is None else [self.task(self.seed)] * len(self.seeds)
        rngs = [np.random.default_rng(seed) for seed in self.seeds]
        budget, population, box = self.trial.evaluations, self.trial.population, tasks[0].box
        try:
            with np.errstate(all="ignore"):  # searches overflow on purpose at the end of their scales
                meters = minimise_many(self.search, _together(tasks), budget, box, population, rngs)
        except Exception:  # a search may raise anything
            return tuple(map(self.run_alone, self.seeds))
        return tuple(TrialOutcome(_error(meter, task)) for meter, task in zip(meters, tasks, strict=True))

    def run_alone(self, seed: int) -> TrialOutcome:
        """Run one repetition by itself; whatever the search raises becomes the outcome's reason."""
        task, reason = self.task(seed), ""
        meter = Meter(task.objective, self.trial.evaluations)
        try:
            with np.errstate(all="ignore"):
                minimise(self.search, meter, task.box, self.trial.population, np.random.default_rng(seed))
        except Exception as error:  # it is a record, not a crash
            reason = unforeseen(error)
        return TrialOutcome(_error(meter, task), reason)


def repeated(
    trial: Trial, search: Search[Any], repetitions: int, problem: Problem | None = None, curve: str = ""
) -> list[TrialJob]:
    """Jobs that together hold so many repetitions of a trial, from seed 0 on."""
    starts = range(0, repetitions, TOGETHER)
    parts = [range(first, min(first + TOGETHER, repetitions)) for first in starts]
    return [TrialJob(replace(trial, seed=seeds[0]), search, seeds, problem, curve) for seeds in parts]


def _together(tasks: Sequence[Task]) -> Callable[[Floats], Floats]:
    """One objective for the candidates of all runs, which stand run after run; functions differ by seed."""
    if all(task is tasks[0] for task in tasks):
        return tasks[0].objective

    def objective(points: Floats) -> Floats:
        parts = np.split(points, len(tasks))
        return np.concatenate([task.objective(part) for task, part in zip(tasks, parts, strict=True)])

    return objective


def _error(meter: Meter, task: Task) -> float:
    return float(meter.incumbent_value - task.minimum)
