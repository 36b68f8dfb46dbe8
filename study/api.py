"""The few functions that most users need: `plan` one motion, `compare` planners, both judged exactly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from study.arrays import of_kind, short, whole
from study.cautions import cautions, unbounded_joints
from study.errors import StudyError
from study.files import named
from study.io.export import controller_points, write_motion
from study.io.samples import Samples
from study.io.sampling import Sampling
from study.judge import Verdict
from study.path_findings import largest_deviation
from study.planning import RATE_LIMITS, RunSettings, Status, usual_settings
from study.problem import Demand, EndCondition, Problem, State
from study.registry import planner_about, planner_named, planner_names
from study.runs.execute import CellJob
from study.runs.pool import WorkerDied, WorkerPool
from study.runs.selections import (
    AUTO,
    AUTO_ON_LINES,
    AUTO_RESERVE,
    AUTO_UNBOUNDED,
    AUTO_WITHOUT_JERK,
    COMPARED,
    DIRECT,
    FAST,
)
from study.store.results import Cell, Result
from study.trajectory import Motion

__all__ = [
    "COMPARED",
    "TIERS",
    "Comparison",
    "Planned",
    "automatic",
    "compare",
    "onward",
    "plan",
    "plan_many",
    "usual_settings",
]

TIERS = {
    "best": "the shortest motion known: it starts from `fast` and never ends above it",
    "fast": "a short motion in milliseconds: the timing of a spline, or the free path with widths shared out alike",
    "auto": "another name of `best`",
}
"""Ways to let `plan` choose planners by itself."""

STILL = 1e-9
"""Share of a joint's largest speed below which the joint stands still."""


@dataclass(frozen=True, eq=False, repr=False)
class Planned:
    """Answer of `plan`.

    Attributes
    ----------
    problem : Problem
    result : Result
        The fastest feasible motion of all that were tried, else the one that breaks the limits least.
    tried : tuple of (str, str, Result)
        Planners in the order in which they ran, how each works, and its result.
    tier : str
        The tier that was asked for; empty where it was a planner.
    """

    problem: Problem
    result: Result
    tried: tuple[tuple[str, str, Result], ...]
    tier: str = ""

    @property
    def planner(self) -> str:
        """Name of the planner whose answer it is."""
        return self.result.cell.planner

    @property
    def why(self) -> str:
        """Reason why this motion is the answer, and why it stops at every waypoint where it does."""
        if not self.tier:
            lead = "it was asked for"
        elif not self.feasible:
            return "no motion keeps the limits, and this one breaks them least"
        elif self.planner in DIRECT and _single_move(self.problem):
            lead = "no move from rest to rest is faster"
        elif self.tier == "fast":
            lead = "the first feasible motion"
        else:
            count = sum(not _reason(result) for _, _, result in self.tried)
            lead = (
                f"the fastest of {count} feasible motions" if count > 1 else "the only feasible motion that was found"
            )
        about = next((about for name, about, _ in self.tried if name == self.planner), "")
        return f"{lead}: {about}{self._stopping}"

    @property
    def _stopping(self) -> str:
        if not (self.feasible and _stops_everywhere(self.problem, self.motion)):
            return ""
        others = [f"{name}: {reason}" for name, _, result in self.tried if (reason := _reason(result))]
        return f"; it stops at every waypoint, because {'; '.join(others) or 'nothing that was tried is faster'}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences to be read before the motion is driven: missing limits, and time limits that were reached."""
        late = [f"{n}: {r.message or r.status.value}" for n, _, r in self.tried if r.status is Status.TIMED_OUT]
        return (*cautions(self.problem), *late)

    def __repr__(self) -> str:
        end = (
            f"{self.duration:.6g} s by {self.planner}, feasible, at most {self.deviation:.4g} from the straight lines"
            if self.feasible
            else f"no feasible motion: {self.reason}"
        )
        tried = ", ".join(name for name, _, _ in self.tried)
        warned = "; ".join(self.warnings) or "none"
        return f"Planned {self.problem.name!r}: {end}\ntried: {tried}\nwarnings: {warned}"

    @property
    def feasible(self) -> bool:
        """True where the judge passed the motion."""
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
        """Verdict of the judge.

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

    @cached_property
    def deviation(self) -> float:
        """Largest distance of any joint from the straight lines between waypoints, rad or m.

        Raises
        ------
        StudyError
            If there is no motion.
        """
        return largest_deviation(self.problem, self.motion)

    @property
    def reason(self) -> str:
        """Why there is no feasible motion, one sentence; empty where there is one."""
        return _reason(self.result)

    def points(
        self,
        rate: float | None = None,
        points: int | None = None,
        *,
        accept_unbounded_acceleration: bool = False,
    ) -> Samples:
        """Points for a controller object: names, times and rates; see `study.io.export.controller_points`.

        Raises
        ------
        StudyError
            If a joint that moves has no acceleration limit and that is not accepted, or rate or number are impossible.
        """
        accepted = of_kind(accept_unbounded_acceleration, bool, "accept_unbounded_acceleration")
        return controller_points(
            self.motion, self.problem, Sampling(rate, points), accept_unbounded_acceleration=accepted
        )

    def write(
        self,
        path: str | Path,
        rate: float | None = None,
        points: int | None = None,
        *,
        accept_unbounded_acceleration: bool = False,
    ) -> Path:
        """Write the motion in the form that the file's name asks for; see `study.io.export.write_motion`.

        Raises
        ------
        StudyError
            If the file cannot be written, or a joint that moves has no acceleration limit and that is not accepted.
        """
        accepted, sampling = accept_unbounded_acceleration, Sampling(rate, points)
        of_kind(accepted, bool, "accept_unbounded_acceleration")
        return write_motion(self.motion, self.problem, named(path), sampling, accept_unbounded_acceleration=accepted)


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """Answer of `compare`: one result for each planner and seed, feasible ones first, then by duration."""

    problem: Problem
    results: tuple[Result, ...]

    @property
    def best(self) -> Result | None:
        """Fastest feasible result; None where there is none."""
        first = self.results[0]
        return first if first.verdict is not None and first.verdict.feasible else None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences to be read before any of the motions is driven."""
        return cautions(self.problem)

    def __str__(self) -> str:
        return "\n".join([*self.warnings, *_lines(self.results)])

    def __repr__(self) -> str:
        count, best = sum(not _reason(result) for result in self.results), self.best
        fastest = f"{best.cell.label}, {_duration(best):.6g} s" if best else "none"
        lead = f"Comparison on {self.problem.name!r}: {len(self.results)} runs, {count} feasible"
        return f"{lead}\nfastest feasible: {fastest}\nwarnings: {'; '.join(self.warnings) or 'none'}"


