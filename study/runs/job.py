"""Anything that is run in the one pool and kept in the one store: a planner on a case, a bare search, a paper's run."""

from __future__ import annotations

from typing import Protocol, TypeVar

from study.planning import Status
from study.store.kept import Keepable

T = TypeVar("T")

PATIENCE = 3600.0
"""Seconds after which a job that keeps no clock itself is taken for hung."""


class Job(Keepable[T], Protocol[T]):
    """A description of work that travels to a worker; its outcome depends on nothing but the job and the code."""

    @property
    def time_limit(self) -> float:
        """Wall time after which the work should have ended by itself, s."""

    def run(self) -> T:
        """Do the work; the caller may be a worker process."""

    def failed(self, reason: str, wall_time: float, status: Status) -> T:
        """Build the outcome of work that was stopped or crashed.

        Raises
        ------
        StudyError
            If such an end is not worth keeping.
        """
