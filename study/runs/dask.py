"""The workers of a Dask scheduler, for jobs that are too many for one machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from typing import Any

from study.engine import chosen
from study.errors import StudyError

LOCAL = "local"
PATIENCE = 20
"""Seconds to wait for a scheduler, and for its first worker."""

RETRIES = 3
"""Number of times that a job is tried again after the machine that ran it was lost."""


@contextmanager
def dask_executor(address: str, jobs: int) -> Iterator[Executor]:
    """Offer the workers of a Dask scheduler as an executor.

    Parameters
    ----------
    address : str
        Of a scheduler, such as `tcp://10.0.0.5:8786`, or `local` for one of our own that ends with the block and listens
        on this machine alone.
    jobs : int
        Workers of one's own scheduler.

    Raises
    ------
    StudyError
        If Dask is not installed, nobody answers at the address, there are no workers, or they run other code.
    """
    distributed = _distributed()
    with ExitStack() as stack:
        try:
            if address == LOCAL:
                address = stack.enter_context(_cluster(distributed, jobs)).scheduler_address
            client = stack.enter_context(distributed.Client(address, timeout=PATIENCE, set_as_default=False))
            client.wait_for_workers(1, timeout=PATIENCE)
        except (OSError, ValueError, TimeoutError) as error:
            reason = " ".join(str(error).split())
            raise StudyError(f"no Dask workers at {address}: {reason}; start a scheduler and workers first") from error
        _check_kernels(client.run(chosen))
        yield client.get_executor(retries=RETRIES)


def _distributed() -> Any:
    try:
        import distributed  # here: an extra, and slow to import
    except ImportError as error:
        raise StudyError(
            "--dask needs Dask, which is not installed; run: pip install 'time-optimal-study[dask]'"
        ) from error
    return distributed


def _cluster(distributed: Any, jobs: int) -> Any:
    """Build a scheduler and its workers on loopback, each worker a process of one thread."""
    return distributed.LocalCluster(
        n_workers=jobs,
        threads_per_worker=1,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        worker_dashboard_address="127.0.0.1:0",
        memory_limit=0,
        silence_logs="CRITICAL",
    )


def _check_kernels(workers: Mapping[str, str]) -> None:
    """Refuse workers whose searches would take other kernels than this machine's; code is compared job by job."""
    for worker, there in workers.items():
        if there != chosen():
            raise StudyError(
                f"the Dask worker {worker} takes the kernels of {there} and this machine those of {chosen()}; "
                "install the same packages there, or set STUDY_ENGINE on both"
            )
