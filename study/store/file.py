"""The results file itself: its layout, its lock, and whether it is fit to be used."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from study.errors import StudyError
from study.store.schema import APPLICATION_ID, SCHEMA_VERSION

CHECKED_WHOLE = 256 * 2**20
"""Bytes up to which a file is read through whenever it is opened; of a larger one `study store verify` does that."""


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


def check_file(path: Path, *, whole: bool | None = None) -> int:
    """Refuse a file that is damaged or not ours, without touching it.

    Parameters
    ----------
    path : Path
    whole : bool, optional
        Whether to look at every page; by default only where the file is at most `CHECKED_WHOLE` bytes. Every row carries
        a checksum of its own, which is compared whenever the row is read.

    Returns
    -------
    int
        The file's layout; 0 for an empty file.
    """
    advice = "it is left untouched; move it away, or name another folder with --out"
    whole = path.stat().st_size <= CHECKED_WHOLE if whole is None else whole
    try:
        connection = sqlite3.connect(read_only(path), uri=True)
        try:
            verdict = connection.execute("PRAGMA integrity_check(1)").fetchone()[0] if whole else "ok"
            tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
            application, layout = (
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
    if layout > SCHEMA_VERSION:
        raise StudyError(
            f"results file {path} has layout {layout}, this version reads up to {SCHEMA_VERSION}; {advice}"
        )
    return int(layout)


@contextmanager
def explained(path: Path) -> Iterator[None]:
    """Turn what SQLite says into one sentence."""
    try:
        yield
    except sqlite3.Error as error:
        raise StudyError(
            f"cannot use the results file {path}: {error}; results stored before are safe: mend the cause and run again"
        ) from error


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """Write all of what the block writes, or nothing of it."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise
