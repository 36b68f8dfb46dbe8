"""The few functions that most users need: `plan` one motion, `compare` planners, both judged exactly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from study.errors import StudyError
from study.io.export import write_motion
from study.judge import Verdict
from study.planning import RunSettings, usual_settings
from study.problem import Problem
from study.registry import planner_named, planner_names
from study.runs.execute import Task, execute
from study.store.results import Cell, Result
from study.trajectory import Motion

__all__ = ["COMPARED", "Comparison", "Planned", "automatic", "compare", "plan", "usual_settings"]

COMPARED = ("free-path-nlp", "ruckig-via", "casadi-nlp", "toppra", "ruckig-stops", "golds-pso", "random-search")
"""Planners that `compare` takes unless told otherwise: every deterministic kind, one metaheuristic and the floor."""

STRAIGHT = "only velocities are limited, and straight lines at full speed are then the exact optimum"
SMOOTHED = (
    "jerk is limited, so it moves with linear acceleration in every piece, and optimises how it passes the waypoints"
)
STEPPED = "acceleration is limited and jerk is not, so it moves at full acceleration, and optimises how it passes the waypoints"
FREED = "the planner before it gave no feasible motion, and a free path in many pieces comes as close to the optimum"
CURVED = "the planners before it gave no feasible motion, and durations on a spline can be optimised exactly"
STOPPING = (
    "the planners before it gave no feasible motion; stopping at every waypoint never leaves the waypoints' range"
)


@dataclass(frozen=True, eq=False)
class Planned:
    """What `plan` found.

    Attributes
    ----------
    problem : Problem
    result : Result
        The answer: the first feasible one, else the one that breaks the limits least.
    tried : tuple of (str, str, Result)
        Planners in the order in which they ran, why each was chosen, and what came of it.
    """

    problem: Problem
    result: Result
    tried: tuple[tuple[str, str, Result], ...]

    @property
    def planner(self) -> str:
        """Name of the planner whose answer it is."""
        return self.result.cell.planner

    @property
    def why(self) -> str:
        """Why that planner was taken."""
        return next(why for _, why, result in self.tried if result is self.result)

    @property
    def feasible(self) -> bool:
        """Whether the judge passed the motion."""
        return self.result.verdict is not None and self.result.verdict.feasible

    @property
    def motion(self) -> Motion:
        """The motion, feasible or not.

        Raises
        ------
        StudyError
            If no planner gave one.
        """
        if self.result.motion is None:
            raise StudyError(f"case {self.problem.name!r}: {self.reason}")
        return self.result.motion

    @property
    def verdict(self) -> Verdict:
        """What the judge found.

        Raises
        ------
        StudyError
            If there is no motion to judge.
        """
        if self.result.verdict is None:
            raise StudyError(f"case {self.problem.name!r}: {self.reason}")
        return self.result.verdict

    @property
    def duration(self) -> float:
        """Total time, s; infinite where there is no feasible motion."""
        return self.verdict.duration if self.feasible else np.inf

    @property
    def reason(self) -> str:
        """Why there is no feasible motion, one sentence; empty where there is one."""
        return _reason(self.result)

    def write(self, path: str | Path, rate: float | None = None) -> Path:
        """Write the motion in the form that the file's name asks for; see `study.io.export.write_motion`."""
        return write_motion(self.motion, self.problem, Path(path), rate)


@dataclass(frozen=True, eq=False)
class Comparison:
    """What `compare` found: one result for each planner and seed, feasible ones first, then by duration."""

    problem: Problem
    results: tuple[Result, ...]

    @property
    def best(self) -> Result | None:
        """Fastest feasible result; None where there is none."""
        first = self.results[0]
        return first if first.verdict is not None and first.verdict.feasible else None

    def __str__(self) -> str:
        return "\n".join(_lines(self.results))


def plan(problem: Problem, planner: str = "auto", settings: RunSettings | None = None) -> Planned:
    """Plan one motion through the waypoints and have it judged.

    Parameters
    ----------
    problem : Problem
    planner : str
        A name that `study list` prints, or `auto`: planners that suit the limits one after the other, until the judge
        passes a motion.
    settings : RunSettings, optional
        `usual_settings(problem)` by default.

    Returns
    -------
    Planned

    Raises
    ------
    StudyError
        If there is no such planner. A planner that fails, or lacks a package, is a result with a reason.
    """
    if planner != "auto" and planner not in planner_names():
        planner_named(planner)  # which says what there is
    tried: list[tuple[str, str, Result]] = []
    for name, why in automatic(problem) if planner == "auto" else [(planner, "it was asked for")]:
        tried.append((name, why, _run(problem, name, settings or usual_settings(problem))))
        if not _reason(tried[-1][2]):
            break
    return Planned(problem, min((result for _, _, result in tried), key=_rank), tuple(tried))


def automatic(problem: Problem) -> Iterator[tuple[str, str]]:
    """Name planners that suit a problem, best first, each with why."""
    moving = np.ptp(problem.waypoints, axis=0) > 0
    limited = np.isfinite(problem.limits.rates[1:, moving])
    acceleration, jerk = bool(limited[0].any()), bool(limited[1].any())
    if not (acceleration or jerk):
        yield "free-path-nlp", STRAIGHT
    else:
        yield "ruckig-via", SMOOTHED if jerk else STEPPED
        yield "free-path-nlp", FREED
        yield "casadi-nlp", CURVED
    yield "ruckig-stops", STOPPING


def compare(
    problem: Problem, planners: Sequence[str] = COMPARED, settings: RunSettings | None = None, seeds: int = 1
) -> Comparison:
    """Put the same problem to several planners, one after the other in this process, and rank what the judge finds.

    Parameters
    ----------
    problem : Problem
    planners : sequence of str
    settings : RunSettings, optional
        `usual_settings(problem)` by default.
    seeds : int
        Runs of every search, its seed counted up; deterministic planners run once.

    Raises
    ------
    StudyError
        If there is no such planner, or no planner or no seed is asked for. A missing package is a result's reason.
    """
    if not planners or seeds < 1:
        raise StudyError(f"compare needs at least one planner and one seed, got {len(planners)} and {seeds}")
    settings = settings or usual_settings(problem)
    results = [
        _run(problem, name, replace(settings, seed=settings.seed + k)) for name in planners for k in _seeds(name, seeds)
    ]
    return Comparison(problem, tuple(sorted(results, key=_rank)))


def _seeds(name: str, seeds: int) -> range:
    try:
        return range(seeds if planner_named(name).stochastic else 1)
    except StudyError:
        if name not in planner_names():
            raise
        return range(1)  # its result says what is missing


def _run(problem: Problem, name: str, settings: RunSettings) -> Result:
    return execute(Task(Cell(problem.name, name, name, settings), problem))


def _reason(result: Result) -> str:
    """Why a result is not a feasible motion; empty where it is one."""
    if result.verdict is None:
        return result.message or result.status.value
    return "; ".join(result.verdict.reasons)


def _rank(result: Result) -> tuple[bool, float, float]:
    verdict = result.verdict
    if verdict is None:
        return True, np.inf, np.inf
    return not verdict.feasible, 0.0 if verdict.feasible else verdict.violation, verdict.duration


def _lines(results: Sequence[Result]) -> Iterator[str]:
    width = max(len(result.cell.label) for result in results)
    for result in results:
        duration = "" if result.verdict is None else f"{result.verdict.duration:.5g} s"
        seed = f"seed {result.cell.settings.seed}" if result.evaluations else ""
        said = _reason(result) or "feasible"
        yield f"{result.cell.label:<{width}}  {duration:>12}  {seed:<8}  {said}".rstrip()
