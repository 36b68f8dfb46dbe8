"""XML files of robots, read without entities, and xacro expanded where its package is installed."""

from __future__ import annotations

import xml.etree.ElementTree as ET  # files with a DOCTYPE, the way in for entity attacks, are refused
from pathlib import Path

from study.errors import StudyError
from study.io.text import read_text

DEEPEST = 200
"""Levels of elements in one another that are read."""


def read_xml(path: Path) -> ET.Element:
    """Read the outermost element of an XML file.

    Raises
    ------
    StudyError
        If the file cannot be read, is not XML, declares a DOCTYPE, is nested too deeply, or holds xacro macros while the
        package xacro is missing or fails.
    """
    text, where = read_text(path), f"file {path.name!r}"
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
    try:
        import xacro
    except ModuleNotFoundError:
        raise StudyError(f"{where} holds xacro macros; pip install xacro, {first}") from None
    try:
        return str(xacro.process_file(str(path)).toxml())
    except Exception as error:  # xacro names its errors by the macro at work
        said = " ".join(str(error).split())
        raise StudyError(f"{where}: xacro cannot expand it: {said}; mend that, {first}") from None
