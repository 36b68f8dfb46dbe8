"""Results files made invalid: in their pages, their tables, their values, and in values under checksums that fit."""

from __future__ import annotations

import sqlite3
import tempfile
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path

from study.store.codec import checksum
from study.store.row import CHECKED, SEALED, Row, row_digest
from tests.fuzz.mutations import SCALARS, TREES, Pick, in_bytes

COLUMNS = (*CHECKED.split(", "), *SEALED.split(", "), "seal", "id")
JUNK = (
    "",
    "x",
    b"",
    b"\xff\x00",
    0,
    -1,
    1e308,
    5e-324,
    None,
    2**62,
    "\x1b[31m",
    "=1+1",
    "nan",
    "[]",
    "{}",
    "[[",
    "9" * 5000,
    "a" * 10**5,
)
STATEMENTS = (
    "PRAGMA user_version = 4", "PRAGMA user_version = -1", "PRAGMA user_version = 0", "PRAGMA application_id = 1", "DROP TABLE notes",
    "DROP INDEX results_by_label", "DELETE FROM payloads", "DELETE FROM results WHERE id % 2", "DELETE FROM notes", "CREATE TABLE x (y)",
    "CREATE TRIGGER t AFTER DELETE ON notes BEGIN DELETE FROM results; END", "ALTER TABLE results ADD COLUMN z", "VACUUM",
    "CREATE VIEW v AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x FROM c", "PRAGMA journal_mode = WAL",
    "INSERT INTO results SELECT id + 10, key || 'x', kind, subject, label, method, settings, seed, code, status, feasible, duration, worst_ratio,"
    " evaluations, digest, wall_time, times, seal FROM results", "UPDATE results SET kind = 'trial'", "PRAGMA auto_vacuum = FULL; VACUUM",
)  # fmt: skip


def in_store(content: bytes, pick: Pick) -> bytes:
    """Change a results file as a user, an attacker or a bad disk may."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.sqlite"
        path.write_bytes(content)
        with (
            suppress(sqlite3.Error, UnicodeDecodeError, ValueError, TypeError, AttributeError),
            closing(sqlite3.connect(path)) as file,
        ):
            (_statement, _value, _note, _sealed)[pick(4)](file, pick)
            file.commit()
        return path.read_bytes()


def _statement(file: sqlite3.Connection, pick: Pick) -> None:
    file.executescript(STATEMENTS[pick(len(STATEMENTS))])


def _value(file: sqlite3.Connection, pick: Pick) -> None:
    column, junk = COLUMNS[pick(len(COLUMNS))], JUNK[pick(len(JUNK))]
    file.execute(f"UPDATE results SET {column} = ? WHERE id <= ?", (junk, 1 + pick(4)))


def _note(file: sqlite3.Connection, pick: Pick) -> None:
    name, text = file.execute("SELECT name, text FROM notes").fetchone()
    text = _spoilt(text.encode(), pick)
    file.execute("UPDATE notes SET text = ?, seal = ?", (text, checksum([name, text]) if pick(4) else "x"))


def _sealed(file: sqlite3.Connection, pick: Pick) -> None:
    """Spoil a part of a row and make its checksums fit again."""
    ids = file.execute("SELECT id FROM results").fetchall()
    (chosen,) = ids[pick(len(ids))]
    row = Row.of(file.execute(f"{Row.QUERY} WHERE results.id = ?", (chosen,)).fetchone())
    checked, sealed = list(row.checked), list(row.sealed)
    part = pick(4)
    if part == 0:
        row = replace(row, document=_spoilt(row.document.encode(), pick))
    elif part == 1:
        row = replace(row, arrays=in_bytes(row.arrays, pick))
    elif part == 2:
        at = pick(len(checked))
        checked[at] = (
            _spoilt(checked[at].encode(), pick) if isinstance(checked[at], str) and pick(2) else JUNK[pick(len(JUNK))]
        )
    else:
        at = (0, 2, 3)[pick(3)]
        sealed[at] = _spoilt(sealed[at].encode(), pick) if isinstance(sealed[at], str) else JUNK[pick(len(JUNK))]
    sealed[1] = row_digest(tuple(checked), row.document, row.arrays)
    file.execute("DELETE FROM results WHERE id = ?", (chosen,))
    values = (*checked, *sealed, checksum(sealed))
    file.execute(f"INSERT INTO results ({CHECKED}, {SEALED}, seal, id) VALUES ({'?, ' * 17}?)", (*values, chosen))
    file.execute("UPDATE payloads SET document = ?, arrays = ? WHERE id = ?", (row.document, row.arrays, chosen))


def _spoilt(content: bytes, pick: Pick) -> str:
    if pick(5) == 0:
        return SCALARS[pick(len(SCALARS))].decode("utf-8", "replace")
    return TREES[pick(len(TREES))](content, pick).decode("utf-8", "replace")


STORES = (in_store, in_store, in_store, in_bytes)
