"""Conformance tests for planners and searches, for everyone who writes one: call them from a test of your own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from study.bounds import Bound, LowerBound, undescribed_bound
from study.curves import CURVES
from study.demands import refusal
from study.errors import StudyError, unforeseen
from study.judge import judge
from study.parametric import ParametricTrajectory
from study.planning import (
    Meter,
    Plan,
    Planner,
    RunSettings,
    Status,
    Synchronisation,
    undescribed,
    usual_settings,
)
from study.problem import Floats, Problem
from study.search.state import Box, Search, State
from study.slowing import fitted, told
from study.testing.problems import example_problems
from study.trajectory import Motion, Trajectory


class NonconformingError(AssertionError):
    """A planner or search breaks the contract; the text says which part of it."""


def check_planner(
    planner: Planner,
    problems: Sequence[Problem] | None = None,
    settings: RunSettings | None = None,
    may_be_infeasible: bool = False,
) -> None:
    """Test a planner against the contract of `study.planning.Planner`.

    Its answers must be plans; what it calls finished must pass the judge; its evaluations must stay within the budget; the
    same seed must give the same bytes; problems and NumPy's global random state must stay as they were; a failure
    must have a reason; and at least one problem must be solved. Problems with demands that it does not know are left out, and
    where it does not know a limit of rates or positions, its motion may break it; it has then solved the problem if a slower
    run keeps the limits.

    Parameters
    ----------
    planner : Planner
    problems : sequence of Problem, optional
        `example_problems()` by default.
    settings : RunSettings, optional
        300 evaluations of feasible-by-stretching candidates on each problem's usual curve by default.
    may_be_infeasible : bool
        For planners that do not know some kind of limit, as TOPP-RA does not know jerk.

    Raises
    ------
    NonconformingError
        With one sentence for the first part of the contract that is broken.
    """
    _require(not (reason := undescribed(planner)), reason)
    chosen = problems or example_problems()
    solved = [_solves(planner, case, settings or _settings(case), may_be_infeasible) for case in chosen]
    _require(any(solved), "the planner solved none of the problems")


def _settings(problem: Problem) -> RunSettings:
    return replace(usual_settings(problem), seed=1, evaluations=300, population=20)


def _solves(planner: Planner, problem: Problem, settings: RunSettings, may_be_infeasible: bool) -> bool:
    if refusal(problem.planner_demands, planner.knows):
        return False
    where, before = f"on {problem.name!r}", _numbers(problem)
    random_before = _global_random_state()
    first, second = (_answer(planner, problem, settings, where) for _ in range(2))
    _require(_numbers(problem) == before, f"{where} the planner changed the problem")
    _require(_global_random_state() == random_before, f"{where} it used NumPy's global random state; use the seed")
    if isinstance(first, StudyError) or isinstance(second, StudyError):
        _require(str(first) == str(second), f"{where} the same seed gave different answers")
        _require("\n" not in str(first) and bool(str(first)), f"{where} its reason is not one sentence: {first}")
        return False
    _require(_motion_numbers(first.motion) == _motion_numbers(second.motion), f"{where} one seed gave two motions")
    limit = settings.evaluations * (problem.n_joints if settings.synchronisation is Synchronisation.PER_JOINT else 1)
    _require(first.evaluations <= limit, f"{where} it used {first.evaluations} evaluations of {limit}")
    if first.motion is None:
        _require(first.status is not Status.FINISHED, f"{where} it says that it finished, but there is no motion")
        _require(bool(first.message), f"{where} it gave neither a motion nor a reason")
        return False
    verdict = judge(problem, first.motion)
    promised = first.status is Status.FINISHED and not may_be_infeasible and problem.demands <= planner.knows
    _require(verdict.feasible or not promised, f"{where} its motion is infeasible: {'; '.join(verdict.reasons)}")
    return verdict.feasible or (not promised and judge(problem, first.motion.scaled(verdict.stretch)).feasible)


def _answer(planner: Planner, problem: Problem, settings: RunSettings, where: str) -> Plan | StudyError:
    try:
        plan = planner.plan(told(planner, problem), settings)
        plan = fitted(problem, plan) if isinstance(plan, Plan) else plan
    except StudyError as error:
        return error
    except Exception as error:
        raise NonconformingError(
            f"{where} it raised {unforeseen(error)}; return a plan with a status and a message"
        ) from error
    _require(isinstance(plan, Plan), f"{where} it returned a {type(plan).__name__}, not a study.planning.Plan")
    return plan


def check_bound(bound: Bound, problems: Sequence[Problem] | None = None, settings: RunSettings | None = None) -> None:
    """Test a bound against the contract of `study.bounds.Bound`.

    It must answer with a lower bound that no feasible motion undercuts, the same one twice, and leave problems and NumPy's
    global random state as they were.

    Parameters
    ----------
    bound : Bound
    problems : sequence of Problem, optional
        `example_problems()` by default.
    settings : RunSettings, optional
        On the clamped cubic spline by default.

    Raises
    ------
    NonconformingError
        With one sentence for the first part of the contract that is broken.
    """
    reason = undescribed_bound(bound)
    _require(not reason, reason)
    chosen = settings or RunSettings("cubic-spline")
    for problem in problems or example_problems():
        if refusal(problem.demands, bound.knows):
            continue
        where, before, random_before = f"on {problem.name!r}", _numbers(problem), _global_random_state()
        first, second = (bound.bound(problem, chosen) for _ in range(2))
        _require(isinstance(first, LowerBound), f"{where} it answered with a {type(first).__name__}, no LowerBound")
        _require(first.value == second.value, f"{where} it proved two bounds: {first.value:g} and {second.value:g} s")
        _require(_numbers(problem) == before, f"{where} the bound changed the problem")
        _require(_global_random_state() == random_before, f"{where} it used NumPy's global random state")
        reached = _reached(problem, chosen.curve)
        _require(
            first.value <= reached, f"{where} a motion takes {reached:g} s, less than the bound of {first.value:g} s"
        )


def _reached(problem: Problem, curve: str) -> float:
    """Duration of a feasible motion on the settings' curve, s; infinite where there is none."""
    motion = CURVES[curve].motion(problem.waypoints, np.ones(problem.n_segments))
    motion = motion.scaled(judge(problem, motion).stretch)
    return motion.duration if judge(problem, motion).feasible else np.inf


