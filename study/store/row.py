"""One row of the results file: its columns, its payload and the two checksums that everything stands under."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any, TypeVar

from study.planning import Status
from study.store.codec import canonical, checksum, pack_arrays, unpack_arrays
from study.store.content import parsed
from study.store.kept import Encoded, Keepable, key_of

T = TypeVar("T")
CHECKED = "key, kind, subject, method, settings, seed, code, status, feasible, duration, worst_ratio, evaluations"
"""Columns under a row's digest, in their order."""

SEALED = "label, digest, wall_time, times"
"""Columns under a row's seal, in their order."""

Columns = tuple[Any, ...]


@dataclass(frozen=True)
class Row:
    """One row of the file with its payload.

    Attributes
    ----------
    checked : tuple
        Values of `CHECKED`.
    sealed : tuple
        Values of `SEALED`.
    seal : str
    document : str
    arrays : bytes
    """

    checked: Columns
    sealed: Columns
    seal: str
    document: str
    arrays: bytes

    QUERY = f"SELECT {CHECKED}, {SEALED}, seal, document, arrays FROM results LEFT JOIN payloads USING (id)"  # noqa: S608

    @staticmethod
    def of(values: Columns) -> Row:
        """Take what `QUERY` gives apart."""
        return Row(values[:12], values[12:16], *values[16:])

    @property
    def values(self) -> Columns:
        """Values of the table `results`, payload and identifier apart."""
        return *self.checked, *self.sealed, self.seal

    @property
    def name(self) -> str:
        """Name of the outcome for people."""
        return f"{self.sealed[0]} on {self.checked[2]} (seed {self.checked[5]})"

    def encoded(self) -> Encoded:
        """Check and read the row.

        Raises
        ------
        ValueError
            If a checksum does not fit, or the content is not what its checksums promise.
        """
        try:
            _, digest, wall_time, times = self.sealed
            if row_digest(self.checked, self.document, self.arrays) != digest or checksum(self.sealed) != self.seal:
                raise ValueError("its checksum does not fit")
            *_, status, feasible, duration, worst_ratio, evaluations = self.checked
            return Encoded(
                dict(parsed(self.document)), unpack_arrays(self.arrays), dict(parsed(times)), wall_time,
                Status[status], bool(feasible), duration, worst_ratio, evaluations,
            )  # fmt: skip
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"it cannot be read: {error}") from error


def row_of(job: Keepable[T], outcome: T) -> Row:
    """Put a job and its outcome into a row."""
    encoded = job.encode(outcome)
    document, arrays = canonical(encoded.document), pack_arrays(encoded.arrays)
    checked: Columns = (
        key_of(job), job.kind, job.subject, job.method, job.settings(), job.seed, job.code(), encoded.status.name,
        int(encoded.feasible), encoded.duration, encoded.worst_ratio, encoded.evaluations,
    )  # fmt: skip
    sealed = job.label, row_digest(checked, document, arrays), encoded.wall_time, canonical(encoded.times)
    return Row(checked, sealed, checksum(sealed), document, arrays)


def row_digest(columns: Columns, document: str, arrays: bytes) -> str:
    """Checksum of what two equal runs have in common: columns and payload."""
    digest = hashlib.sha256(canonical(columns).encode())
    digest.update(document.encode())
    digest.update(arrays)
    return digest.hexdigest()
