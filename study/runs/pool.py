"""A pool of worker processes that survives what native solvers do: crash, hang, or ignore a time limit.

`concurrent.futures.ProcessPoolExecutor` gives every task up when one worker dies and cannot stop a task that runs. Here
each worker has its own pipe and its own watching thread, so a dead or overdue worker costs one task and is replaced. A
task whose worker died is tried once more, so that a worker killed from outside costs nothing.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from study.supervisor import supervised

MEMORY = Path("/proc/self/statm").exists()
"""True if this system can limit the memory of a worker."""

GUARD = 'put what your script runs under `if __name__ == "__main__":`, as workers import it'
"""Remedy where a worker cannot start."""

P = ParamSpec("P")
T = TypeVar("T")
_THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
_Task = tuple[Future[Any], Callable[..., Any], tuple[Any, ...], dict[str, Any]]
_spawn = multiprocessing.get_context("spawn")
_starting = threading.Lock()


class WorkerDied(Exception):
    """A worker process ended in the middle of a task."""


class Overdue(Exception):
    """A task was stopped at its time limit."""


class WorkerPool(Executor):
    """Run tasks in separate processes, one thread of computation each.

    Parameters
    ----------
    jobs : int
        Number of worker processes.
    limit : callable (*args, **kwargs) -> float, s, optional
        Wall time after which a task with these arguments is stopped by killing its worker.
    memory : int, bytes, optional
        What a worker may take beyond what it has when its first task arrives; see `MEMORY`.
    hear : callable (said, *args, **kwargs), optional
        Told what a worker says in the middle of a task with these arguments; from a thread of the pool's.

    Raises
    ------
    SystemExit
        In a worker that imports the script of a user who forgot to guard it.
    """

    def __init__(
        self,
        jobs: int,
        limit: Callable[..., float] | None = None,
        memory: int | None = None,
        hear: Callable[..., None] | None = None,
    ) -> None:
        if getattr(multiprocessing.current_process(), "_inheriting", False):
            raise SystemExit(f"{Path(sys.argv[0]).name} would start workers in every worker: {GUARD}")
        self._limit = limit
        self._tasks: queue.SimpleQueue[_Task | None] = queue.SimpleQueue()
        self._closing = threading.Event()
        self._workers = [_Worker(self._closing, memory, hear) for _ in range(jobs)]
        self._threads = [threading.Thread(target=self._drive, args=(w,), daemon=True) for w in self._workers]
        for thread in self._threads:
            thread.start()

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Queue a call; its future raises `WorkerDied` or `Overdue` where the worker did not come back."""
        future: Future[T] = Future()
        self._tasks.put((future, fn, args, kwargs))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers, after the queued tasks or, with `cancel_futures`, at once."""
        if cancel_futures:
            self._closing.set()
            for worker in self._workers:
                worker.kill()
        for _ in self._threads:
            self._tasks.put(None)
        if wait:
            for thread in self._threads:
                thread.join()

    def _drive(self, worker: _Worker) -> None:
        if hasattr(signal, "pthread_sigmask"):  # inherited by the worker: Ctrl-C cannot reach it, not even as it starts
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        while (task := self._tasks.get()) is not None:
            future, fn, args, kwargs = task
            if self._closing.is_set() or not future.set_running_or_notify_cancel():
                future.cancel()
                continue
            try:
                limit = self._limit and self._limit(*args, **kwargs)
                future.set_result(worker.call_again((fn, args, kwargs), limit))
            except Exception as error:  # whatever the task raised belongs to its future
                future.set_exception(error)
        worker.kill()


class _Worker:
    """One process and the pipe to it; started when first needed and again after a death."""

    def __init__(
        self, closing: threading.Event, memory: int | None = None, hear: Callable[..., None] | None = None
    ) -> None:
        self._closing, self.memory, self._hear = closing, memory, hear
        self._process: Any = None
        self._pipe: Connection | None = None

    def call_again(self, message: tuple[Any, ...], limit: float | None) -> Any:
        """Do a task, and once more if the process died: a crash of its own comes again, a kill from outside does not."""
        try:
            return self.call(message, limit)
        except WorkerDied:
            if self._closing.is_set():
                raise
            return self.call(message, limit)

    def call(self, message: tuple[Any, ...], limit: float | None) -> Any:
        """Let the process do one task, for at most `limit` seconds from when it is ready."""
        pipe = self._ready()
        pipe.send(message)
        end = time.monotonic() + (limit or 0.0)
        done = None
        while done is None:
            left = None if limit is None else max(end - time.monotonic(), 0.0)
            if not wait([pipe, self._process.sentinel], left):
                self.kill()
                raise Overdue(f"stopped after {limit:g} s")
            done, outcome = self._received(pipe)
            if done is None and self._hear is not None:
                self._hear(outcome, *message[1], **message[2])
        if not done:
            raise outcome
        return outcome

    def _ready(self) -> Connection:
        if self._pipe is None or not self._process.is_alive():
            self._start()
        if self._pipe is None or self._closing.is_set():
            raise WorkerDied("the pool was closed")
        return self._pipe

    def _start(self) -> None:
        self._pipe, theirs = _spawn.Pipe()
        self._process = _spawn.Process(target=_serve, args=(theirs, self.memory, self._hear is not None), daemon=True)
        with _starting:
            before = {name: os.environ.get(name) for name in _THREADS}
            os.environ.update(dict.fromkeys(_THREADS, "1"))  # read when the worker first imports NumPy
            try:
                with _children_allowed():
                    self._process.start()
            finally:
                for name, value in before.items():
                    os.environ.pop(name) if value is None else os.environ.update({name: value})
        theirs.close()
        try:
            self._received(self._pipe)  # it says that its imports are done
        except WorkerDied as died:
            raise WorkerDied(f"{died} as it started; {GUARD}") from None

    def _received(self, pipe: Connection) -> Any:
        try:
            return pipe.recv()
        except (EOFError, OSError):
            self._process.join()
            code = self._process.exitcode
            self.kill()
            raise WorkerDied(f"the worker process {_ending(code)}") from None

    def kill(self) -> None:
        """End the process at once."""
        if self._process is not None and self._process.pid is not None:
            self._process.kill()
            self._process.join()
        self._pipe = None


_own = threading.local()


def call_guarded(fn: Callable[P, T], limit: float, memory: int | None, /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Call a function in a process beside this one, which a crash or a hang does not take along.

    Every thread keeps one such process for its next calls; it ends with the thread.

    Raises
    ------
    WorkerDied, Overdue
        As from the futures of a `WorkerPool`.
    """
    worker: _Worker | None = getattr(_own, "worker", None)
    if worker is None or worker.memory != memory:
        worker = _own.worker = _Worker(threading.Event(), memory)
    return worker.call_again((fn, args, kwargs), limit)


