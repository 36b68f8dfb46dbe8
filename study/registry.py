"""Which planners are installed: everything that registers itself under the entry-point group `study.planners`.

An entry point names an object that implements `study.planning.Planner`, or a class or function that makes one when
called without arguments. Ours and a stranger's planners are found in the same way.
"""

from __future__ import annotations

import sys
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import cast

from study.code_digest import code_digest
from study.errors import StudyError, unknown
from study.planning import Planner, undescribed

GROUP = "study.planners"


def planner_names() -> tuple[str, ...]:
    """List the names of all installed planners, in alphabetical order."""
    return tuple(sorted(_entries(tuple(sys.path))))


def planner_named(name: str) -> Planner:
    """Load a planner by its registered name.

    Raises
    ------
    StudyError
        If no such planner is installed, a package that it needs is missing, or it is not a planner.
    """
    return _load(name, tuple(sys.path))


def planner_about(name: str) -> str:
    """Line with which a planner describes itself, or the reason why it cannot be loaded."""
    try:
        return planner_named(name).about
    except StudyError as error:
        return str(error)


def unavailable_planners() -> dict[str, str]:
    """Say of every installed planner that cannot be loaded why not."""
    reasons = {}
    for name in planner_names():
        try:
            planner_named(name)
        except StudyError as error:
            reasons[name] = str(error)
    return reasons


def planner_version(name: str) -> str:
    """Name and version of the distribution that brings a planner, such as `time-optimal-study 0.1.0`."""
    found = _entry(name, tuple(sys.path)).dist
    return f"{found.name} {found.version}" if found else "unknown"


def planner_code(name: str) -> str:
    """Version of a planner and checksum of its sources: a change of either makes every result of it another one."""
    return f"{planner_version(name)}; code {code_digest(_entry(name, tuple(sys.path)).module)[:16]}"


@cache
def _entries(path: tuple[str, ...]) -> dict[str, EntryPoint]:
    """Entry points by name; the search path is part of the key, so a changed path is looked through again."""
    return {entry.name: entry for entry in reversed(list(entry_points(group=GROUP)))}


def _entry(name: str, path: tuple[str, ...]) -> EntryPoint:
    known = _entries(path)
    if name not in known:
        raise unknown("planner", name, known)
    return known[name]


@cache
def _load(name: str, path: tuple[str, ...]) -> Planner:
    entry = _entry(name, path)
    try:
        found = entry.load()
        planner = found() if isinstance(found, type) or (callable(found) and not hasattr(found, "plan")) else found
    except ModuleNotFoundError as error:
        raise StudyError(
            f"planner {name!r} needs the Python package {error.name!r}, which is not installed; install it with pip"
        ) from error
    except Exception as error:  # a stranger's module may raise anything on import
        raise StudyError(
            f"planner {name!r} could not be loaded from {entry.value!r}: {type(error).__name__}: {error}"
        ) from error
    if reason := undescribed(planner):
        raise StudyError(f"planner {name!r} ({entry.value}) is not a planner: {reason}")
    return cast(Planner, planner)
