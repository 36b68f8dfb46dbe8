"""Segment-time planner: a search for the segment durations of a curve, as in every paper."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from study.curves import curve_named
from study.curves.compiled import with_engine
from study.demands import refusal
from study.formulation import objective_of
from study.planning import RATE_LIMITS, Freedom, Meter, Plan, RunSettings, Status, Synchronisation
from study.problem import Demand, Floats, Problem
from study.search.loop import minimise
from study.search.reading import PaperReading
from study.search.state import Box, Search

Drive = Callable[[Meter, Box, int, np.random.Generator], object]
"""Spend a meter's budget inside a box, given a population size and a generator."""


@dataclass(frozen=True)
class SegmentTimePlanner:
    """Segment-time planner with a search of this study.

    Parameters
    ----------
    search : Search
        A metaheuristic with its constants.
    about : str
        One line that says how it works; the first of the search's docstring by default.
    """

    search: Search[Any]
    about: str = ""
    freedom: ClassVar[Freedom] = Freedom.CURVE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS
    stochastic: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "about", self.about or (type(self.search).__doc__ or "").strip().partition("\n")[0])

    def as_printed(self, **constants: Any) -> SegmentTimePlanner:
        """Take the paper's formulas exactly as printed, with these constants of the search set anew."""
        search: Any = self.search  # a frozen dataclass, which its protocol does not say
        search = replace(search, reading=PaperReading.AS_PRINTED, **constants)
        return replace(self, search=search, about=self.about + "; its formulas exactly as printed, misprints included")

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Search all joints together, or each alone and then take the longest duration of every segment.

        Parameters
        ----------
        problem : Problem
        settings : RunSettings
            Its budget is spent on the shared problem, or once on every joint.

        Raises
        ------
        StudyError
            If the curve is unknown or does not fit the waypoints.
        """
        return plan_segment_times(partial(minimise, self.search), problem, settings)


def plan_segment_times(drive: Drive, problem: Problem, settings: RunSettings) -> Plan:
    """Spend the budget on the segment durations of a problem, all joints together or each alone.

    Parameters
    ----------
    drive : callable (meter, box, population, rng)
    problem : Problem
    settings : RunSettings

    Raises
    ------
    StudyError
        If the curve is unknown or does not fit the waypoints.
    """
    if reason := refusal(problem.planner_demands, RATE_LIMITS):
        return Plan(Status.NOT_APPLICABLE, message=reason)
    alone = settings.synchronisation is Synchronisation.PER_JOINT
    parts = [problem.joint(j) for j in range(problem.n_joints)] if alone else [problem]
    streams = np.random.SeedSequence(settings.seed).spawn(len(parts))
    runs = [_search(drive, part, settings, stream) for part, stream in zip(parts, streams, strict=True)]
    evaluations = sum(run.evaluations for run in runs)
    if not all(run.has_motion for run in runs):
        return Plan(Status.FAILED, evaluations=evaluations, message="no candidate of the budget gave a motion")
    durations = np.max([run.durations[-1] for run in runs], axis=0)
    return Plan(
        Status.FINISHED,
        motion=curve_named(settings.curve).motion(problem.waypoints, durations),
        durations=durations,
        evaluations=evaluations,
        iterations=max(len(run.values) for run in runs),
        history=_synchronised_history(runs),
    )


@dataclass(frozen=True, eq=False)
class _Run:
    """One search: evaluations in all, and after every generation the incumbent's value and the durations to drive."""

    has_motion: bool
    evaluations: int
    counts: Floats
    values: Floats
    durations: Floats

    def lengthened(self, n_records: int) -> _Run:
        """Repeat the last record: a run that ended early keeps its incumbent while the others go on."""
        missing = n_records - len(self.values)
        return replace(
            self,
            counts=np.pad(self.counts, (0, missing), mode="edge"),
            values=np.pad(self.values, (0, missing), mode="edge"),
            durations=np.pad(self.durations, ((0, missing), (0, 0)), mode="edge"),
        )


def _search(drive: Drive, problem: Problem, settings: RunSettings, stream: np.random.SeedSequence) -> _Run:
    curve = with_engine(curve_named(settings.curve), settings.evaluations)
    objective = objective_of(settings.formulation, problem, curve)
    meter = Meter(objective, settings.evaluations)
    box = Box(*(np.full(problem.n_segments, bound) for bound in problem.duration_bounds))
    drive(meter, box, settings.population, np.random.default_rng(stream))
    counts, values = meter.history.T
    return _Run(meter.incumbent is not None, meter.evaluations, counts, values, objective.durations(meter.incumbents))


def _synchronised_history(runs: list[_Run]) -> Floats:
    """Total time of the joints' incumbents put together, plus whatever penalty they carry, after every generation."""
    longest = max(len(run.values) for run in runs)
    runs = [run.lengthened(longest) for run in runs]
    together = np.max([run.durations for run in runs], axis=0).sum(axis=1)
    penalty = np.sum([run.values - run.durations.sum(axis=1) for run in runs], axis=0)
    return np.column_stack([np.sum([run.counts for run in runs], axis=0), together + penalty])
