"""Shared by the tests: runs without worker processes, for tests in which the process is not the point."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from study.runs import runner


class Threads(ThreadPoolExecutor):
    """Threads in the place of a `study.runs.pool.WorkerPool`: quick to start, but nothing that crashes or hangs may run."""

    def __init__(self, jobs, limit=None, memory=None, hear=None):
        super().__init__(jobs)


def no_processes(patch: pytest.MonkeyPatch) -> None:
    """Let jobs run in threads of this process."""
    patch.setattr(runner, "WorkerPool", Threads)