def plan(problem: Problem, planner: str = "auto", settings: RunSettings | None = None) -> Planned:
    """Plan one motion through the waypoints and have it judged.

    Parameters
    ----------
    problem : Problem
    planner : str
        A name that `study list` prints, or a tier. `best`, by default as `auto`, runs every planner of
        `automatic(problem)`; the fastest feasible motion of all is the answer, so it is never slower than a stop at every
        waypoint, nor than `fast`. `fast` ends at the first feasible motion of quick planners.
    settings : RunSettings, optional
        `usual_settings(problem)` by default; its time limit holds for every planner.

    Returns
    -------
    Planned

    Raises
    ------
    StudyError
        If there is no such planner. A planner that fails, or lacks a package, is a result with a reason.
    """
    of_kind(problem, Problem, "problem")
    if of_kind(planner, str, "planner") not in (*TIERS, *planner_names()):
        planner_named(planner)  # which says what there is
    settings = usual_settings(problem) if settings is None else of_kind(settings, RunSettings, "settings")
    stages = _stages(problem, planner) if planner in TIERS else [(planner,)]
    planned = _planned(problem, stages[0], settings)
    for names in stages[1:]:
        if planned.feasible and not _stops_everywhere(problem, planned.motion):
            break
        planned = _planned(problem, names, settings, planned.tried)
    return replace(planned, tier=planner if planner in TIERS else "")


def plan_many(
    problems: Iterable[Problem], planner: str = "auto", settings: RunSettings | None = None, jobs: int = 1
) -> list[Planned]:
    """Plan several problems, as `plan` does each; the answers stand in the order of the problems.

    Parameters
    ----------
    problems : iterable of Problem
    planner, settings
        As for `plan`.
    jobs : int
        Worker processes; with one, by default, this process does all.

    Raises
    ------
    StudyError
        If there is no such planner, or no worker. What goes wrong with one problem is the reason in its own answer.
    """
    asked = list(problems)
    if jobs < 1:
        raise StudyError(f"plan_many needs at least one job, got {jobs}")
    if jobs == 1 or len(asked) < 2:
        return [plan(problem, planner, settings) for problem in asked]
    if planner not in TIERS:
        planner_named(planner)
    pool = WorkerPool(min(jobs, len(asked)))
    try:
        futures = [pool.submit(plan, problem, planner, settings) for problem in asked]
        return [_settled(problem, planner, settings, f) for problem, f in zip(asked, futures, strict=True)]
    finally:
        pool.shutdown()


