"""Documents in YAML or JSON, read so that nothing in them is lost, doubled or grows."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from study.errors import StudyError
from study.io.text import read_text

MOST_STANDING = 1_000_000
"""Values that a YAML document may hold, and that all its aliases may stand for together; a million take half a gigabyte."""

MOST_BITS = 14_000
"""Size of a whole number that is read: Python writes out none of more than 4,300 digits, so that no sentence could name it."""

DEEPEST = 100
"""Levels of lists and mappings in one another that are read."""

LINES = re.compile(r"\s*\{.*\}[ \t]*\r?\n\s*\{.*\}\s*(\n|$)")
"""A document that is whole at the end of the first line, and another one after it."""


def parsed(path: Path) -> Any:
    """Parse a YAML or JSON file that holds one document.

    Raises
    ------
    StudyError
        As `documents`, or if there are several.
    """
    contents = documents(path)
    if len(contents) > 1:
        raise StudyError(f"file {str(path)!r} holds {len(contents)} documents, separated by '---'; expected one")
    return contents[0]


def documents(path: Path) -> list[Any]:
    """Parse a YAML file, in which empty documents do not count, a JSON file, or one of JSON lines.

    Parameters
    ----------
    path : Path

    Returns
    -------
    list of object
        At least one; None where the file is empty. Not to be changed: the next reader of the same YAML text gets the same objects.

    Raises
    ------
    StudyError
        If the file is neither, a key stands twice in a mapping, aliases of YAML stand for too much, lists lie too deep in one another, or the
        package that reads YAML is missing.
    """
    text, where, ending = read_text(path), f"file {str(path)!r}", path.suffix.lower()
    if ending in (".jsonl", ".ndjson") or (ending == ".json" and LINES.match(text)):
        return [
            _from_json(line, f"{where}, line {n}") for n, line in enumerate(text.splitlines(), 1) if line.strip()
        ] or [None]
    return [_from_json(text, where)] if ending == ".json" else list(_from_yaml(text, where))


def _from_json(text: str, where: str) -> Any:
    try:
        content = json.loads(text, object_pairs_hook=_unique, parse_constant=_not_finite)
    except json.JSONDecodeError as error:
        raise StudyError(f"{where} is not valid JSON at line {error.lineno}: {error.msg}") from None
    except RecursionError:
        raise StudyError(f"{where} is not valid JSON: nested too deeply") from None
    except ValueError as error:
        raise StudyError(f"{where} cannot be read: {error}") from None
    if _depth(content) > DEEPEST:
        raise StudyError(f"{where} cannot be read: nested too deeply, more than {DEEPEST} levels")
    return content


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) < len(pairs):
        names = [name for name, _ in pairs]
        double = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"key {double[:60]!r} stands twice in one mapping; remove one")
    return result


def _not_finite(text: str) -> float:
    raise ValueError(f"{text} is no number; leave the field out, or write null")


def _depth(content: Any) -> int:
    level, depth = [content], 0
    while level := [item for item in level if isinstance(item, dict | list)]:
        depth += 1
        level = [inner for item in level for inner in (item.values() if isinstance(item, dict) else item)]
    return depth


@lru_cache(maxsize=1)  # a command asks of which kind its file is before it reads the file
def _from_yaml(text: str, where: str) -> list[Any]:
    try:
        import yaml
    except ModuleNotFoundError:
        raise StudyError(f"{where}: reading YAML needs the package 'pyyaml'; pip install pyyaml, or use JSON") from None
    loader = _loader()
    try:
        _check(yaml.parse(text, Loader=loader))
        contents = list(_contents(loader(text)))
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" at line {mark.line + 1}" if mark else ""
        reason = getattr(error, "problem", None) or "it could not be parsed"
        raise StudyError(f"{where} is not valid YAML{line}: {reason}") from None
    except (RecursionError, ValueError, OverflowError, AttributeError, TypeError) as error:
        raise StudyError(f"{where} cannot be read: {error}") from None
    return [content for content in contents if content is not None] or [None]


def _contents(loader: Any) -> Iterator[Any]:
    while loader.check_data():
        yield loader.get_data()


def _check(events: Iterator[Any]) -> None:
    """Refuse deep nesting, and aliases that stand for more than any memory holds, before anything is built."""
    count, standing, sizes, open_parts = 0, 0, dict[str, int](), list[tuple[str | None, int]]()
    for event in events:
        kind, anchor = type(event).__name__, getattr(event, "anchor", None)
        if kind == "AliasEvent":
            standing += sizes.get(anchor or "", MOST_STANDING + 1)  # an alias inside its own anchor has no end
            count += sizes.get(anchor or "", 0)
        elif kind.endswith("StartEvent") and not kind.startswith(("Stream", "Document")):
            open_parts.append((anchor, count))
        elif kind in ("MappingEndEvent", "SequenceEndEvent"):
            name, before = open_parts.pop()
            sizes |= {name: count - before + 1} if name else {}
        elif kind == "ScalarEvent":
            sizes |= {anchor: 1} if anchor else {}
        count += 1
        if len(open_parts) > DEEPEST:
            raise ValueError(f"nested too deeply, more than {DEEPEST} levels")
        if standing > MOST_STANDING:
            line = event.start_mark.line + 1
            raise ValueError(f"the alias at line {line} stands for too many values; write them out")
        if count > MOST_STANDING:
            raise ValueError(f"it holds more than {MOST_STANDING:,} values; JSON and CSV hold more, in less memory")


@cache
def _loader() -> Any:
    """Safe loader, in C where it is built in, that refuses doubled keys and knows the angles of ROS files."""
    import yaml

    class Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
        def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
            mapping: dict[Any, Any] = super().construct_mapping(node, deep)
            if len(mapping) < len(node.value):
                names = [str(key.value)[:60] for key, _ in node.value]
                double = next((name for name in names if names.count(name) > 1), names[-1])
                raise ValueError(
                    f"key {double!r} stands twice in the mapping at line {node.start_mark.line + 1}; remove one"
                )
            return mapping

        def construct_object(self, node: Any, deep: bool = False) -> Any:
            try:
                return super().construct_object(node, deep)
            except (ValueError, LookupError, AttributeError, TypeError, OverflowError):
                if not isinstance(node, yaml.ScalarNode):
                    raise
                kind = node.tag.rpartition(":")[2].strip("!")
                raise yaml.constructor.ConstructorError(
                    None, None, f"{node.value[:40]!r} cannot be read as {kind}", node.start_mark
                ) from None

    def whole_number(loader: Any, node: Any) -> int:
        value: int = loader.construct_yaml_int(node)
        if value.bit_length() > MOST_BITS:
            reason = "a whole number has thousands of digits; write one that a float can hold"
            raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark)
        return value

    Loader.add_constructor("tag:yaml.org,2002:int", whole_number)
    Loader.add_constructor("!degrees", lambda loader, node: math.radians(float(loader.construct_scalar(node))))
    Loader.add_constructor("!radians", lambda loader, node: float(loader.construct_scalar(node)))
    return Loader
