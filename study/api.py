"""The few functions that most users need: `plan` one motion, `compare` planners, both judged exactly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import Future
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from study.answers import Comparison, Planned, stops_everywhere
from study.arrays import at_least_zero, frozen_array, of_kind, whole
from study.cautions import unbounded_joints
from study.deadline import NEVER, Deadline
from study.errors import StudyError, short
from study.planning import RunSettings, single_move, usual_settings
from study.problem import Demand, Problem, State
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

LEAST = 0.1
"""Time limit of a planner whose turn comes when a tier's time is over, s."""


def plan(problem: Problem, planner: str = "auto", settings: RunSettings | None = None) -> Planned:
    """Plan one motion through the waypoints and have it judged.

    Parameters
    ----------
    problem : Problem
    planner : str
        A name that `study list` prints, or a tier. `best`, by default as `auto`, runs every planner of
        `automatic(problem)`; the fastest feasible motion of all is the answer, so it is never slower than a stop at every
        waypoint, nor than `fast`. `fast` ends at the first feasible motion of quick planners, or at a stop at every
        waypoint where that is faster.
    settings : RunSettings, optional
        `usual_settings(problem)` by default; its time limit holds for a planner, or for all of a tier together.

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
    stages, deadline = list[tuple[str, ...]]([(planner,)]), NEVER
    if planner in TIERS:
        stages, deadline = _stages(problem, planner), Deadline.after(settings.time_limit)
    planned = _planned(problem, stages[0], settings, deadline)
    for names in stages[1:]:
        if planned.feasible and (deadline.passed() or not stops_everywhere(problem, planned.motion)):
            break
        planned = _planned(problem, names, settings, deadline, planned)
    if planner == "fast" and planned.feasible and not any(name in DIRECT for name, _, _ in planned.tried):
        planned = _planned(problem, DIRECT, settings, deadline, planned)
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
        Worker processes; with one, by default, this process does all. A script that starts workers runs its own work
        under `if __name__ == "__main__":`.

    Raises
    ------
    StudyError
        If there is no such planner, or no worker. What goes wrong with one problem is the reason in its own answer.
    """
    if not isinstance(problems, Iterable):
        raise StudyError(f"plan_many needs a list of problems, got {short(problems)}")
    asked = [of_kind(problem, Problem, "every one of the problems") for problem in problems]
    whole(jobs, 1, "jobs")
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
    of_kind(problem, Problem, "problem")
    if not isinstance(motion, Motion) or motion.n_joints != problem.n_joints:
        kind = f"one of {motion.n_joints}" if isinstance(motion, Motion) else type(motion).__name__
        raise StudyError(f"case {problem.name!r} needs a motion of {problem.n_joints} joints under way, got {kind}")
    new = np.atleast_2d(frozen_array(waypoints, "waypoints"))
    if new.ndim != 2 or new.shape[1] != problem.n_joints:
        raise StudyError(f"waypoints must have shape (n_new, {problem.n_joints}), got {new.shape}")
    at_least_zero(time, "time")
    place, *rates = (motion(np.array([time]), order)[0] for order in range(3))
    room = problem.limits
    place = np.clip(place, room.lower, room.upper)
    rates = [np.clip(r, low, high) for r, low, high in zip(rates, room.lowest_rates, room.highest_rates, strict=False)]
    limited = [np.isfinite(room.rates[order + 1]).any() for order in range(2)]
    state = State(rates[0] if limited[0] else None, rates[1] if limited[1] else None)
    finish = problem.finish if problem.finish is not None else problem.end
    return Problem(
        problem.name, np.vstack([place, new]), room, start=state, finish=finish, joint_names=problem.joint_names
    )


def _stages(problem: Problem, tier: str) -> list[tuple[str, ...]]:
    """Planners of a tier, in parts of which the next is run only where those before find nothing but stops."""
    direct = [DIRECT] if single_move(problem) else []
    if tier == "fast" and automatic(problem) != AUTO_UNBOUNDED:
        quick = FAST[Demand.JERK in problem.demands :] if problem.path is None else automatic(problem)
        return [*direct, *((name,) for name in quick)]
    return [*direct, automatic(problem), AUTO_RESERVE]


def _planned(
    problem: Problem,
    names: Sequence[str],
    settings: RunSettings,
    deadline: Deadline,
    before: Planned | None = None,
) -> Planned:
    """Run planners and keep the best motion of all, those that ran before among them; what cannot gain does not run."""
    tried = [] if before is None else list(before.tried)
    spared = {} if before is None else dict(before.spared)
    for name in names:
        best = min((result for _, _, result in tried), key=rank, default=None)
        least = 0.0 if best is None or not best.feasible else _least(problem, name)
        if best is not None and best.duration < least:
            spared[name] = least
        else:
            tried.append((name, planner_about(name), _run(problem, name, settings, deadline)))
    return Planned(problem, min((result for _, _, result in tried), key=rank), tuple(tried), spared=spared)


def _least(problem: Problem, name: str) -> float:
    """Time that a planner knows its motion to take at least, s; 0 where it knows none, or cannot be had."""
    try:
        known = getattr(planner_named(name), "least", None)
    except StudyError:
        return 0.0
    return 0.0 if known is None else float(known(problem))


def automatic(problem: Problem) -> tuple[str, ...]:
    """Planners that the tier `best` tries on a problem; `study.runs.selections` holds the choice."""
    if problem.path is not None:
        return AUTO_ON_LINES
    if unbounded_joints(problem)[problem.moving].all():
        return AUTO_UNBOUNDED
    return AUTO if Demand.JERK in problem.demands else AUTO_WITHOUT_JERK


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
    return Comparison(problem, tuple(sorted(results, key=rank)))


def _seeds(name: str, seeds: int) -> range:
    try:
        return range(seeds if planner_named(name).stochastic else 1)
    except StudyError:
        if name not in planner_names():
            raise
        return range(1)  # its result says what is missing


def _run(problem: Problem, name: str, settings: RunSettings, deadline: Deadline = NEVER) -> Result:
    """Run a planner in what is left of the time; its result is kept under the settings that were asked for."""
    cell, left = Cell(problem.name, name, name, settings), min(settings.time_limit, max(deadline.left(), LEAST))
    hurried = replace(cell, settings=replace(settings, time_limit=left))
    return replace(CellJob(hurried, problem).run(), cell=cell)


def rank(result: Result) -> tuple[bool, float, float]:
    """Order of results: feasible ones by duration, then the others by how far they break a limit."""
    verdict = result.verdict
    excess = np.inf if verdict is None else 0.0 if verdict.feasible else verdict.violation
    return not result.feasible, excess, result.duration
