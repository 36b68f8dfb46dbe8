"""The planner that every paper's method is: search for segment durations on a curve family."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from study.curves import curve_named
from study.errors import unknown
from study.formulation import formulation_named
from study.planning import Meter, Plan, RunSettings, Status
from study.problem import Floats, Problem
from study.search.loop import Box, Search, minimise


@dataclass(frozen=True)
class SegmentTimePlanner:
    """Minimise total time over segment durations with a search.

    Parameters
    ----------
    search : Search
        A metaheuristic with its constants.
    """

    search: Search[Any]
    stochastic: ClassVar[bool] = True
    segment_times: ClassVar[bool] = True

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
            If the curve, formulation or synchronisation is unknown or does not fit the waypoints.
        """
        if settings.synchronisation == "shared":
            parts = [problem]
        elif settings.synchronisation == "per-joint":
            parts = [problem.joint(j) for j in range(problem.n_joints)]
        else:
            raise unknown("synchronisation", settings.synchronisation, ("per-joint", "shared"))
        streams = np.random.SeedSequence(settings.seed).spawn(len(parts))
        runs = [_search(self.search, part, settings, stream) for part, stream in zip(parts, streams, strict=True)]
        evaluations = sum(run.evaluations for run in runs)
        if not all(run.found for run in runs):
            return Plan(Status.FAILED, evaluations=evaluations, message="no candidate of the budget gave a motion")
        durations = np.max([run.durations[-1] for run in runs], axis=0)
        return Plan(
            Status.FINISHED,
            motion=curve_named(settings.curve).motion(problem.waypoints, durations),
            durations=durations,
            evaluations=evaluations,
            iterations=len(runs[0].values),
            history=_synchronised_history(runs),
        )


@dataclass(frozen=True, eq=False)
class _Run:
    """One search: evaluations in all, and after every generation the incumbent's value and the durations to drive."""

    found: bool
    evaluations: int
    counts: Floats
    values: Floats
    durations: Floats


def _search(search: Search[Any], problem: Problem, settings: RunSettings, stream: np.random.SeedSequence) -> _Run:
    formulation = formulation_named(settings.formulation, problem, curve_named(settings.curve))
    meter = Meter(formulation, settings.evaluations)
    box = Box(*(np.full(problem.n_segments, bound) for bound in problem.duration_bounds))
    minimise(search, meter, box, settings.population, np.random.default_rng(stream))
    counts, values = meter.history.T
    found = meter.incumbent is not None
    return _Run(found, meter.evaluations, counts, values, formulation.realise(meter.incumbents))


def _synchronised_history(runs: list[_Run]) -> Floats:
    """Total time of the joints' incumbents put together, plus whatever penalty they carry, after every generation."""
    together = np.max([run.durations for run in runs], axis=0).sum(axis=1)
    penalty = np.sum([run.values - run.durations.sum(axis=1) for run in runs], axis=0)
    return np.column_stack([np.sum([run.counts for run in runs], axis=0), together + penalty])
