"""The results file itself: its layout, its lock, and whether it is fit to be used."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from study.errors import StudyError

SCHEMA_VERSION = 1
APPLICATION_ID = 0x74_6F_73_31  # "tos1": tells our files from other SQLite files

SCHEMA = """
CREATE TABLE results (
  key TEXT PRIMARY KEY, case_name TEXT NOT NULL, planner TEXT NOT NULL, settings TEXT NOT NULL, seed INTEGER NOT NULL,
  version TEXT NOT NULL, status TEXT NOT NULL, feasible INTEGER NOT NULL, duration REAL, worst_ratio REAL,
  evaluations INTEGER NOT NULL, digest TEXT NOT NULL, wall_time REAL NOT NULL, times TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE payloads (key TEXT PRIMARY KEY REFERENCES results, document TEXT NOT NULL, arrays BLOB NOT NULL);
CREATE TABLE lineup (
  position INTEGER PRIMARY KEY, case_name TEXT NOT NULL, planner TEXT NOT NULL, label TEXT NOT NULL,
  settings TEXT NOT NULL, source TEXT NOT NULL
);
"""


def make_folder(folder: Path) -> None:
    """Make a folder, or say why nothing can be written there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StudyError(
            f"cannot make the output folder {folder}: {error.strerror}; name another one with --out"
        ) from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise StudyError(f"cannot write to the output folder {folder}: permission denied; name another one with --out")


def locked(path: Path) -> sqlite3.Connection:
    """Hold a lock beside the file that the operating system frees when the process ends, however it ends."""
    lock = sqlite3.connect(path.with_name(path.name + ".lock"), timeout=0, isolation_level=None)
    try:
        lock.execute("BEGIN EXCLUSIVE")
    except sqlite3.Error as error:
        lock.close()
        if "locked" in str(error):
            raise StudyError(
                f"another run is writing to {path}; wait for it to end, or name another folder with --out"
            ) from error
        raise StudyError(
            f"cannot write to the output folder {path.parent}: {error}; name another one with --out"
        ) from error
    return lock


def read_only(path: Path) -> str:
    """Address a file without writing to it; in a folder that cannot be written SQLite may not even make its index."""
    frozen = "" if os.access(path.parent, os.W_OK) else "&immutable=1"
    return f"{path.absolute().as_uri()}?mode=ro{frozen}"


def check_file(path: Path) -> None:
    """Refuse a file that is damaged or not ours, without touching it."""
    advice = "it is left untouched; move it away, or name another folder with --out"
    try:
        connection = sqlite3.connect(read_only(path), uri=True)
        try:
            verdict = connection.execute("PRAGMA integrity_check(1)").fetchone()[0]
            tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
            application, schema = (
                connection.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")
            )
        finally:
            connection.close()
    except sqlite3.DatabaseError as error:
        raise StudyError(f"results file {path} is damaged or not a results file ({error}); {advice}") from error
    if verdict != "ok":
        raise StudyError(f"results file {path} is damaged ({verdict.splitlines()[-1]}); {advice}")
    if tables and application != APPLICATION_ID:
        raise StudyError(f"{path} is an SQLite file of another program; {advice}")
    if schema > SCHEMA_VERSION:
        raise StudyError(
            f"results file {path} has layout {schema}, this version reads up to {SCHEMA_VERSION}; {advice}"
        )


@contextmanager
def explained(path: Path) -> Iterator[None]:
    """Turn what SQLite says into one sentence."""
    try:
        yield
    except sqlite3.Error as error:
        raise StudyError(
            f"cannot use the results file {path}: {error}; results stored before are safe: mend the cause and run again"
        ) from error
