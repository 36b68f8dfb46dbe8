"""Interface between the store and what it keeps: the identity of a job, and its outcome as plain data."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol, TypeVar

from numpy.typing import NDArray

from study.planning import Status

T = TypeVar("T")
Arrays = Mapping[str, NDArray[Any]]

FORMAT = 3
"""Bump when the stored format changes meaning, so that every job is run again."""


@dataclass(frozen=True, eq=False)
class Encoded:
    """An outcome as the store keeps it.

    Attributes
    ----------
    document : mapping of str to plain data
        Everything that two equal runs have in common, arrays apart.
    arrays : mapping of str to array
    times : mapping of str to plain data
        Measured times, s: kept, but outside what two equal runs have in common.
    wall_time : float, s
    status : Status
    feasible : bool
    duration : float, s, optional
    worst_ratio : float, optional
        Largest share of a limit.
    evaluations : int
    """

    document: Mapping[str, Any]
    arrays: Arrays = field(default_factory=dict)
    times: Mapping[str, Any] = field(default_factory=dict)
    wall_time: float = 0.0
    status: Status = Status.FINISHED
    feasible: bool = False
    duration: float | None = None
    worst_ratio: float | None = None
    evaluations: int = 0


class Keepable(Protocol[T]):
    """A job whose outcome can be kept, under a name made of its content and of the code behind it."""

    kind: ClassVar[str]
    """The same for all jobs of a class, such as `cell`."""

    @property
    def subject(self) -> str:
        """Case or function that the job is about."""

    @property
    def method(self) -> str:
        """Planner or search."""

    @property
    def label(self) -> str:
        """Name in tables; no part of the key."""

    @property
    def seed(self) -> int:
        """Seed of the random numbers."""

    def settings(self) -> str:
        """Write the settings without the seed, for people and for exports."""

    def content(self) -> str:
        """Checksum of everything that determines the outcome, except seed and code."""

    def code(self) -> str:
        """Name the code behind the outcome; see `study.store.provenance.code_behind`."""

    def encode(self, outcome: T) -> Encoded:
        """Turn an outcome into plain data, the inverse of `decode`."""

    def decode(self, encoded: Encoded) -> T:
        """Turn plain data back into the outcome."""


def key_of(job: Keepable[Any]) -> str:
    """Name a job by content, code and seed: SHA-256 in hexadecimal."""
    return hashlib.sha256(f"{FORMAT}\n{job.kind}\n{job.content()}\n{job.code()}\n{job.seed}".encode()).hexdigest()
