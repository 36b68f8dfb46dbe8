"""XML files of robots, read without entities, and xacro expanded where its package is installed."""

from __future__ import annotations

import subprocess
import sys
import xml.etree.ElementTree as ET  # files with a DOCTYPE, the way in for entity attacks, are refused
from importlib.util import find_spec
from pathlib import Path

from study.errors import StudyError
from study.io.text import read_text

MOST_BYTES = 32 * 2**20
"""Largest file that is read; its elements take fifteen times as much memory."""

DEEPEST = 200
"""Levels of elements in one another that are read."""

PATIENCE = 20.0
"""Seconds after which xacro is ended: its macros may call themselves, and its sums be of any size."""

EXPANDING = """\
import sys, xacro
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30))
except ImportError:
    pass
text = xacro.process_file(sys.argv[1]).toxml()
sys.stdout.buffer.write(text.encode("ascii", "xmlcharrefreplace"))
"""
"""Program of the process in which xacro works, with 1 GB of memory where the system can limit it."""


def read_xml(path: Path) -> ET.Element:
    """Read the outermost element of an XML file.

    Raises
    ------
    StudyError
        If the file cannot be read, is not XML, declares a DOCTYPE, is nested too deeply, or holds xacro macros while the
        package xacro is missing or fails.
    """
    text, where = read_text(path, MOST_BYTES), f"file {path.name!r}"
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise StudyError(f"{where} declares a DOCTYPE; remove it, URDF needs none")
    root = _root(text, where)
    if path.suffix == ".xacro" or any("xacro" in str(element.tag) for element in root.iter()):
        return _root(_expanded(path, where), where)
    return root


def _root(text: str, where: str) -> ET.Element:
    try:
        root = ET.fromstring(text.encode("utf-8") if text.lstrip().startswith("<?xml") else text)  # noqa: S314
    except (ET.ParseError, LookupError, ValueError) as error:
        raise StudyError(f"{where} is not valid XML: {error}") from None
    level, depth = [root], 0
    while level:
        level, depth = [inner for element in level for inner in element], depth + 1
        if depth > DEEPEST:
            raise StudyError(f"{where} is nested too deeply, more than {DEEPEST} levels")
    return root


def _expanded(path: Path, where: str) -> str:
    first = f"or expand it first with: xacro {path.name} > robot.urdf"
    if find_spec("xacro") is None:
        raise StudyError(f"{where} holds xacro macros; pip install xacro, {first}")
    command = [sys.executable, "-c", EXPANDING, str(path)]
    try:
        ended = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)  # noqa: S603
    except subprocess.TimeoutExpired:
        raise StudyError(f"{where}: xacro has not expanded it after {PATIENCE:g} s; mend that, {first}") from None
    if ended.returncode:
        said = " ".join((ended.stderr.strip().splitlines() or ["it ended without a word"])[-1].split())
        raise StudyError(f"{where}: xacro cannot expand it: {said}; mend that, {first}")
    return ended.stdout
