"""Store of outcomes: one SQLite file, one writer, every job's outcome kept the moment it is finished.

A row is named by the content of its job and by the code behind it (see `study.store.kept.key_of`), so a job that is run
twice is stored once, and a changed case or changed code makes a new one. Every row carries two checksums: the digest of
all that two equal runs have in common, and the seal of the rest: label, digest and measured times.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from contextlib import ExitStack
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

from study.errors import StudyError
from study.planning import Status
from study.store.codec import canonical, checksum
from study.store.content import parsed
from study.store.file import explained, reading, transaction, writing
from study.store.kept import Keepable, key_of
from study.store.row import CHECKED, SEALED, Row, row_of

T = TypeVar("T")
AnyJob = TypeVar("AnyJob", bound=Keepable[Any])
_ROW = f"INSERT INTO results ({CHECKED}, {SEALED}, seal, id) VALUES ({', '.join('?' * 18)})"  # noqa: S608
_PAYLOAD = "INSERT INTO payloads VALUES (?, ?, ?)"
_KNOWN = "SELECT value FROM json_each(?) WHERE value IN (SELECT key FROM results)"
_BATCH = 10_000
"""Keys that are looked up by one question."""


class Store:
    """Outcomes of jobs in one file; use it as a context manager.

    Parameters
    ----------
    path : Path
        Made, with its folder, when it does not exist and `write` is true.
    write : bool
        Whether to become the file's one writer.

    Raises
    ------
    StudyError
        If the file is corrupt, of another program or layout, cannot be written, or another run is writing to it.
    """

    def __init__(self, path: Path, *, write: bool = True) -> None:
        self.path = path
        with ExitStack() as held:
            self._connection = held.enter_context(writing(path) if write else reading(path))
            self._file = self._identity()
            self.check_place()
            self._held = held.pop_all()

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                self.check_place()
        finally:
            self.close()

    def close(self) -> None:
        """Release the file."""
        self._held.close()

    def check_place(self) -> None:
        """Make sure that the file still has its name; what is written to a deleted one is lost.

        Raises
        ------
        StudyError
            If it was deleted or replaced.
        """
        if self._file is None or self._identity() != self._file:
            raise StudyError(f"results file {self.path} was deleted or replaced while it was in use; run again")

    def _identity(self) -> int | None:
        """Number of the file that has the store's name now; None if there is none."""
        try:
            return self.path.stat().st_ino
        except OSError:
            return None

    def add(self, *outcomes: tuple[Keepable[T], T], replace: bool = False) -> None:
        """Keep outcomes, all of them or, on failure, none.

        Parameters
        ----------
        outcomes : tuple of (job, outcome)
        replace : bool
            Whether an outcome takes the place of a stored one of the same job; else the stored one stays as it is.

        Raises
        ------
        StudyError
            If the file cannot be written, as on a full disk, or is gone; what was stored before is safe.
        """
        self.check_place()
        rows = {row.checked[0]: row for row in (row_of(job, outcome) for job, outcome in outcomes)}
        with explained(self.path), transaction(self._connection):
            for key in self._known(rows):
                if replace:
                    self._forget(key)
                else:
                    del rows[key]
            first = self._connection.execute("SELECT coalesce(max(id), 0) + 1 FROM results").fetchone()[0]
            new = list(enumerate(rows.values(), first))
            self._connection.executemany(_ROW, ((*row.values, number) for number, row in new))
            self._connection.executemany(_PAYLOAD, ((number, row.document, row.arrays) for number, row in new))

    def _known(self, keys: Iterable[str]) -> list[str]:
        """Those of the keys that are stored."""
        return [key for (key,) in self._connection.execute(_KNOWN, (canonical(list(keys)),))]

    def _forget(self, key: str) -> None:
        self._connection.execute("DELETE FROM payloads WHERE id = (SELECT id FROM results WHERE key = ?)", (key,))
        self._connection.execute("DELETE FROM results WHERE key = ?", (key,))

    def missing(self, jobs: Iterable[AnyJob]) -> list[AnyJob]:
        """Jobs that have no stored outcome, in the order given, equal ones once."""
        named: dict[str, AnyJob] = {}
        for job in jobs:
            named.setdefault(key_of(job), job)
        asked = iter(sorted(named))  # in the order of the index, each of its pages is read once
        known = set[str]()
        with explained(self.path):
            while batch := list(islice(asked, _BATCH)):
                known.update(self._known(batch))
        return [job for key, job in named.items() if key not in known]

    def outcomes(self, jobs: Iterable[Keepable[T]]) -> list[tuple[Keepable[T], T]]:
        """Jobs with their stored outcomes, in the order given; jobs without one are left out.

        Raises
        ------
        StudyError
            If a row does not match its checksums.
        """
        with explained(self.path):
            rows = [(job, self._stored(key_of(job))) for job in jobs]
        return [(job, self._outcome(job, row)) for job, row in rows if row is not None]

    def _stored(self, key: str) -> Row | None:
        values = self._connection.execute(f"{Row.QUERY} WHERE key = ?", (key,)).fetchone()
        return None if values is None else Row.of(values)

    def _outcome(self, job: Keepable[T], row: Row) -> T:
        try:
            return job.decode(row.encoded())
        except (ValueError, KeyError, TypeError, AttributeError, StudyError) as error:
            raise StudyError(
                f"results file {self.path}: the row of {row.name} is damaged ({error}); move the file away and run again"
            ) from error

    def note(self, name: str, content: object) -> None:
        """Keep plain data under a name, in the place of older data of that name."""
        text = canonical(content)
        self.check_place()
        with explained(self.path), transaction(self._connection):
            self._connection.execute(
                "INSERT OR REPLACE INTO notes VALUES (?, ?, ?)", (name, text, checksum([name, text]))
            )

    def noted(self, name: str) -> Any:
        """Return the data noted under a name; None where there is none.

        Raises
        ------
        StudyError
            If the note does not match its checksum.
        """
        with explained(self.path):
            row = self._connection.execute("SELECT text, seal FROM notes WHERE name = ?", (name,)).fetchone()
        if row is None:
            return None
        try:
            if checksum([name, row[0]]) == row[1]:
                return parsed(row[0])
        except (ValueError, TypeError):  # junk under a checksum that fits
            pass
        raise StudyError(f"results file {self.path}: its note {name!r} is damaged; move the file away and run again")

    def cut_short(self) -> int:
        """Count the outcomes that a time limit decided; another run may end them elsewhere."""
        with explained(self.path):
            query = "SELECT count(*) FROM results WHERE status = ?"
            return int(self._connection.execute(query, (Status.TIMED_OUT.name,)).fetchone()[0])

    def digest(self) -> str:
        """One checksum of all outcomes without measured times, whatever the order in which they came."""
        with explained(self.path):
            rows = sorted(self._connection.execute("SELECT key, digest FROM results"))  # in the file's order: faster
        return hashlib.sha256("\n".join(":".join(row) for row in rows).encode()).hexdigest()
