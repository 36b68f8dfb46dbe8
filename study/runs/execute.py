"""Run one planner on one problem: plan, time, judge, and turn whatever goes wrong into a record."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from study.deadline import watched
from study.demands import refusal
from study.errors import StudyError
from study.judge import judge
from study.planning import Plan, Status, in_time
from study.problem import Problem
from study.registry import planner_named
from study.runs.pool import speaker
from study.runs.progress import reporting
from study.store.codec import check_storable
from study.store.results import Cell, Result


@dataclass(frozen=True, eq=False)
class Task:
    """A cell and the problem that it is about, as sent to a worker."""

    cell: Cell
    problem: Problem


def execute(task: Task) -> Result:
    """Plan, time and judge one cell; whatever goes wrong in the planner becomes the result's reason."""
    started = time.perf_counter()
    try:
        planner = planner_named(task.cell.planner)
        started = time.perf_counter()
        if reason := refusal(task.problem.planner_demands, planner.knows):
            return failed(task.cell, reason, 0.0, Status.NOT_APPLICABLE)
        with watched() as watch, reporting(speaker()):
            plan = in_time(task.problem, planner.plan(task.problem, task.cell.settings))
        wall_time = time.perf_counter() - started
        return judged(task, cut_short(plan) if watch.reached else plan, wall_time)
    except StudyError as error:
        reason = str(error)
    except MemoryError:
        reason = "memory ran out"
    except Exception as error:  # a planner may raise anything; it is a record, not a crash
        reason = f"{type(error).__name__}: {error}"
    return failed(task.cell, reason, time.perf_counter() - started)


def cut_short(plan: Plan) -> Plan:
    """Say of a plan that the clock had a part in it: with more time, or on another machine, it might be another."""
    message = "; ".join(filter(None, (plan.message, "a time limit inside the planner was reached")))
    return replace(plan, status=Status.TIMED_OUT, message=message)


def judged(task: Task, plan: Plan, wall_time: float) -> Result:
    """Build the result of a cell whose planner came back."""
    if plan.motion is not None:
        check_storable(plan.motion)
    return Result(
        cell=task.cell,
        status=plan.status,
        message=plan.message,
        motion=plan.motion,
        verdict=None if plan.motion is None else judge(task.problem, plan.motion),
        durations=plan.durations,
        evaluations=plan.evaluations,
        iterations=plan.iterations,
        history=plan.history,
        details=plan.details,
        wall_time=wall_time,
    )


def failed(cell: Cell, reason: str, wall_time: float, status: Status = Status.FAILED) -> Result:
    """Build the result of a cell that brought no motion."""
    nothing = np.empty((0, 2))
    return Result(cell, status, " ".join(reason.split()), None, None, None, 0, 0, nothing, {}, wall_time)
