"""Random problems for every reference planner: how many are solved, how many end with a reason, and that none crashes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

import numpy as np

from study.api import TIERS, plan
from study.demands import refusal
from study.errors import StudyError, unforeseen
from study.judge import judge
from study.planning import RunSettings, Status, usual_settings
from study.problem import Problem
from study.registry import peer_names, planner_named, planner_names, unavailable_planners
from study.runs.pool import Overdue, WorkerDied, WorkerPool
from study.slowing import fitted, told
from study.testing import random_problem
from study.testing.sampler import sampled
from study.trajectory import Motion

FEASIBLE, REASON, WRONG, HANG, CRASH = (
    "feasible, confirmed",
    "stated reason",
    "infeasible, unannounced",
    "hang",
    "crash",
)
ENDS = (FEASIBLE, REASON, WRONG, HANG, CRASH)
"""Possible ends of an attempt; a feasible motion is one that the judge passes and the sampler confirms."""

MUST_NOT = (WRONG, HANG, CRASH)
"""Ends that must not be; a planner hangs if it is still at work 10 s after twice its time limit."""


@dataclass(frozen=True)
class Attempt:
    """One planner on one random problem.

    Attributes
    ----------
    planner : str
    seed, number : int
        Of the problem.
    time_limit : float, s
    """

    planner: str
    seed: int
    number: int
    time_limit: float


@dataclass(frozen=True)
class AttemptEnd:
    """End of an attempt, its explanation in a sentence, and the instants at which a feasible motion was sampled."""

    attempt: Attempt
    kind: str
    sentence: str
    instants: int = 0


def reference_planners() -> list[str]:
    """Deterministic planners that can be loaded, without the peers."""
    usable = [name for name in planner_names() if name not in {*unavailable_planners(), *peer_names()}]
    return [name for name in usable if not planner_named(name).stochastic]


def problem_number(seed: int, number: int) -> Problem:
    """Draw one of a seed's problems, whatever the others are."""
    return random_problem(np.random.default_rng([seed, number]), f"random {seed}/{number}")


def endure(attempt: Attempt) -> AttemptEnd:
    """Let a planner solve a random problem and judge it."""
    problem = problem_number(attempt.seed, attempt.number)
    usual = usual_settings(problem)
    settings = RunSettings(
        usual.curve, seed=attempt.number, formulation=usual.formulation, time_limit=attempt.time_limit
    )
    if attempt.planner in TIERS:
        return _by_tier(attempt, problem, settings)
    planner = planner_named(attempt.planner)
    if reason := refusal(problem.planner_demands, planner.knows):
        return AttemptEnd(attempt, REASON, reason)
    try:
        plan = fitted(problem, planner.plan(told(planner, problem), settings))
        verdict = None if plan.motion is None else judge(problem, plan.motion)
    except StudyError as error:
        return AttemptEnd(attempt, REASON, str(error))
    except Exception as error:  # this is what is looked for
        return AttemptEnd(attempt, CRASH, unforeseen(error))
    if verdict is None:
        return AttemptEnd(attempt, REASON if plan.message else WRONG, plan.message or "neither a motion nor a reason")
    if verdict.feasible and plan.motion is not None:
        return _sampled(attempt, problem, plan.motion)
    if ignored := sorted(problem.demands - planner.knows):
        return AttemptEnd(attempt, REASON, f"it does not know {' or '.join(ignored)}, which the problem has")
    announced = plan.status is not Status.FINISHED and plan.message
    return AttemptEnd(
        attempt, REASON if announced else WRONG, plan.message if announced else "; ".join(verdict.reasons)
    )


def _sampled(attempt: Attempt, problem: Problem, motion: Motion) -> AttemptEnd:
    """Put a motion that the judge passes to the sampler."""
    second = sampled(problem, motion)
    if second.confirmed:
        return AttemptEnd(attempt, FEASIBLE, "", second.instants)
    return AttemptEnd(attempt, WRONG, f"the judge passes it, a sample exceeds {second.worst} by {second.excess:.3g}")


def _by_tier(attempt: Attempt, problem: Problem, settings: RunSettings) -> AttemptEnd:
    """Let a tier of `plan` solve a problem; it judges by itself, so that no motion breaks a limit unannounced."""
    try:
        planned = plan(problem, attempt.planner, settings)
    except Exception as error:  # this is what is looked for
        return AttemptEnd(attempt, CRASH, unforeseen(error))
    if planned.feasible:
        return _sampled(attempt, problem, planned.motion)
    return AttemptEnd(attempt, REASON if planned.reason else WRONG, planned.reason or "neither a motion nor a reason")


def torture(
    planners: Sequence[str],
    problems: int,
    seed: int,
    time_limit: float,
    jobs: int,
    on_end: Callable[[AttemptEnd], None] = lambda outcome: None,
) -> dict[str, Counter[str]]:
    """Put random problems to planners, in processes that may die.

    Parameters
    ----------
    planners : sequence of str
    problems : int
    seed : int
    time_limit : float, s
        For each planner on each problem.
    jobs : int
        Worker processes.
    on_end : callable, optional
        Told of every end, in order.

    Returns
    -------
    dict of str to Counter
        For every planner how often each of `ENDS` came.
    """
    counts = {name: Counter[str]() for name in planners}
    pool = WorkerPool(jobs, lambda attempt: 2.0 * attempt.time_limit + 10.0)
    try:
        attempts = [Attempt(name, seed, k, time_limit) for k in range(problems) for name in planners]
        for attempt, future in [(attempt, pool.submit(endure, attempt)) for attempt in attempts]:
            end = _settled(attempt, future)
            counts[attempt.planner][end.kind] += 1
            on_end(end)
    finally:
        pool.shutdown(cancel_futures=True)
    return counts


def _settled(attempt: Attempt, future: Future[AttemptEnd]) -> AttemptEnd:
    try:
        return future.result()
    except Overdue as error:
        return AttemptEnd(attempt, HANG, str(error))
    except WorkerDied as error:
        return AttemptEnd(attempt, CRASH, str(error))
