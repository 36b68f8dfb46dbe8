"""Run jobs of any kind, and keep every outcome the moment it is there."""

from __future__ import annotations

import os
import platform
import queue
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from typing import Any, TypeVar

from study.errors import StudyError, unforeseen
from study.planning import Status
from study.runs.job import Job
from study.runs.pool import Overdue, WorkerDied, WorkerPool, call_guarded
from study.runs.progress import Progress
from study.store.store import Store

T = TypeVar("T")
Done = list[tuple[Job[Any], Any]]

WINDOW = 1000
"""Jobs handed to the executor ahead of time; bounds the memory of a sweep of millions."""

_Arrivals = queue.SimpleQueue[Future[Any] | tuple[Job[Any], Progress]]
_Submit = Callable[[Job[Any]], Future[Any]]
_Take = Callable[[Job[Any], Callable[[], Any]], Any]


@dataclass(frozen=True)
class RunOptions:
    """Options for running jobs, none of which is part of a job.

    Attributes
    ----------
    fresh : bool
        Whether stored jobs are run again, each outcome replacing the stored one as it comes.
    memory : int, bytes, optional
        Limit of a worker beyond its code and libraries.
    on_progress : callable (job, progress), optional
        Told a few times a second where every running search stands; not on somebody else's executor.
    """

    fresh: bool = False
    memory: int | None = None
    on_progress: Callable[[Job[Any], Progress], None] | None = None


USUAL = RunOptions()


def hard_limit(job: Job[Any]) -> float:
    """Seconds after which a job's worker is killed: the work's own limit and time to notice it."""
    return 1.25 * job.time_limit + 2.0


def default_jobs() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_jobs(
    jobs: Iterable[Job[Any]],
    store: Store,
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    options: RunOptions = USUAL,
    on_outcome: Callable[[Job[Any], Any], None] = lambda job, outcome: None,
) -> None:
    """Run the jobs that the store does not have yet, equal ones once.

    Parameters
    ----------
    jobs : iterable of Job
    store : Store
        Written only here, in the calling process, as each job finishes.
    executor : concurrent.futures.Executor, optional
        Where to run; a pool of processes of its own by default. Whoever works for another one runs every job in a process
        beside its own, so that time limits, memory limits and crashes mean the same everywhere.
    workers : int, optional
        Size of that pool; all processors by default.
    options : RunOptions
    on_outcome : callable (job, outcome), optional
        Told of every outcome once it is stored.

    Raises
    ------
    StudyError
        If the store cannot be written, the executor gives up, or a job fails whose failure is not worth keeping.
    """
    chosen = list(jobs) if options.fresh else store.missing(jobs)
    if not chosen:
        return
    workers = default_jobs() if workers is None else workers
    if workers < 1:
        raise StudyError(f"the number of jobs must be at least 1, got {workers}")
    arrivals: _Arrivals = queue.SimpleQueue()
    with _submitting(executor, min(workers, len(chosen)), options, arrivals) as (submit, take):
        for done in _finished(chosen, submit, take, arrivals, options):
            store.add(*done, replace=options.fresh)
            for job, outcome in done:
                on_outcome(job, outcome)


@contextmanager
def _submitting(
    executor: Executor | None, workers: int, options: RunOptions, arrivals: _Arrivals
) -> Iterator[tuple[_Submit, _Take]]:
    """Offer a way to hand a job over and to take its outcome: someone else's executor, or a pool of our own."""
    if executor is not None:
        yield lambda job: executor.submit(run_guarded, job, job.code(), options.memory), _answered
        return
    hear = None if options.on_progress is None else lambda said, job: arrivals.put((job, said))
    pool = WorkerPool(workers, hard_limit, options.memory, hear)
    try:
        yield lambda job: pool.submit(run, job), _recorded
    finally:
        pool.shutdown(cancel_futures=True)


def run(job: Job[T]) -> T:
    """Do the work of a job, in a worker."""
    return job.run()


def _finished(
    jobs: Sequence[Job[Any]], submit: _Submit, take: _Take, arrivals: _Arrivals, options: RunOptions
) -> Iterator[Done]:
    """Hand jobs out and give outcomes back in the order in which they finish, as many at a time as are there."""
    waiting = iter(jobs)
    running: dict[Future[Any], Job[Any]] = {}
    while True:
        for job in islice(waiting, WINDOW - len(running)):
            future = submit(job)
            running[future] = job
            future.add_done_callback(arrivals.put)
        if not running:
            return
        done: Done = []
        lost = None
        for arrival in [arrivals.get(), *(arrivals.get_nowait() for _ in range(arrivals.qsize()))]:
            if isinstance(arrival, tuple):
                if options.on_progress is not None:
                    options.on_progress(*arrival)
                continue
            job = running.pop(arrival)
            try:
                done.append((job, take(job, arrival.result)))
            except StudyError as error:
                lost = error
        yield done
        if lost is not None:
            raise lost


def _answered(job: Job[T], answer: Callable[[], T]) -> T:
    """Take an executor's answer; where there is none, that says nothing about the job."""
    try:
        return answer()
    except StudyError:
        raise
    except (Exception, CancelledError) as error:  # whatever it raises when it loses its workers
        reason = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        raise StudyError(f"the executor gave up ({reason}); finished jobs are stored: run again to go on") from error


def run_guarded(job: Job[T], code: str, memory: int | None = None) -> T:
    """Run a job in a process beside this one; an end by force becomes the outcome.

    Parameters
    ----------
    job : Job
    code : str
        Code behind the job where it was handed out.
    memory : int, bytes, optional

    Raises
    ------
    StudyError
        If this machine has other code, whose outcome would be kept under a wrong name.
    """
    if job.code() != code:
        raise StudyError(
            f"a worker on {platform.node()} has other code for {job.label}; install the same version there"
        )
    return _recorded(job, lambda: call_guarded(run, hard_limit(job), memory, job))


def _recorded(job: Job[T], answer: Callable[[], T]) -> T:
    """Take an answer, or make a record of what came in its place."""
    try:
        return answer()
    except Overdue:
        limit = job.time_limit
        return job.failed(f"stopped at the time limit of {limit:g} s", limit, Status.TIMED_OUT)
    except WorkerDied as error:
        return job.failed(f"{error} during this {job.kind}", 0.0, Status.FAILED)
    except StudyError as error:
        return job.failed(str(error), 0.0, Status.FAILED)
    except MemoryError:
        return job.failed("memory ran out", 0.0, Status.FAILED)
    except Exception as error:  # the answer could not travel, for instance
        return job.failed(unforeseen(error), 0.0, Status.FAILED)
