import os
import signal
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from study.errors import StudyError
from study.planning import Status
from study.runs import dask as engines
from study.runs.dask import dask_executor
from study.runs.execute import CellJob, cell_jobs, stored_results
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.pool import MEMORY
from study.runs.runner import RunOptions, run_guarded, run_jobs
from study.store.store import Store
from tests.helpers.jobs import every_kind

distributed = pytest.importorskip("distributed", reason="Dask is an extra")
psutil = pytest.importorskip("psutil", reason="comes with Dask")
PLANNERS = "stub-steady,stub-seeded,stub-crash,stub-slow,pso:scaled,shared"


@pytest.fixture
def run(tmp_path, stubs, tiny_case):
    """Run planners in a new store; give the results and the store's digest."""

    def run_on(name, planners=PLANNERS, seeds=2, time_limit=60.0, **options):
        cells = make_cells([tiny_case], parse_specs(planners), Budget(seeds, 60, time_limit))
        with Store(tmp_path / f"{name}.sqlite") as store:
            run_jobs(cell_jobs(cells, {"tiny": tiny_case}), store, **options)
            return stored_results(store, cells, {"tiny": tiny_case}), store.digest()

    return run_on


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # of Dask's own making
@pytest.mark.timeout(200)
def test_a_real_scheduler_that_loses_a_worker_brings_the_same_results(run, tmp_path):
    _, here = run("here", workers=2)
    stored = []
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        memory_limit=0,
        silence_logs="CRITICAL",
    ) as cluster:
        pids = [nanny.pid for nanny in cluster.workers.values()]

        def kill_one(job, result):
            stored.append(result)
            if len(stored) == 3:
                os.kill(pids[0], signal.SIGKILL)

        with dask_executor(cluster.scheduler_address, 2) as executor:
            results, there = run("there", executor=executor, on_outcome=kill_one)
        assert pids[0] not in [nanny.pid for nanny in cluster.workers.values()]
    print(f"\nDask workers killed: 1 after 3 of {len(stored)} cells, cells lost: {9 - len(results)}")
    assert len(stored) == len(results) == 9
    assert there == here


@pytest.mark.filterwarnings("default")
@pytest.mark.timeout(200)
def test_a_scheduler_of_our_own_runs_every_kind_of_job_and_listens_on_this_machine_alone(run, tmp_path):
    with dask_executor("local", 1) as executor:
        processes = [psutil.Process(), *psutil.Process().children(recursive=True)]
        listening = [c.laddr.ip for p in processes for c in p.net_connections() if c.status == psutil.CONN_LISTEN]
        results, _ = run("r", "stub-seeded", executor=executor)
        others = every_kind([])
        with Store(tmp_path / "others") as store:
            run_jobs(others, store, executor=executor)
            assert store.missing(others) == []
    assert len(results) == 2
    assert listening
    assert set(listening) <= {"127.0.0.1", "::1"}


def test_every_kind_of_job_runs_alike_on_any_engine(tmp_path, tiny_case, stubs):
    jobs = every_kind(cell_jobs(make_cells([tiny_case], parse_specs("stub-seeded"), Budget(2)), {"tiny": tiny_case}))
    digests = []
    for name in ("here", "there"):
        with Store(tmp_path / name) as store, ThreadPoolExecutor(1) as threads:
            run_jobs(jobs, store, workers=1, executor=threads if name == "there" else None)
            assert store.missing(jobs) == []
            digests.append(store.digest())
    assert digests[0] == digests[1]


def test_workers_with_other_code_are_refused(tiny_case, stubs):
    job = CellJob(make_cells([tiny_case], parse_specs("stub-steady"), Budget(1))[0], tiny_case.problem)
    with pytest.raises(StudyError, match=r"a worker on .* has other code for stub-steady; install the same"):
        run_guarded(job, "code of another day")
    assert run_guarded(job, job.code()).status is Status.FINISHED


def test_workers_that_would_take_other_kernels_are_refused(monkeypatch):
    monkeypatch.setattr(engines, "chosen", lambda: "numpy")
    engines._check_kernels({"tcp://127.0.0.1:1": "numpy"})
    with pytest.raises(
        StudyError, match=r"the Dask worker tcp://127.* takes the kernels of numba and this machine those"
    ):
        engines._check_kernels({"tcp://127.0.0.1:1": "numba"})


@pytest.mark.filterwarnings("default")
def test_nobody_at_the_address_is_one_sentence(monkeypatch):
    monkeypatch.setattr(engines, "PATIENCE", 1)
    for address in ("tcp://127.0.0.1:9", "no address"):
        with pytest.raises(StudyError, match=r"no Dask workers at .*; start a scheduler"), dask_executor(address, 1):
            pass


def test_dask_that_is_not_installed_is_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(StudyError, match=r"--dask needs Dask, which is not installed"), dask_executor("local", 1):
        pass


def test_any_executor_interrupts_hanging_cells_and_survives_crashing_ones(run):
    with ThreadPoolExecutor(1) as executor:
        results, there = run("there", "stub-hang,stub-crash,stub-seeded", 1, 0.1, executor=executor)
    assert [result.status for result in results] == [Status.TIMED_OUT, Status.FAILED, Status.FINISHED]
    assert [result.message for result in results][:2] == [
        "stopped at the time limit of 0.1 s",
        "the worker process was ended by SIGSEGV during this cell",
    ]
    assert run("here", "stub-hang,stub-crash,stub-seeded", 1, 0.1, workers=1)[1] == there
    print(f"\ncells that hung: 1, that crashed: 1, on two engines; cells lost: {3 - len(results)}")


@pytest.mark.skipif(not MEMORY, reason="memory is limited on Linux only")
def test_memory_is_limited_in_every_engine_and_the_rest_goes_on(run):
    options = RunOptions(memory=500 * 10**6)
    results, here = run("here", "stub-greedy,stub-seeded", 1, workers=1, options=options)
    greedy, fine = results
    assert (greedy.status, greedy.message) == (Status.FAILED, "memory ran out")
    assert fine.status is Status.FINISHED
    with ThreadPoolExecutor(1) as executor:
        assert run("there", "stub-greedy,stub-seeded", 1, executor=executor, options=options)[1] == here


def test_fresh_runs_stored_cells_again_and_replaces_them(run, tiny_case, tmp_path):
    _, before = run("r", "stub-steady,stub-seeded", workers=1)
    told = []
    results, after = run(
        "r",
        "stub-steady,stub-seeded",
        workers=1,
        options=RunOptions(fresh=True),
        on_outcome=lambda job, result: told.append(result),
    )
    assert after == before
    assert len(told) == len(results) == 3
    assert sorted(result.wall_time for result in results) == sorted(result.wall_time for result in told)
