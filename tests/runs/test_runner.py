import os
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

from study.analysis.case_summary import summarise_case
from study.analysis.methods import Kind, Standing
from study.errors import StudyError
from study.planning import Status
from study.problem import Timing
from study.runs.execute import CellJob, cell_jobs, stored_results
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.pool import Overdue, WorkerDied, WorkerPool
from study.runs.runner import hard_limit, run_jobs
from study.store.results import Cell
from study.store.store import Store
from tests.conftest import stored, wait_until


@pytest.fixture
def run(tmp_path, stubs):
    """Run planners on a case in a new store; give the results and the store's digest."""

    def run_on(case, planners, seeds=3, name="r", time_limit=60.0, **options):
        cells = make_cells([case], parse_specs(planners), Budget(seeds, 60, time_limit))
        with Store(tmp_path / f"{name}.sqlite") as store:
            run_jobs(cell_jobs(cells, {case.name: case}), store, **options)
            return stored_results(store, cells, {case.name: case}), store.digest()

    return run_on


def test_a_bound_runs_like_a_planner_and_is_kept_as_what_it_is(run, tiny_case):
    (result,), _ = run(tiny_case, "stub-half", workers=1)
    assert (result.status, result.lower_bound, result.motion, result.verdict) == (Status.FINISHED, 0.5, None, None)
    assert (result.message, result.details) == ("half a second at least", {"halves": 1.0})
    (again,), _ = run(tiny_case, "stub-half", workers=1)
    assert again.lower_bound == 0.5
    method = next(m for m in summarise_case(tiny_case, [result]).methods if m.label == "stub-half")
    assert (method.kind, method.standing, method.bound) == (Kind.BOUND, Standing.BOUND, 0.5)


def test_every_motion_is_judged_and_timed(run, tiny_case):
    results, _ = run(tiny_case, "stub-steady,stub-seeded,pso:scaled,shared", workers=1)
    assert len(results) == 7
    for result in results:
        assert result.status is Status.FINISHED
        assert result.verdict is not None
        assert result.verdict.feasible
        assert result.verdict.duration == result.motion.duration
        assert 0 < result.wall_time < 5


@pytest.mark.slow
def test_results_are_the_same_whatever_the_executor_and_the_number_of_workers(run, tiny_case):
    planners = "stub-steady,stub-seeded,pso,golds-pso:scaled,shared,ruckig-stops"
    with ThreadPoolExecutor(2) as threads, ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        digests = [
            run(tiny_case, planners, name="one", workers=1)[1],
            run(tiny_case, planners, name="three", workers=3)[1],
            run(tiny_case, planners, name="threads", executor=threads)[1],
            run(tiny_case, planners, name="processes", executor=processes)[1],
        ]
    assert len(set(digests)) == 1


@pytest.mark.slow
def test_failures_become_results_with_their_reason(run, tiny_case):
    planners = "stub-crash,stub-exit,stub-raise,stub-refuse,stub-odd,stub-unsendable,stub-steady"
    results, digest = run(tiny_case, planners, seeds=1, workers=2)
    reasons = {result.cell.planner: result.message for result in results if result.status is Status.FAILED}
    assert reasons == {
        "stub-crash": "the worker process was ended by SIGSEGV during this cell",
        "stub-exit": "the worker process ended with exit code 5 during this cell",
        "stub-raise": "KeyError: <object object>",  # without its address in memory, which no two runs share
        "stub-refuse": "this problem is not for me",
        "stub-odd": "a motion must be one of Trajectory, ParametricTrajectory, the planner returned a str",
        "stub-unsendable": reasons["stub-unsendable"],
    }
    assert "cannot be sent between processes" in reasons["stub-unsendable"]
    assert [r.status for r in results if r.cell.planner == "stub-steady"] == [Status.FINISHED]
    assert run(tiny_case, planners, seeds=1, workers=1, name="again")[1] == digest


def test_an_overdue_cell_is_interrupted_and_the_rest_goes_on(run, tiny_case):
    started = time.monotonic()
    results, _ = run(tiny_case, "stub-hang,stub-seeded", seeds=1, time_limit=0.5, workers=1)
    assert time.monotonic() - started < 30
    hung, fine = results
    assert (hung.status, hung.message) == (Status.TIMED_OUT, "stopped at the time limit of 0.5 s")
    assert fine.status is Status.FINISHED


