"""Planning with a deadline in threads, in running event loops as notebooks have them, and in spawned processes."""

import asyncio
import multiprocessing
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

from study import JointLimits, Problem, plan
from study.planning import RunSettings
from tests.helpers.stores import TINY

SETTINGS = RunSettings("cubic-spline-smooth", formulation="scaled", time_limit=20.0)
PLANNERS = ("casadi-nlp", "ruckig-via", "toppra", "casadi-nlp", "free-path", "ruckig-stops")


def duration(planner):
    """What is asked of every thread, loop and process."""
    return plan(TINY, planner, SETTINGS).duration


@pytest.fixture(scope="module")
def alone():
    """Durations by one engine: a spawned process would take the compiled one only where its cache is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STUDY_ENGINE", "numpy")
        yield from _alone()


def _alone():
    yield [duration(planner) for planner in PLANNERS]


def test_threads_with_a_deadline_find_what_one_finds_alone(alone):
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(duration, PLANNERS)) == alone


def test_a_running_loop_goes_on_while_threads_plan(alone):
    ticks = 0

    async def ticking():
        nonlocal ticks
        while True:
            ticks += 1
            await asyncio.sleep(0.001)

    async def planned():
        clock = asyncio.create_task(ticking())
        durations = await asyncio.wait_for(
            asyncio.gather(*(asyncio.to_thread(duration, name) for name in PLANNERS)), 100
        )
        clock.cancel()
        return durations

    assert asyncio.run(planned()) == alone
    assert ticks > 2


def test_planning_inside_a_running_loop_as_in_a_notebook(alone):
    async def cell():
        return [duration(planner) for planner in PLANNERS]

    assert asyncio.run(cell()) == alone


def test_spawned_processes_find_the_same(alone):
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert list(pool.map(duration, PLANNERS)) == alone


def test_a_deadline_holds_in_a_thread_too():
    points = np.cumsum(np.random.default_rng(0).uniform(-1, 1, (40, 6)), axis=0)
    problem = Problem("long", points, JointLimits(np.ones(6), np.ones(6), np.full(6, 10.0)))
    settings = RunSettings("cubic-spline-smooth", formulation="scaled", time_limit=0.01)
    with ThreadPoolExecutor(1) as pool:
        planned = pool.submit(plan, problem, "free-path-nlp", settings).result(timeout=100)
    assert planned.feasible or planned.reason
    assert planned.result.message
