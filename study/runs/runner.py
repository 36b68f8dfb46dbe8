"""Run cells, judge what comes back, and keep every result the moment it is there."""

from __future__ import annotations

import os
import queue
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice

from study.cases.library import Case
from study.errors import StudyError
from study.planning import Status
from study.runs.execute import Task, execute, failed
from study.runs.pool import Overdue, WorkerDied, WorkerPool, call_guarded
from study.runs.progress import Progress
from study.store.results import Cell, Result
from study.store.store import Store

__all__ = ["RunOptions", "Task", "default_jobs", "execute", "hard_limit", "run_cells", "run_guarded"]

WINDOW = 1000
"""Cells handed to the executor ahead of time; bounds the memory of a sweep of millions."""

_Arrivals = queue.SimpleQueue[Future[Result] | tuple[Cell, Progress]]
_Submit = Callable[[Task], Future[Result]]
_Take = Callable[[Task, Callable[[], Result]], Result]


@dataclass(frozen=True)
class RunOptions:
    """How cells are run, none of which is part of a cell.

    Attributes
    ----------
    fresh : bool
        Whether cells that are stored are run again, each replacing the stored one as it finishes.
    memory : int, bytes, optional
        What a worker may take beyond its code and libraries.
    on_progress : callable (cell, progress), optional
        Told a few times a second where every running search stands; not on somebody else's executor.
    """

    fresh: bool = False
    memory: int | None = None
    on_progress: Callable[[Cell, Progress], None] | None = None


USUAL = RunOptions()


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
    options: RunOptions = USUAL,
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
        Where to run; a pool of processes of its own by default. Whoever works for another one runs every cell in a process
        beside its own, so that time limits, memory limits and crashes mean the same everywhere.
    jobs : int, optional
        Size of that pool; all processors by default.
    options : RunOptions
    on_result : callable, optional
        Told of every result once it is stored.

    Raises
    ------
    StudyError
        If the store cannot be written or the executor gives up.
    """
    cells = list(cells)
    chosen = cells if options.fresh else store.missing(cells)
    if not chosen:
        return
    jobs = default_jobs() if jobs is None else jobs
    if jobs < 1:
        raise StudyError(f"the number of jobs must be at least 1, got {jobs}")
    tasks = [Task(cell, cases[cell.case].problem) for cell in chosen]
    arrivals: _Arrivals = queue.SimpleQueue()
    with _submitting(executor, min(jobs, len(tasks)), options, arrivals) as (submit, take):
        for results in _finished(tasks, submit, take, arrivals, options):
            store.add(*results, replace=options.fresh)
            for result in results:
                on_result(result)


@contextmanager
def _submitting(
    executor: Executor | None, jobs: int, options: RunOptions, arrivals: _Arrivals
) -> Iterator[tuple[_Submit, _Take]]:
    """How to hand a task over and take its answer: someone else's executor, or a pool that ends with the block."""
    if executor is not None:
        yield lambda task: executor.submit(run_guarded, task, options.memory), _answered
        return
    hear = None if options.on_progress is None else lambda said, task: arrivals.put((task.cell, said))
    pool = WorkerPool(jobs, hard_limit, options.memory, hear)
    try:
        yield lambda task: pool.submit(execute, task), _recorded
    finally:
        pool.shutdown(cancel_futures=True)


def _finished(
    tasks: Sequence[Task], submit: _Submit, take: _Take, arrivals: _Arrivals, options: RunOptions
) -> Iterator[list[Result]]:
    """Hand tasks out and give results back in the order in which they finish, as many at a time as are there."""
    waiting = iter(tasks)
    running: dict[Future[Result], Task] = {}
    while True:
        for task in islice(waiting, WINDOW - len(running)):
            future = submit(task)
            running[future] = task
            future.add_done_callback(arrivals.put)
        if not running:
            return
        results, lost = [], None
        for arrival in [arrivals.get(), *(arrivals.get_nowait() for _ in range(arrivals.qsize()))]:
            if isinstance(arrival, tuple):
                if options.on_progress is not None:
                    options.on_progress(*arrival)
                continue
            try:
                results.append(take(running.pop(arrival), arrival.result))
            except StudyError as error:
                lost = error
        yield results
        if lost is not None:
            raise lost


def _answered(task: Task, answer: Callable[[], Result]) -> Result:
    """Take an executor's answer; where there is none, that says nothing about the cell."""
    try:
        return answer()
    except (Exception, CancelledError) as error:  # whatever it raises when it loses its workers
        reason = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        raise StudyError(f"the executor gave up ({reason}); finished cells are stored: run again to go on") from error


def run_guarded(task: Task, memory: int | None = None) -> Result:
    """Run one cell in a process beside this one; what happens to it there becomes the result."""
    limit = hard_limit(task)
    return _recorded(task, lambda: call_guarded(execute, limit, memory, task))


def _recorded(task: Task, answer: Callable[[], Result]) -> Result:
    """Take an answer, or make a record of what came in its place."""
    try:
        return answer()
    except Overdue:
        limit = task.cell.settings.time_limit
        return failed(task.cell, f"stopped at the time limit of {limit:g} s", limit, Status.TIMED_OUT)
    except WorkerDied as error:
        return failed(task.cell, f"{error} during this cell", 0.0)
    except Exception as error:  # the answer could not travel, for instance
        return failed(task.cell, f"{type(error).__name__}: {error}", 0.0)