def test_only_what_is_missing_is_run(tmp_path, stubs, tiny_case):
    cases = {"tiny": tiny_case}
    some = make_cells([tiny_case], parse_specs("stub-seeded"), Budget(2))
    more = make_cells([tiny_case], parse_specs("stub-seeded,stub-steady"), Budget(4))
    told = []
    with Store(tmp_path / "r.sqlite") as store, ThreadPoolExecutor(1) as executor:
        for cells in (some, more, more):
            run_jobs(
                cell_jobs(cells, cases), store, executor=executor, on_outcome=lambda job, result: told.append(job.cell)
            )
    assert sorted(told, key=str) == sorted(more, key=str)
    assert told[:2] == some


def test_a_broken_executor_is_one_sentence_and_what_was_stored_stays(tmp_path, stubs, tiny_case):
    class Breaking(Executor):
        calls = 0

        def submit(self, fn, /, *args, **kwargs):
            future = Future()
            self.calls += 1
            if self.calls > 1:
                future.set_exception(BrokenExecutor("gone"))
            else:
                future.set_result(fn(*args, **kwargs))
            return future

    cases = {"tiny": tiny_case}
    cells = make_cells([tiny_case], parse_specs("stub-seeded"), Budget(1))
    with Store(tmp_path / "r.sqlite") as store:
        executor = Breaking()
        run_jobs(cell_jobs(cells, cases), store, executor=executor)
        with pytest.raises(
            StudyError, match=r"the executor gave up \(BrokenExecutor: gone\); finished jobs are stored"
        ):
            run_jobs(
                cell_jobs(make_cells([tiny_case], parse_specs("stub-seeded"), Budget(3)), cases),
                store,
                executor=executor,
            )
        assert store.missing(cell_jobs(cells, cases)) == []


def test_impossible_numbers_of_jobs_are_refused(run, tiny_case):
    with pytest.raises(StudyError, match="jobs must be at least 1, got 0"):
        run(tiny_case, "stub-steady", workers=0)


def test_wall_time_is_the_planners_alone(stubs, tiny_case):
    cell = make_cells([tiny_case], parse_specs("stub-slow"), Budget(1))[0]
    assert 0.15 <= CellJob(cell, tiny_case.problem).run().wall_time < 1.0


def test_the_hard_limit_leaves_a_solver_time_to_stop_by_itself(stubs, tiny_case):
    job = CellJob(make_cells([tiny_case], parse_specs("stub-slow"), Budget(1, 10, 8.0))[0], tiny_case.problem)
    assert hard_limit(job) == 12.0


def environment_of_worker():
    return {name: os.environ.get(name) for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}


