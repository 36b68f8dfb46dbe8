"""Where results live: one SQLite file, one writer, every cell kept the moment it is finished.

A row is named by the content of its cell (see `study.experiment.codec.cell_key`), so a cell that is computed twice is
stored once and a changed case is a new cell. Every row carries a checksum of all of its result columns; wall time,
which no two runs share, is outside it.
"""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from types import TracebackType

from study.errors import StudyError
from study.experiment.cases import Case
from study.experiment.codec import canonical, cell_key, decode, encode, encode_times, settings_from
from study.experiment.registry import planner_version
from study.experiment.results import Cell, Result
from study.experiment.storefile import (
    APPLICATION_ID,
    SCHEMA,
    SCHEMA_VERSION,
    check_file,
    explained,
    locked,
    make_folder,
    read_only,
)

_COLUMNS = "key, case_name, planner, settings, seed, version, status, feasible, duration, worst_ratio, evaluations"
_Row = tuple[object, ...]


class Store:
    """Results of cells in one file; use it as a context manager.

    Parameters
    ----------
    path : Path
        Made, with its folder, when it does not exist and `write` is true.
    cases : mapping of str to Case
        Content of the cases whose cells are stored or asked for.
    write : bool
        Whether to become the file's one writer.

    Raises
    ------
    StudyError
        If the file is corrupt, of another program or version, cannot be written, or another run is writing to it.
    """

    def __init__(self, path: Path, cases: Mapping[str, Case], *, write: bool = True) -> None:
        self.path = path
        self.cases = cases
        self._lock: sqlite3.Connection | None = None
        self._keys: dict[Cell, str] = {}
        if write:
            make_folder(path.parent)
            self._lock = locked(path)
        elif not path.exists():
            raise StudyError(f"there are no results at {path}; run `study run` first, or name its folder with --out")
        try:
            self._connection = self._opened(write)
        except BaseException:
            self._unlock()
            raise

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Release the file."""
        self._connection.close()
        self._unlock()

    def _unlock(self) -> None:
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def _opened(self, write: bool) -> sqlite3.Connection:
        if self.path.exists() and self.path.stat().st_size:
            check_file(self.path)
        with explained(self.path):
            if not write:
                return sqlite3.connect(read_only(self.path), uri=True)
            connection = sqlite3.connect(self.path, isolation_level=None)
            try:
                _prepare(connection)
            except sqlite3.Error:
                connection.close()
                raise
            return connection

    def key(self, cell: Cell) -> str:
        """Name of a cell in the file."""
        if cell not in self._keys:
            code = f"{planner_version(cell.planner)}; study {version('time-optimal-study')}"
            self._keys[cell] = cell_key(cell, self.cases[cell.case].problem, code)
        return self._keys[cell]

    def add(self, *results: Result) -> None:
        """Keep results, all of them or, on failure, none; a cell that is there already stays as it is.

        Raises
        ------
        StudyError
            If the file cannot be written, as on a full disk; what was stored before is safe.
        """
        rows = [self._row(result) for result in results]
        with explained(self.path), self._transaction():
            for row, payload in rows:
                marks = ", ".join("?" * len(row))
                self._connection.execute(f"INSERT OR IGNORE INTO results VALUES ({marks})", row)  # noqa: S608
                self._connection.execute("INSERT OR IGNORE INTO payloads VALUES (?, ?, ?)", (row[0], *payload))

    def _row(self, result: Result) -> tuple[_Row, tuple[str, bytes]]:
        cell, verdict = result.cell, result.verdict
        payload = encode(result)
        columns: _Row = (
            self.key(cell),
            cell.case,
            cell.planner,
            canonical(asdict(cell.settings)),
            cell.settings.seed,
            planner_version(cell.planner),
            result.status.name,
            int(verdict is not None and verdict.feasible),
            verdict.duration if verdict else None,
            verdict.worst_ratio if verdict else None,
            int(result.evaluations),
        )
        return (*columns, _row_digest(columns, *payload), float(result.wall_time), encode_times(result)), payload

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._connection.execute("COMMIT")
        except BaseException:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
            raise

    def missing(self, cells: Iterable[Cell]) -> list[Cell]:
        """Cells that have no stored result, in the order given."""
        with explained(self.path):
            known = {key for (key,) in self._connection.execute("SELECT key FROM results")}
        return [cell for cell in cells if self.key(cell) not in known]

    def results(self, cells: Iterable[Cell]) -> list[Result]:
        """Stored results of cells, in the order given; cells without one are left out.

        Raises
        ------
        StudyError
            If a row does not match its checksum.
        """
        with explained(self.path):
            found = [(cell, self._stored(self.key(cell))) for cell in cells]
        return [self._checked(cell, row) for cell, row in found if row is not None]

    def _stored(self, key: str) -> _Row | None:
        query = f"SELECT {_COLUMNS}, document, arrays, digest, wall_time, times FROM results JOIN payloads USING (key) WHERE key = ?"  # noqa: S608
        row: _Row | None = self._connection.execute(query, (key,)).fetchone()
        return row

    def _checked(self, cell: Cell, row: _Row) -> Result:
        *columns, document, arrays, digest, wall_time, times = row
        if _row_digest(tuple(columns), str(document), bytes(arrays)) != digest:  # type: ignore[call-overload]
            raise StudyError(
                f"results file {self.path}: the row of {cell.label} on {cell.case} (seed {cell.settings.seed}) is damaged; "
                "move the file away and run again"
            )
        return decode(cell, str(document), bytes(arrays), float(str(wall_time)), str(times))  # type: ignore[call-overload]

    def remember_lineup(self, cells: Sequence[Cell], sources: Mapping[str, str]) -> None:
        """Keep which cells the last run was about, so that `study report` shows the same ones.

        Parameters
        ----------
        cells : sequence of Cell
        sources : mapping of str to str
            For every case, the name or path it was loaded from.
        """
        rows = [
            (i, cell.case, cell.planner, cell.label, canonical(asdict(cell.settings)), sources[cell.case])
            for i, cell in enumerate(cells)
        ]
        with explained(self.path), self._transaction():
            self._connection.execute("DELETE FROM lineup")
            self._connection.executemany("INSERT INTO lineup VALUES (?, ?, ?, ?, ?, ?)", rows)

    def digest(self) -> str:
        """One checksum of all results without their wall times, whatever the order in which they came."""
        with explained(self.path):
            rows = self._connection.execute("SELECT key, digest FROM results ORDER BY key").fetchall()
        return hashlib.sha256("\n".join(":".join(row) for row in rows).encode()).hexdigest()


def _prepare(connection: sqlite3.Connection) -> None:
    """Lay out a new file, or find out before any work is done that an old one cannot be written."""
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    if connection.execute("PRAGMA user_version").fetchone()[0] == 0:
        marks = f"PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {SCHEMA_VERSION};"
        connection.executescript(f"BEGIN; {SCHEMA} {marks} COMMIT;")
    else:
        connection.execute("DELETE FROM lineup WHERE 0")


def remembered_lineup(path: Path) -> tuple[list[Cell], dict[str, str]]:
    """Cells of the last run into a file, and where its cases were loaded from."""
    with Store(path, {}, write=False) as store, explained(path):
        rows = store._connection.execute(
            "SELECT case_name, planner, label, settings, source FROM lineup ORDER BY position"
        ).fetchall()
    cells = [Cell(case, planner, label, settings_from(settings)) for case, planner, label, settings, _ in rows]
    return cells, {row[0]: row[4] for row in rows}


def _row_digest(columns: _Row, document: str, arrays: bytes) -> str:
    digest = hashlib.sha256(canonical(columns).encode())
    digest.update(document.encode())
    digest.update(arrays)
    return digest.hexdigest()