@contextmanager
def _children_allowed() -> Iterator[None]:
    """Let a daemonic process, such as a worker of Dask, have children: ours end when their parent does."""
    config: dict[str, Any] = multiprocessing.current_process()._config  # type: ignore[attr-defined]
    daemon = config.get("daemon")
    config["daemon"] = False
    try:
        yield
    finally:
        config["daemon"] = daemon


def _ending(code: int | None) -> str:
    if code is None or code >= 0:
        return f"ended with exit code {code}"
    try:
        return f"was ended by {signal.Signals(-code).name}"
    except ValueError:
        return f"was ended by signal {-code}"


def _serve(pipe: Connection, memory: int | None = None, heard: bool = False) -> None:
    """Work off tasks until the other end closes; native chatter would spoil the display, so it goes nowhere."""
    tell = (lambda said: pipe.send((None, said))) if heard else None
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the main process's business
    threading.Thread(target=_die_with_parent, daemon=True).start()
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    pipe.send((True, None))
    while True:
        try:
            fn, args, kwargs = pipe.recv()
        except EOFError:
            return
        if memory is not None:
            _limit_memory(memory)
            memory = None
        with supervised(tell=tell):
            outcome = _outcome(fn, args, kwargs)
        try:
            pipe.send(outcome)
        except (TypeError, AttributeError, pickle.PicklingError) as error:
            pipe.send((False, RuntimeError(f"the answer cannot be sent between processes: {error}")))


def _outcome(fn: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> tuple[bool, Any]:
    try:
        return True, fn(*args, **kwargs)
    except Exception as error:  # travels to the future
        return False, error


def _limit_memory(more: int) -> None:
    """Let this process map so many bytes more than now; beyond, Python raises MemoryError and native code may abort."""
    if MEMORY:
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + more
        resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))


def _die_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
