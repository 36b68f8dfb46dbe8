"""The one door for files: only regular files of a stated size are read, and an output replaces the old one whole."""

from __future__ import annotations

import csv
import io
import os
import re
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from study.errors import StudyError, short

MOST_BYTES = 256 * 2**20
"""Largest file that is read."""

_FORMULA = re.compile(r"[=+\-@\t\r]")
_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|inf|nan)")


def named(path: object) -> Path:
    """Take the path of a file as people give it.

    Raises
    ------
    StudyError
        If it is neither a text nor a `pathlib.Path`.
    """
    if not isinstance(path, str | Path):
        raise StudyError(f"a file is named by a text or a pathlib.Path, got {type(path).__name__} {short(path)}")
    return Path(path)


def read_file(path: Path, most: int = MOST_BYTES) -> bytes:
    """Read a regular file whole.

    Parameters
    ----------
    path : Path
    most : int, bytes
        Largest size that is read.

    Raises
    ------
    StudyError
        If the file is missing, no regular file, too large or not readable.
    """
    where = f"file {str(path)!r}"
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))  # or a pipe without a writer would block
        with open(handle, "rb") as file:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                raise StudyError(f"{where} cannot be read: it is a pipe or a device, no regular file")
            content = file.read(most + 1)
    except FileNotFoundError:
        raise StudyError(f"{where} does not exist; check the path") from None
    except (OSError, ValueError) as error:
        raise StudyError(f"{where} cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(content) > most:
        raise StudyError(f"{where} cannot be read: it is larger than {most / 2**20:g} MB")
    return content


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give the path of a new file beside an output, and put it in the output's place once it is whole and on the disk.

    Whatever fails, the old file stays as it is and the new one goes.

    Raises
    ------
    StudyError
        If the file cannot be written.
    """
    target = Path(os.path.realpath(path))  # a link stays a link
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    begun = False
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and not target.is_file():
            raise StudyError(f"cannot write {str(path)!r}: it is no regular file; choose another place")
        begun = True
        yield part
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        if target.exists():
            shutil.copymode(target, part)
        os.replace(part, target)
    except (OSError, ValueError) as error:
        if begun and not isinstance(error, OSError):  # a mistake of what is written, not of where
            raise
        reason = getattr(error, "strerror", None) or error
        raise StudyError(f"cannot write {str(path)!r}: {reason}; choose another place") from None
    finally:
        with suppress(OSError, ValueError):
            part.unlink(missing_ok=True)


def write_file(path: Path, content: str | bytes, overwrite: bool = True) -> Path:
    """Write a file and the folders above it, or leave everything as it is.

    Parameters
    ----------
    path : Path
    content : str or bytes
        Text is written in UTF-8; half a character, which no text may hold, becomes a question mark.
    overwrite : bool

    Returns
    -------
    Path

    Raises
    ------
    StudyError
        If the file exists and must not be overwritten, or cannot be written.
    """
    if not overwrite and os.path.lexists(path):
        raise StudyError(f"file {str(path)!r} exists already; name another one or move it away")
    with replacing(path) as part:
        part.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8", errors="replace"))
    return path


def csv_text(rows: Iterable[Iterable[object]], quoted: str = "") -> str:
    """Write rows as CSV; text that a spreadsheet would take for a formula begins with an apostrophe.

    The words of a row in which one of the characters `quoted` stands are put between quotation marks.
    """
    text = io.StringIO()
    usual = csv.writer(text, lineterminator="\n")
    careful = csv.writer(text, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
    for row in rows:
        cells = [harmless(cell) for cell in row]
        special = bool(quoted) and any(mark in str(cell) for cell in cells for mark in quoted)
        (careful if special else usual).writerow(cells)
    return text.getvalue()


def harmless(cell: object) -> object:
    """Put an apostrophe before a text that a spreadsheet would take for a formula."""
    if not isinstance(cell, str) or not _FORMULA.match(cell) or _NUMBER.fullmatch(cell):
        return cell
    return f"'{cell}"


def as_written(cell: str) -> str:
    """Take the apostrophe off that `csv_text` put before a text."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell, 1) else cell
