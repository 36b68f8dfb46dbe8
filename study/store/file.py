"""The results file itself: who may open it, its lock, and whether it is fit to be used."""

from __future__ import annotations

import os
import sqlite3
import stat
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from study.errors import StudyError
from study.store.schema import APPLICATION_ID, SCHEMA_VERSION, WRONG_KIND, lay_out, strangers

CHECKED_WHOLE = 256 * 2**20
"""Bytes up to which a file is read through whenever it is opened; of a larger one `study store verify` does that."""

ADVICE = "it is left untouched; move it away, or name another folder with --out"


@contextmanager
def writing(path: Path) -> Iterator[sqlite3.Connection]:
    """Be the one writer of a results file, which is made if need be.

    Raises
    ------
    StudyError
        If the file is damaged, of another program or layout, cannot be written, or another run is writing to it.
    """
    make_folder(path.parent)
    with _locked(path):
        if exists(path) and path.stat().st_size:
            check_file(path)
        with explained(path):
            connection = _connected(str(path))
        with closing(connection):
            with explained(path):
                _prepare(connection)
            yield connection


@contextmanager
def reading(path: Path, *, whole: bool | None = None) -> Iterator[sqlite3.Connection]:
    """Read a results file, `whole` as for `check_file`.

    Raises
    ------
    StudyError
        If there is none, or it is damaged, or of another program or layout.
    """
    if not exists(path):
        raise StudyError(f"there are no results at {path}; run `study run` first, or name its folder with --out")
    if check_file(path, whole=whole) == 0:
        raise StudyError(f"there are no results in {path}, which is empty; run `study run` first")
    with explained(path), closing(_connected(_read_only(path), uri=True)) as connection:
        yield connection


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


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    """Hold a lock beside the file that the operating system frees when the process ends, however it ends."""
    place = path.with_name(path.name + ".lock")
    try:
        lock = sqlite3.connect(place, timeout=0, isolation_level=None)
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except BaseException:
            lock.close()
            raise
    except sqlite3.Error as error:
        if "locked" in str(error):
            raise StudyError(
                f"another run is writing to {path}; wait for it to end, or name another folder with --out"
            ) from error
        raise StudyError(
            f"cannot write to the output folder {path.parent}: {error} ({place.name}); name another one with --out"
        ) from error
    with closing(lock):
        yield


def exists(path: Path) -> bool:
    """Tell whether there is a file; what is neither a file nor nothing is refused, for reading it could take for ever."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return False
    except OSError as error:
        raise StudyError(f"cannot use the results file {path}: {error.strerror}; name another folder") from error
    if not stat.S_ISREG(mode):
        raise StudyError(f"{path} is not a regular file; {ADVICE}")
    return True


def _connected(target: str, *, uri: bool = False) -> sqlite3.Connection:
    """Open a file in which no function hides behind a definition and no cell overlaps another."""
    connection = sqlite3.connect(target, uri=uri, isolation_level=None)
    try:
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.execute("PRAGMA cell_size_check = ON")
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def _prepare(connection: sqlite3.Connection) -> None:
    """Lay a file out for writing, or find out before any work is done that it cannot be written."""
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")  # a finished job outlives a power cut too
    connection.execute("PRAGMA cache_size = -65536")  # KiB; holds the index of keys of a sweep
    lay_out(connection)
    connection.execute("DELETE FROM notes WHERE 0")


def _read_only(path: Path) -> str:
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
        checksums of its own, which are compared whenever the row is read.

    Returns
    -------
    int
        The file's layout; 0 for an empty file.
    """
    whole = path.stat().st_size <= CHECKED_WHOLE if whole is None else whole
    try:
        with closing(_connected(_read_only(path), uri=True)) as connection:
            tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
            application, layout = (
                connection.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")
            )
            if tables:
                _check_ours(path, application, layout, connection)
            verdict = connection.execute("PRAGMA integrity_check(1)").fetchone()[0] if whole else "ok"
            if whole and tables and verdict == "ok" and (odd := connection.execute(WRONG_KIND).fetchone()):
                verdict = f"row {odd[0]} holds values of another kind"
    except (sqlite3.Error, UnicodeDecodeError) as error:
        raise StudyError(f"results file {path} is damaged or not a results file ({error}); {ADVICE}") from error
    if verdict != "ok":
        raise StudyError(f"results file {path} is damaged ({verdict.splitlines()[-1]}); {ADVICE}")
    return SCHEMA_VERSION if tables else 0


def _check_ours(path: Path, application: int, layout: int, connection: sqlite3.Connection) -> None:
    if application != APPLICATION_ID:
        raise StudyError(f"{path} is an SQLite file of another program; {ADVICE}")
    if layout in (1, 2):
        raise StudyError(
            f"results file {path} has layout {layout} of an earlier version, whose results would all be run again; {ADVICE}"
        )
    if layout != SCHEMA_VERSION:
        raise StudyError(
            f"results file {path} has layout {layout}, this version reads layout {SCHEMA_VERSION}; {ADVICE}"
        )
    if odd := strangers(connection):
        raise StudyError(f"results file {path} has other tables than this program makes ({odd[0][:40]!r}); {ADVICE}")


@contextmanager
def explained(path: Path) -> Iterator[None]:
    """Turn what SQLite says into one sentence."""
    try:
        yield
    except (sqlite3.Error, UnicodeDecodeError) as error:
        if not os.path.lexists(path):
            raise StudyError(f"results file {path} was deleted or replaced while it was in use; run again") from error
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