def check_search(search: Search[Any], n_dimensions: int = 4, budget: int = 600, population: int = 20) -> None:
    """Test a search against the contract of `study.search.loop.Search` on a shifted sphere.

    Candidates must be finite and in the box, states must not change once made, the same seed must give the same candidates,
    infinite values must not break it, its incumbent must be the best candidate told, and it must improve on its first
    generation.

    Parameters
    ----------
    search : Search
    n_dimensions, budget, population : int

    Raises
    ------
    NonconformingError
        With one sentence for the first part of the contract that is broken.
    """
    box = Box(np.linspace(-3.0, 1.0, n_dimensions), np.linspace(2.0, 9.0, n_dimensions))
    goal = box.at(np.linspace(0.3, 0.6, n_dimensions))

    def sphere(points: Floats) -> Floats:
        return ((points - goal) ** 2).sum(axis=1)

    def mostly_infinite(points: Floats) -> Floats:
        return np.where(points[:, 0] < goal[0], np.inf, sphere(points))

    runs = [_drive(search, Meter(sphere, budget), box, population) for _ in range(2)]
    _require(all(map(np.array_equal, *runs)), "the same seed gave different candidates")
    _require(
        sphere(np.concatenate(runs[0])).min() < sphere(runs[0][0]).min(), "it never improved on its first generation"
    )
    _drive(search, Meter(mostly_infinite, budget), box, population)
    _drive(search, Meter(lambda points: np.full(len(points), np.inf), 3 * population), box, population)


def _drive(search: Search[Any], meter: Meter, box: Box, population: int, seed: int = 0) -> list[Floats]:
    rng, generations = np.random.default_rng(seed), -(-meter.budget // population)
    random_before = _global_random_state()
    state, asked = search.init(box, population, generations, rng), []
    while True:
        asked.append(_in_box(state, box))
        before, values = _numbers(state), meter(state.candidates)
        told = search.tell(state, values, rng)
        _require(_numbers(state) == before, "tell changed the state it was given; make a new one")
        _require(told.incumbent_value <= meter.incumbent_value, "its incumbent is not the best candidate it was told")
        if meter.exhausted:
            _require(_global_random_state() == random_before, "it used NumPy's global random state; use the generator")
            return asked
        before = _numbers(told)
        state = search.ask(told, rng)
        _require(_numbers(told) == before, "ask changed the state it was given; make a new one")


def _in_box(state: State, box: Box) -> Floats:
    points = np.asarray(state.candidates)
    _require(points.ndim == 2 and points.shape[1] == len(box.lower), f"candidates have shape {points.shape}")
    _require(bool(np.isfinite(points).all()), "a candidate is not finite")
    _require(bool(((points >= box.lower) & (points <= box.upper)).all()), "a candidate lies outside the box")
    return points.copy()


def _require(holds: bool, sentence: str) -> None:
    if not holds:
        raise NonconformingError(sentence)


def _global_random_state() -> str:
    return str(np.random.get_state())  # noqa: NPY002  # to see that nobody else uses it


def _numbers(part: Any) -> list[Any]:
    """All numbers below a dataclass, as plain data that can be compared."""
    if isinstance(part, np.ndarray):
        return [part.shape, part.tobytes()]
    if hasattr(part, "__dataclass_fields__"):
        return [_numbers(getattr(part, field.name)) for field in fields(part)]
    return [repr(part)]


def _motion_numbers(motion: Motion | None) -> list[Any]:
    parts: Iterable[str] = ()
    if isinstance(motion, Trajectory):
        parts = ("knots", "coefficients", "waypoint_times")
    elif isinstance(motion, ParametricTrajectory):
        parts = ("time", "position")
    return [getattr(motion, part).tobytes() for part in parts]
