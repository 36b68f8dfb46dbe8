"""Where results live: one SQLite file, one writer, every cell kept the moment it is finished.

A row is named by the content of its cell (see `study.store.codec.cell_key`), so a cell that is computed twice is
stored once, and a changed case or changed code of a planner makes a new cell. Every row carries a checksum of all of its result columns; wall time,
which no two runs share, is outside it.
"""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from types import TracebackType

from study.cases.library import Case
from study.errors import StudyError
from study.planning import Status
from study.registry import planner_code
from study.store.codec import (
    canonical,
    cell_key_in,
    decode,
    encode,
    encode_times,
    problem_digest,
    settings_from,
    settings_text,
)
from study.store.file import check_file, explained, locked, make_folder, read_only, transaction
from study.store.results import Cell, Result
from study.store.schema import SCHEMA_VERSION, lay_out

CHECKED = "key, case_name, planner, settings, seed, version, status, feasible, duration, worst_ratio, evaluations"
"""Columns under a row's checksum, in their order."""

_ROW = f"INSERT INTO results ({CHECKED}, digest, wall_time, times, label, id) VALUES ({', '.join('?' * 16)})"  # noqa: S608
_PAYLOAD = "INSERT INTO payloads VALUES (?, ?, ?)"
_KNOWN = "SELECT value FROM json_each(?) WHERE value IN (SELECT key FROM results)"
_BATCH = 10_000
"""Keys that are looked up by one question."""

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
        self._problems: dict[str, str] = {}
        self._codes: dict[str, str] = {}
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
            layout = check_file(self.path)
            if not write and layout < SCHEMA_VERSION:
                Store(self.path, self.cases).close()  # brings an older file to this layout
        with explained(self.path):
            return sqlite3.connect(read_only(self.path), uri=True) if not write else _prepared(self.path)

    def key(self, cell: Cell) -> str:
        """Name of a cell in the file."""
        if cell.case not in self._problems:
            self._problems[cell.case] = problem_digest(self.cases[cell.case].problem)
        return cell_key_in(self._problems[cell.case], cell, self._code(cell.planner))

    def _code(self, planner: str) -> str:
        if planner not in self._codes:
            self._codes[planner] = planner_code(planner)
        return self._codes[planner]

    def add(self, *results: Result, replace: bool = False) -> None:
        """Keep results, all of them or, on failure, none.

        Parameters
        ----------
        results : Result
        replace : bool
            Whether a result takes the place of a stored one of the same cell; else the stored one stays as it is.

        Raises
        ------
        StudyError
            If the file cannot be written, as on a full disk; what was stored before is safe.
        """
        rows = {str(row[0]): (row, payload) for row, payload in map(self._row, results)}
        with explained(self.path), transaction(self._connection):
            for key in self._known(rows):
                if replace:
                    self._forget(key)
                else:
                    del rows[key]
            first = self._connection.execute("SELECT coalesce(max(id), 0) + 1 FROM results").fetchone()[0]
            new = list(enumerate(rows.values(), first))
            self._connection.executemany(_ROW, ((*row, number) for number, (row, _) in new))
            self._connection.executemany(_PAYLOAD, ((number, *payload) for number, (_, payload) in new))

    def _known(self, keys: Iterable[str]) -> list[str]:
        """Which of these keys are stored."""
        return [key for (key,) in self._connection.execute(_KNOWN, (canonical(list(keys)),))]

    def _forget(self, key: str) -> None:
        self._connection.execute("DELETE FROM payloads WHERE id = (SELECT id FROM results WHERE key = ?)", (key,))
        self._connection.execute("DELETE FROM results WHERE key = ?", (key,))

    def _row(self, result: Result) -> tuple[_Row, tuple[str, bytes]]:
        cell, verdict = result.cell, result.verdict
        payload = encode(result)
        columns: _Row = (
            self.key(cell),
            cell.case,
            cell.planner,
            settings_text(cell.settings),
            cell.settings.seed,
            self._code(cell.planner),
            result.status.name,
            int(verdict is not None and verdict.feasible),
            verdict.duration if verdict else None,
            verdict.worst_ratio if verdict else None,
            int(result.evaluations),
        )
        digest = row_digest(columns, *payload)
        return (*columns, digest, float(result.wall_time), encode_times(result), cell.label), payload

    def missing(self, cells: Iterable[Cell]) -> list[Cell]:
        """Cells that have no stored result, in the order given."""
        cells = list(cells)
        keys = [self.key(cell) for cell in cells]
        asked, known = iter(sorted(set(keys))), set[str]()  # in the order of the index, each of its pages is read once
        with explained(self.path):
            while batch := list(islice(asked, _BATCH)):
                known.update(self._known(batch))
        return [cell for key, cell in zip(keys, cells, strict=True) if key not in known]

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
        query = f"SELECT {CHECKED}, document, arrays, digest, wall_time, times FROM results JOIN payloads USING (id) WHERE key = ?"  # noqa: S608
        row: _Row | None = self._connection.execute(query, (key,)).fetchone()
        return row

    def _checked(self, cell: Cell, row: _Row) -> Result:
        *columns, document, arrays, digest, wall_time, times = row
        if row_digest(tuple(columns), str(document), bytes(arrays)) != digest:  # type: ignore[call-overload]
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
            (i, cell.case, cell.planner, cell.label, settings_text(cell.settings), sources[cell.case])
            for i, cell in enumerate(cells)
        ]
        with explained(self.path), transaction(self._connection):
            self._connection.execute("DELETE FROM lineup")
            self._connection.executemany("INSERT INTO lineup VALUES (?, ?, ?, ?, ?, ?)", rows)

    def cut_short(self) -> int:
        """Count the results that a time limit decided; another run may end them elsewhere."""
        with explained(self.path):
            query = "SELECT count(*) FROM results WHERE status = ?"
            return int(self._connection.execute(query, (Status.TIMED_OUT.name,)).fetchone()[0])

    def digest(self) -> str:
        """One checksum of all results without their wall times, whatever the order in which they came."""
        with explained(self.path):
            rows = sorted(self._connection.execute("SELECT key, digest FROM results"))  # in the file's order: faster
        return hashlib.sha256("\n".join(":".join(row) for row in rows).encode()).hexdigest()


def _prepared(path: Path) -> sqlite3.Connection:
    """Open a file for writing: lay it out, or find out before any work is done that it cannot be written."""
    connection = sqlite3.connect(path, isolation_level=None)
    try:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = FULL")  # a finished cell outlives a power cut too
        connection.execute("PRAGMA cache_size = -65536")  # KiB; holds the index of keys of a sweep
        lay_out(connection)
        connection.execute("DELETE FROM lineup WHERE 0")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def remembered_lineup(path: Path) -> tuple[list[Cell], dict[str, str]]:
    """Cells of the last run into a file, and where its cases were loaded from."""
    with Store(path, {}, write=False) as store, explained(path):
        rows = store._connection.execute(
            "SELECT case_name, planner, label, settings, source FROM lineup ORDER BY position"
        ).fetchall()
    cells = [Cell(case, planner, label, settings_from(settings)) for case, planner, label, settings, _ in rows]
    return cells, {row[0]: row[4] for row in rows}


def row_digest(columns: _Row, document: str, arrays: bytes) -> str:
    """Checksum of one result: its columns and its payload."""
    digest = hashlib.sha256(canonical(columns).encode())
    digest.update(document.encode())
    digest.update(arrays)
    return digest.hexdigest()
