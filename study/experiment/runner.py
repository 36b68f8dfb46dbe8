"""Run cells, judge what comes back, and keep every result the moment it is there."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from itertools import islice

from study.errors import StudyError
from study.experiment.cases import Case
from study.experiment.execution import Task, execute, failed
from study.experiment.pool import Overdue, WorkerDied, WorkerPool
from study.experiment.results import Cell, Result
from study.experiment.store import Store
from study.planning import Status

__all__ = ["Task", "default_jobs", "execute", "hard_limit", "run_cells"]

WINDOW = 1000
"""Cells handed to the executor ahead of time; bounds the memory of a sweep of millions."""


def hard_limit(task: Task) -> float:
    """Seconds after which a task's worker is killed: the solver's own limit and time to notice it."""
    return 1.25 * task.cell.settings.time_limit + 2.0


def default_jobs() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_cells(
    cells: Iterable[Cell],
    cases: Mapping[str, Case],
    store: Store,
    *,
    executor: Executor | None = None,
    jobs: int | None = None,
    on_result: Callable[[Result], None] = lambda result: None,
) -> None:
    """Run the cells that the store does not have yet.

    Parameters
    ----------
    cells : iterable of Cell
    cases : mapping of str to Case
    store : Store
        Written only here, in the calling process, as each cell finishes.
    executor : concurrent.futures.Executor, optional
        Where to run; a pool of processes of its own by default. Only that pool can stop an overdue cell.
    jobs : int, optional
        Size of that pool; all processors by default.
    on_result : callable, optional
        Told of every result once it is stored.

    Raises
    ------
    StudyError
        If the store cannot be written or the executor gives up.
    """
    missing = store.missing(cells)
    if not missing:
        return
    jobs = default_jobs() if jobs is None else jobs
    if jobs < 1:
        raise StudyError(f"the number of jobs must be at least 1, got {jobs}")
    own = WorkerPool(min(jobs, len(missing)), hard_limit) if executor is None else None
    try:
        for results in _finished([Task(cell, cases[cell.case].problem) for cell in missing], own or executor):
            store.add(*results)
            for result in results:
                on_result(result)
    finally:
        if own is not None:
            own.shutdown(cancel_futures=True)


def _finished(tasks: Sequence[Task], executor: Executor | None) -> Iterator[list[Result]]:
    """Hand tasks out and give results back in the order in which they finish."""
    if executor is None:
        return
    waiting, running = iter(tasks), dict[Future[Result], Task]()
    while True:
        for task in islice(waiting, WINDOW - len(running)):
            running[executor.submit(execute, task)] = task
        if not running:
            return
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        yield [_outcome(future, running.pop(future)) for future in done]


def _outcome(future: Future[Result], task: Task) -> Result:
    try:
        return future.result()
    except Overdue:
        limit = task.cell.settings.time_limit
        return failed(task.cell, f"stopped at the time limit of {limit:g} s", limit, Status.TIMED_OUT)
    except WorkerDied as error:
        return failed(task.cell, f"{error} during this cell", 0.0)
    except BrokenExecutor as error:
        raise StudyError(f"the executor gave up ({error}); finished cells are stored: run again to go on") from error
    except Exception as error:  # the answer could not travel, for instance
        return failed(task.cell, f"{type(error).__name__}: {error}", 0.0)
