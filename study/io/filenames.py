"""Names of files for people's own names of cases and methods."""

from __future__ import annotations

import re
from hashlib import sha256

LONGEST = 80
"""Characters of a name that are kept; file systems allow 255 bytes, and endings come after."""

_PLAIN = re.compile(rf"[a-z0-9_](?:[a-z0-9_.-]{{0,{LONGEST - 2}}}[a-z0-9_])?")
_MARKED = re.compile(r"-[0-9a-f]{8}$")
_RESERVED = re.compile(r"(?:index|all|con|prn|aux|nul|com\d|lpt\d)(?:\.|$)")  # our own pages, and devices on Windows


def file_stem(name: str) -> str:
    """Give a name its file name without ending: different names have different files, on every file system.

    A name of plain lower-case letters, digits, dots, dashes and underscores stays as it is. Of any other one such
    characters are kept, and a mark of eight digits tells it from all that look like it or differ in case alone.
    """
    if _PLAIN.fullmatch(name) and not _MARKED.search(name) and not _RESERVED.match(name):
        return name
    kept = re.sub(r"[^A-Za-z0-9_.-]+", "-", name).strip(".-")[:LONGEST].rstrip(".-")
    return f"{kept or 'case'}-{sha256(name.encode(errors='surrogatepass')).hexdigest()[:8]}"