def _settled(problem: Problem, planner: str, settings: RunSettings | None, future: Future[Planned]) -> Planned:
    try:
        return future.result()
    except WorkerDied as error:
        cell = Cell(problem.name, planner, planner, settings or usual_settings(problem))
        return Planned(problem, CellJob(cell, problem).failed(str(error), 0.0), (), planner)


def onward(problem: Problem, motion: Motion, time: float, waypoints: ArrayLike) -> Problem:
    """Ask for a motion from the state that another one has at a time on to new waypoints, as an arm does while it moves.

    Parameters
    ----------
    problem : Problem
        Its limits hold, and its condition at the end.
    motion : Motion
        Under way.
    time : float, s
        Since its start.
    waypoints : array of shape (n_new, n_joints), rad or m
        Still to pass; where the arm is then is put before them.

    Raises
    ------
    StudyError
        If the waypoints do not fit, or the first is where the arm is already.
    """
    place, *rates = (motion(np.array([time]), order)[0] for order in range(3))
    room = problem.limits
    place = np.clip(place, room.lower, room.upper)
    rates = [np.clip(r, low, high) for r, low, high in zip(rates, room.lowest_rates, room.highest_rates, strict=False)]
    limited = [np.isfinite(room.rates[order + 1]).any() for order in range(2)]
    state = State(rates[0] if limited[0] else None, rates[1] if limited[1] else None)
    finish = problem.finish if problem.finish is not None else problem.end
    points = np.vstack([place, np.asarray(waypoints, dtype=float)])
    return Problem(problem.name, points, room, start=state, finish=finish, joint_names=problem.joint_names)


def _stages(problem: Problem, tier: str) -> list[tuple[str, ...]]:
    """Planners of a tier, in parts of which the next is run only where those before find nothing but stops."""
    direct = [DIRECT] if _single_move(problem) else []
    if tier == "fast" and automatic(problem) != AUTO_UNBOUNDED:
        quick = FAST[_jerky(problem) :] if problem.path is None else automatic(problem)
        return [*direct, *((name,) for name in quick)]
    return [*direct, automatic(problem), AUTO_RESERVE]


def _single_move(problem: Problem) -> bool:
    """Whether the problem is one move from rest to rest with nothing else to keep, whose optimum has a closed form."""
    smooth = problem.end is EndCondition.SMOOTH or (problem.end is EndCondition.REST and not _jerky(problem))
    return problem.n_waypoints == 2 and smooth and problem.planner_demands <= RATE_LIMITS | {Demand.POSITION_RANGE}


def _jerky(problem: Problem) -> bool:
    return bool(np.isfinite(problem.limits.jerk).any())


def _planned(
    problem: Problem, names: Sequence[str], settings: RunSettings, before: tuple[tuple[str, str, Result], ...] = ()
) -> Planned:
    """Run planners and keep the best motion of all, those that ran before among them."""
    tried = (*before, *((name, planner_about(name), _run(problem, name, settings)) for name in names))
    return Planned(problem, min((result for _, _, result in tried), key=_rank), tried)


def automatic(problem: Problem) -> tuple[str, ...]:
    """Planners that the tier `best` tries on a problem; `study.runs.selections` holds the choice."""
    if problem.path is not None:
        return AUTO_ON_LINES
    if unbounded_joints(problem)[problem.moving].all():
        return AUTO_UNBOUNDED
    return AUTO if _jerky(problem) else AUTO_WITHOUT_JERK


def _stops_everywhere(problem: Problem, motion: Motion) -> bool:
    """Tell if a motion rests at every waypoint between the ends."""
    if problem.n_waypoints < 3:
        return False
    speeds = np.abs(motion(motion.waypoint_times[1:-1], 1))
    return bool((speeds <= STILL * motion.extrema(1).peak).all())


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
    of_kind(problem, Problem, "problem")
    if not isinstance(planners, list | tuple) or not planners or not all(isinstance(name, str) for name in planners):
        raise StudyError(f"compare needs a list of at least one planner's name, got {short(planners)}")
    whole(seeds, 1, "the number of seeds")
    settings = usual_settings(problem) if settings is None else of_kind(settings, RunSettings, "settings")
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
    return CellJob(Cell(problem.name, name, name, settings), problem).run()


def _duration(result: Result) -> float:
    return np.inf if result.verdict is None else result.verdict.duration


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
