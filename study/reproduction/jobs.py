"""Runs behind the papers' numbers as jobs of the one pool and store; their outcomes are records of plain data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, ClassVar

from study.errors import StudyError
from study.planning import Status
from study.runs.job import PATIENCE
from study.store.codec import canonical, checksum, plain
from study.store.kept import Encoded
from study.store.provenance import code_behind

Record = dict[str, Any]
"""Outcome of a job: numbers, texts and lists that JSON can hold."""

MEASURED = "seconds"
"""Field of a record that holds measured times."""


@dataclass(frozen=True)
class RecordJob:
    """Base of the jobs of a reproduction; equal jobs are run once.

    Attributes
    ----------
    weight : float
        Rough cost, so that long jobs start first.
    """

    kind: ClassVar[str]
    weight: ClassVar[float]
    time_limit: ClassVar[float] = 4 * PATIENCE
    seed: ClassVar[int] = 0

    def run(self) -> Record:
        """Do the work; it may depend on nothing but the job."""
        raise StudyError(f"{type(self).__name__} does not say how it is run")

    @property
    def subject(self) -> str:
        """Case, function or robot that the job is about."""
        return self.kind

    @property
    def method(self) -> str:
        """Search or planner; without one, the kind of run."""
        return type(self.search).__name__ if hasattr(self, "search") else self.kind

    @property
    def label(self) -> str:
        """Name in tables."""
        return self.method

    def inputs(self) -> object:
        """Return the data that the job looks up by name; their content is part of the job's."""
        return None

    def planners(self) -> tuple[str, ...]:
        """Registry names of the planners that the job calls."""
        return ()

    def settings(self) -> str:
        """Write the job's fields."""
        return canonical(plain(self))

    def content(self) -> str:
        """Checksum of the job's fields and inputs."""
        return checksum([plain(self), plain(self.inputs())])

    def code(self) -> str:
        """Name the code of the job's own module, of every object in its fields, and of its planners."""
        return code_behind(self.planners(), tuple(sorted(set(_modules(self)))))

    def encode(self, outcome: Record) -> Encoded:
        """Put measured times apart."""
        document = {name: value for name, value in outcome.items() if name != MEASURED}
        return Encoded(document, times={MEASURED: outcome[MEASURED]} if MEASURED in outcome else {})

    def decode(self, encoded: Encoded) -> Record:
        """Put the record together again."""
        return {**encoded.document, **encoded.times}

    def failed(self, reason: str, wall_time: float, status: Status) -> Record:
        """Refuse to keep a failure: a paper's number cannot be ruled on without the run.

        Raises
        ------
        StudyError
            Always.
        """
        raise StudyError(f"reproduction: {self!r} failed: {reason}; finished jobs are stored: run again to go on")


def _modules(content: object) -> Iterator[str]:
    if is_dataclass(content):
        yield type(content).__module__
        for part in fields(content):
            yield from _modules(getattr(content, part.name))


class Runs(dict[Any, Record]):
    """Records of finished jobs."""

    def __missing__(self, job: RecordJob) -> Record:
        raise StudyError(f"reproduction: nothing was run for {job!r}; ask for it among the paper's jobs")
