"""Native solvers fed with hostile problems: every cell ends in time, with a record, and the pool lives on."""

import time

import numpy as np
import pytest

from study.planning import Status
from study.problem import EndCondition, JointLimits, Problem
from study.runs.execute import CellJob, cell_jobs, stored_results
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.runner import hard_limit, run_jobs
from study.store.maintenance import verify
from study.store.store import Store
from tests.conftest import case_of

LIMIT = 2.0


def problem(name, waypoints, velocity, acceleration, jerk=np.inf):
    limits = (
        np.broadcast_to(np.asarray(rate, dtype=float), waypoints.shape[1]).copy()
        for rate in (velocity, acceleration, jerk)
    )
    return Problem(name, waypoints, JointLimits(*limits), EndCondition.SMOOTH, (1e-9, 1e6))


def walk(n, joints):
    return np.cumsum(np.random.default_rng(3).uniform(-1, 1, (n, joints)), axis=0)


def tiny_steps():
    points = walk(6, 3)
    points[2], points[4] = points[1] + 1e-12, points[3] - 1e-9
    return points


HOSTILE = {
    "ratios": problem("ratios", walk(5, 4), [1e-9, 1.0, 1e9, 1e3], [1e9, 1e-9, 1.0, 1e-3], [1.0, 1e12, 1e-6, 1e3]),
    "steps": problem("steps", tiny_steps(), 1.0, 2.0, 30.0),
    "singular": problem("singular", np.repeat(walk(5, 1), 4, axis=1) * (1 + 1e-15 * np.arange(4)), 1.0, 2.0, 1e-9),
    "huge": problem("huge", 1e12 * walk(4, 2), 1e-3, 1e-6, 1e-9),
    "long": problem("long", walk(150, 7), 1.0, 2.0, 30.0),
}
PLANNERS = "casadi-nlp,ruckig-stops,ruckig-via,toppra,topp3-nlp,free-path-nlp,quintic-nlp,bspline-nlp,certified"
FAST = ("ratios",)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[] if n in FAST else [pytest.mark.slow]) for n in HOSTILE])
@pytest.mark.timeout(300)
def test_hostile_problems_end_in_time_with_a_record_and_the_pool_lives_on(tmp_path, stubs, name):
    curve = "poly353" if HOSTILE[name].n_waypoints == 4 else "cubic-spline-smooth"
    case = case_of(HOSTILE[name], curve)
    cells = make_cells([case], parse_specs(f"{PLANNERS},stub-crash,stub-steady"), Budget(1, 50, LIMIT))
    begun = time.monotonic()
    with Store(tmp_path / "r") as store:
        run_jobs(cell_jobs(cells, {case.name: case}), store, workers=1)
        results = stored_results(store, cells, {case.name: case})
    spent = time.monotonic() - begun
    print(f"\n{name}: {spent:.1f} s", {result.cell.planner: result.status.name for result in results})
    assert [result.cell for result in results] == cells
    # Crashed workers are tried twice and every new one has imports to do.
    assert spent < sum(hard_limit(CellJob(cell, case.problem)) for cell in cells) + 60
    for result in results:
        if result.status is not Status.FINISHED:
            assert result.message, result.cell
        if result.verdict is not None and not result.verdict.feasible:
            assert result.verdict.reasons, result.cell
    assert verify(tmp_path / "r") == (len(cells), [])
