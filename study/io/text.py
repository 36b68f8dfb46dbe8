"""Text files as people send them: with or without byte order mark, with any line ends."""

from __future__ import annotations

from pathlib import Path

from study.errors import StudyError
from study.files import MOST_BYTES, read_file

MARKS = ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
"""Byte-order marks of files that are not UTF-8, as spreadsheet programs write them."""


def read_text(path: Path, most: int = MOST_BYTES) -> str:
    """Read a text file of at most so many bytes in UTF-8, or in UTF-16 if it says so.

    Raises
    ------
    StudyError
        If the file is missing, no regular file, too large, not readable or not text.
    """
    raw = read_file(path, most)
    encoding = next((name for mark, name in MARKS if raw.startswith(mark)), "utf-8-sig")
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError:
        raise StudyError(f"file {str(path)!r} cannot be read as text in UTF-8; save it as UTF-8") from None
    if "\0" in text:
        raise StudyError(f"file {str(path)!r} cannot be read as text: it holds zero bytes")
    return text
