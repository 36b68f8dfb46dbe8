"""Pieces of work that run in a process pool and are kept on disk by their content, so that a repeat is quick."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np

from study.datafiles import PACKAGE, data_folder
from study.errors import StudyError

Record = dict[str, Any]
"""What a job leaves: numbers, texts and lists that JSON can hold."""

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class Job(Protocol):
    """A frozen description of work; its text decides what is stored, so equal jobs are run once.

    Attributes
    ----------
    sources : tuple of str
        Files and folders, inside the package or the data, whose change makes a stored record worthless.
    weight : float
        Rough cost, so that long jobs start first.
    """

    sources: ClassVar[tuple[str, ...]]
    weight: ClassVar[float]

    def run(self) -> Record:
        """Do the work; it may depend on nothing but the job."""


class Runs:
    """Records of finished jobs."""

    def __init__(self, records: Mapping[Job, Record]) -> None:
        self._records = records

    def __getitem__(self, job: Job) -> Record:
        """Record of a job that was asked for."""
        if job not in self._records:
            raise StudyError(f"reproduction: nothing was run for {job!r}; ask for it among the paper's jobs")
        return self._records[job]


def run_all(
    jobs: Iterable[Job],
    cache_folder: Path,
    workers: int | None = None,
    on_done: Callable[[Job], None] = lambda job: None,
) -> Runs:
    """Run what is not stored yet, in processes of its own.

    Parameters
    ----------
    jobs : iterable of Job
    cache_folder : Path
        Made if need be.
    workers : int, optional
        All processors by default; with 1 everything runs in this process.
    on_done : callable (job)
        Called after every job, stored or run.

    Returns
    -------
    Runs

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    wanted = sorted(dict.fromkeys(jobs), key=lambda job: -job.weight)
    try:
        cache_folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StudyError(
            f"records cannot be kept in {str(cache_folder)!r}: {error.strerror}; choose another folder"
        ) from None
    records: dict[Job, Record] = {}
    for job in wanted:
        stored = _read(cache_folder / name_of(job))
        if stored is not None:
            records[job] = stored
            on_done(job)
    missing = [job for job in wanted if job not in records]
    for job, record in _run_missing(missing, workers or os.cpu_count() or 1):
        records[job] = record
        _write(cache_folder / name_of(job), record)
        on_done(job)
    return Runs(records)


def _run_missing(jobs: list[Job], workers: int) -> Iterable[tuple[Job, Record]]:
    if workers == 1 or len(jobs) < 2:
        yield from ((job, job.run()) for job in jobs)
        return
    for variable in THREADS:  # one thread for each worker; read when a worker imports numpy
        os.environ.setdefault(variable, "1")
    with ProcessPoolExecutor(min(workers, len(jobs)), mp_context=get_context("spawn")) as pool:
        futures = {pool.submit(_run, job): job for job in jobs}
        for future in as_completed(futures):
            yield futures[future], future.result()


def _run(job: Job) -> Record:
    return job.run()


def name_of(job: Job) -> str:
    """File name of a job's record: a hash of what the job says and of the code that it uses."""
    text = f"{type(job).__name__} {job!r} {fingerprint(job.sources)} numpy {np.__version__}"
    return hashlib.sha256(text.encode()).hexdigest()[:32] + ".json"


@cache
def fingerprint(sources: tuple[str, ...]) -> str:
    """Hash of files of the package and of the data."""
    digest = hashlib.sha256()
    for source in sources:
        root = data_folder().parent if source.startswith("data/") else PACKAGE
        where = root / source
        for path in sorted(where.rglob("*") if where.is_dir() else [where]):
            if path.suffix in (".py", ".yaml"):
                digest.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()


def _read(path: Path) -> Record | None:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def _write(path: Path, record: Record) -> None:
    temporary = path.with_suffix(f".{os.getpid()}")
    temporary.write_text(json.dumps(record), encoding="utf-8")
    temporary.replace(path)
