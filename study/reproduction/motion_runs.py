"""Run a paper's planner on its own case from every seed, and find the fastest motion on the same curve beside it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from study.cases.library import Case, load_case
from study.curves import curve_named
from study.errors import StudyError
from study.judge import Verdict, judge
from study.planners.segment_times import SegmentTimePlanner
from study.planning import Plan, RunSettings, Synchronisation
from study.problem import Floats, Problem
from study.registry import planner_named
from study.reproduction.benchmark_runs import thinned
from study.reproduction.convergence import settled
from study.reproduction.jobs import Record, RecordJob
from study.search.state import Search
from study.trajectory import Motion

REFERENCE = "casadi-nlp"
"""Registry name of the deterministic reference on the paper's curve."""


def case_content(name: str) -> list[object]:
    """Problem, curve and settings of a case: all that a run of ours takes from it."""
    case = load_case(name)
    return [case.problem, case.curve, case.settings]


def problem_of(case: Case, joint: int | None) -> Problem:
    """The case's problem, or that of one joint alone, counted from 0."""
    return case.problem if joint is None else case.problem.joint(joint)


@dataclass(frozen=True)
class MotionJob(RecordJob):
    """A search for segment durations on a case.

    Attributes
    ----------
    case : str
    search : Search
    joint : int, optional
        Counted from 0; None moves all joints together.
    population, generations, seeds : int
    """

    case: str
    search: Search[Any]
    joint: int | None
    population: int
    generations: int
    seeds: int
    kind: ClassVar[str] = "motion"
    weight: ClassVar[float] = 4.0

    @property
    def subject(self) -> str:
        """Name of the case."""
        return self.case

    def inputs(self) -> object:
        """Return the case's problem, curve and settings."""
        return case_content(self.case)

    def run(self) -> Record:
        """Durations, objective values and generations until convergence of every seed, and the median curve."""
        case = load_case(self.case)
        problem = problem_of(case, self.joint)
        plans = [self._plan(case, problem, seed) for seed in range(self.seeds)]
        histories = np.array([plan.history[:, 1] for plan in plans])
        shown = thinned(histories.shape[1])
        return {
            "durations": [_durations(plan).tolist() for plan in plans],
            "finals": histories[:, -1].tolist(),
            "settled": _settled(histories, problem),
            "generations": (shown + 1).tolist(),
            "curve": np.median(histories, axis=0)[shown].tolist(),
        }

    def _plan(self, case: Case, problem: Problem, seed: int) -> Plan:
        budget = self.population * self.generations
        settings = RunSettings(case.curve, seed, budget, self.population, case.settings.formulation)
        return SegmentTimePlanner(self.search).plan(problem, settings)


@dataclass(frozen=True)
class OptimumJob(RecordJob):
    """The fastest motion on the paper's curve, by the deterministic reference.

    Attributes
    ----------
    case : str
    joint : int, optional
    """

    case: str
    joint: int | None = None
    kind: ClassVar[str] = "optimum"
    weight: ClassVar[float] = 1.0

    @property
    def subject(self) -> str:
        """Name of the case."""
        return self.case

    @property
    def method(self) -> str:
        """Registry name of the reference."""
        return REFERENCE

    def inputs(self) -> object:
        """Return the case's problem, curve and settings."""
        return case_content(self.case)

    def planners(self) -> tuple[str, ...]:
        """Name the reference."""
        return (REFERENCE,)

    def run(self) -> Record:
        """Durations and total in s; the message of the solver. A joint that stands still takes the least durations."""
        case = load_case(self.case)
        problem = problem_of(case, self.joint)
        if not problem.moving.any():
            least = [problem.duration_bounds[0]] * problem.n_segments
            return {"durations": least, "total": sum(least), "message": ""}
        plan = planner_named(REFERENCE).plan(problem, replace(case.settings, synchronisation=Synchronisation.SHARED))
        if plan.motion is None:
            raise StudyError(f"case {self.case!r}: {REFERENCE} found no motion: {plan.message}")
        return {"durations": _durations(plan).tolist(), "total": plan.motion.duration, "message": plan.message}


def _durations(plan: Plan) -> Floats:
    if plan.durations is None:
        raise StudyError(f"reproduction: a run ended without durations: {plan.message or plan.status.value}")
    return plan.durations


def _settled(histories: Floats, problem: Problem) -> dict[str, list[int]]:
    """Generations of convergence; the descent begins with the first feasible candidate, or never."""
    feasible = histories <= problem.n_segments * problem.duration_bounds[1]
    first = [int(row.argmax()) if row.any() else len(row) - 1 for row in feasible]
    return settled([history[start:] for history, start in zip(histories, first, strict=True)], first)


def motion_of(case: Case, durations: Floats, joint: int | None = None) -> Motion:
    """Drive the case's waypoints with given segment durations, shape (n_segments,), s."""
    return curve_named(case.curve).motion(problem_of(case, joint).waypoints, np.asarray(durations, dtype=float))


def judged(case: Case, durations: Floats, joint: int | None = None) -> Verdict:
    """Judge segment durations on a case, or on one joint of it."""
    return judge(problem_of(case, joint), motion_of(case, durations, joint))


@dataclass(frozen=True, eq=False)
class Summary:
    """Feasible motions of all seeds.

    Attributes
    ----------
    durations : array of shape (n_segments,), s
        Of the seed with the median total.
    total, best : float, s
        Median and least total.
    feasible, runs : int
    totals : tuple of float, s
        Of the feasible seeds.
    """

    durations: Floats
    total: float
    best: float
    feasible: int
    runs: int
    totals: tuple[float, ...]

    @property
    def text(self) -> str:
        """Remark beside a duration: the best of the runs, and how many keep the limits."""
        share = "" if self.feasible == self.runs else f"; {self.feasible} of {self.runs} runs feasible"
        return f"best of {self.runs} seeds {self.best:.4f} s{share}"


def summarised(case: Case, per_seed: Floats, joint: int | None = None) -> Summary | None:
    """Summarise runs, shape (n_seeds, n_segments), s; None where no run is feasible."""
    kept = [row for row in np.asarray(per_seed) if judged(case, row, joint).feasible]
    if not kept:
        return None
    ordered = sorted(kept, key=lambda row: float(row.sum()))
    middle = ordered[(len(ordered) - 1) // 2]
    totals = tuple(float(row.sum()) for row in ordered)
    return Summary(middle, float(middle.sum()), totals[0], len(kept), len(per_seed), totals)


def synchronised(records: list[Record]) -> Floats:
    """Longest duration of every segment over the joints, seed by seed: shape (n_seeds, n_segments), s."""
    return np.max([record["durations"] for record in records], axis=0)