def test_workers_compute_on_one_thread_and_the_parent_keeps_its_own_setting(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    with WorkerPool(1) as pool:
        assert pool.submit(environment_of_worker).result() == {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    assert environment_of_worker() == {"OMP_NUM_THREADS": "7", "OPENBLAS_NUM_THREADS": None}


def test_a_dead_or_overdue_worker_costs_one_task():
    with WorkerPool(1, limit=lambda *args: 1.0) as pool:
        futures = [pool.submit(os._exit, 3), pool.submit(time.sleep, 60), pool.submit(abs, -2), pool.submit(int, "x")]
        assert futures[2].result() == 2
    assert [type(future.exception()) for future in futures] == [WorkerDied, Overdue, type(None), ValueError]


def nap(seconds):
    time.sleep(seconds)
    return os.getpid()


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks at /proc")
def test_a_worker_killed_from_outside_costs_nothing():
    with WorkerPool(1) as pool:
        first = pool.submit(os.getpid).result()
        future = pool.submit(nap, 0.6)
        time.sleep(0.3)
        os.kill(first, signal.SIGKILL)
        assert future.result() != first


def test_closing_at_once_ends_what_runs():
    pool = WorkerPool(1)
    running, waiting = pool.submit(time.sleep, 60), pool.submit(time.sleep, 60)
    time.sleep(0.2)
    started = time.monotonic()
    pool.shutdown(cancel_futures=True)
    assert time.monotonic() - started < 10
    assert isinstance(running.exception(), WorkerDied)
    assert waiting.cancelled()


KILL_SCRIPT = """
import sys
from pathlib import Path
from study.cases.library import load_case
from study.runs.execute import cell_jobs
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.runner import run_jobs
from study.store.store import Store
from tests.helpers.jobs import every_kind

if __name__ == "__main__":
    path, case, workers = Path(sys.argv[1]), load_case(sys.argv[2]), int(sys.argv[3])
    cells = make_cells([case], parse_specs("stub-slow,pso:scaled,shared"), Budget(4, 60))
    cells += make_cells([case], parse_specs("stub-crash,stub-steady"), Budget(1, 60))
    jobs = every_kind(cell_jobs(cells, {case.name: case}))
    with Store(path) as store:
        run_jobs(jobs, store, workers=workers)
        print(len(store.outcomes(jobs)), store.digest())
"""


@pytest.fixture
def script(tmp_path, stubs, case_file):
    path = tmp_path / "script.py"
    path.write_text(KILL_SCRIPT)
    return lambda store, jobs: [sys.executable, str(path), str(tmp_path / store), str(case_file), str(jobs)]


def children_of(pid: int) -> list[int]:
    return [int(p) for p in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


@pytest.mark.slow
@pytest.mark.timeout(400)
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks at /proc")
def test_kill_9_loses_only_jobs_in_flight_and_the_next_run_ends_the_same(tmp_path, script):
    whole = subprocess.run(script("whole.sqlite", 1), capture_output=True, text=True, check=True, timeout=200).stdout
    path = tmp_path / "killed.sqlite"
    process = subprocess.Popen(script("killed.sqlite", 2), stdout=subprocess.DEVNULL)
    wait_until(lambda: stored(path) >= 2)
    workers = children_of(process.pid)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    kept = stored(path)
    assert 2 <= kept < 16
    wait_until(lambda: not any(alive(pid) for pid in workers))  # nobody is left behind
    resumed = subprocess.run(script("killed.sqlite", 2), capture_output=True, text=True, check=True, timeout=200).stdout
    print(
        f"\nruns killed: 1 after {kept} of 16 jobs, workers left behind: 0, jobs lost: {16 - int(resumed.split()[0])}"
    )
    assert resumed == whole
    assert whole.startswith("16 ")


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_demand_that_a_planner_does_not_know_keeps_it_from_running(stubs, tiny_case):
    limits = replace(tiny_case.problem.limits, min_velocity=np.array([-0.5, -0.8]))
    problem = replace(tiny_case.problem, limits=limits)
    cell = make_cells([tiny_case], parse_specs("stub-hang"), Budget(1, 60))[0]
    result = CellJob(cell, problem).run()
    assert (result.status, result.motion) == (Status.NOT_APPLICABLE, None)
    assert result.message == "the planner does not know limits that differ by direction, which the problem asks for"


@pytest.mark.parametrize(
    ("timing", "duration"), [({"exactly": 9.0}, 9.0), ({"at_least": 7.5}, 7.5), ({"cycle": 4.0}, 8.0)]
)
def test_any_planner_fits_a_demanded_duration_by_slowing_down(tiny_case, timing, duration):
    problem = replace(tiny_case.problem, timing=Timing(**timing))
    fastest = CellJob(Cell("tiny", "centre", "centre", tiny_case.settings), tiny_case.problem).run().verdict.duration
    result = CellJob(Cell("tiny", "centre", "centre", tiny_case.settings), problem).run()
    assert fastest < duration
    assert result.verdict.duration == pytest.approx(duration)
    assert not [reason for reason in result.verdict.reasons if "lasts" in reason]


def test_a_demanded_duration_that_is_too_short_is_the_reason(tiny_case):
    problem = replace(tiny_case.problem, timing=Timing(exactly=0.01))
    result = CellJob(Cell("tiny", "centre", "centre", tiny_case.settings), problem).run()
    assert result.motion is None
    assert "longer than the 0.01 s it must take" in result.message
