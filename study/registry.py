"""Installed planners and bounds: everything registered under the entry-point groups `study.planners` and `study.bounds`.

An entry point names an object that implements `study.planning.Planner` or `study.bounds.Bound`, or a class or function that
makes one when called without arguments. Ours and a stranger's are found in the same way. A method is either of the two.
Planners under `study.peers`, other packages' own, are the same but for one thing: they run only where they are asked for.
"""

from __future__ import annotations

import sys
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import cast

from study.bounds import Method, undescribed_bound
from study.code_digest import OURS, code_digest
from study.errors import StudyError, unforeseen, unknown
from study.planning import Planner, undescribed

PEERS = "study.peers"
KINDS = {"planner": ("study.planners", PEERS), "bound": ("study.bounds",)}
"""Entry-point groups of every kind of method."""


def planner_names() -> tuple[str, ...]:
    """List the names of all installed planners, in alphabetical order."""
    return tuple(sorted(_entries("planner", tuple(sys.path))))


def peer_names() -> tuple[str, ...]:
    """List the names of all installed planners that run only where they are asked for, in alphabetical order."""
    return tuple(name for name in planner_names() if _entries("planner", tuple(sys.path))[name].group == PEERS)


def bound_names() -> tuple[str, ...]:
    """List the names of all installed bounds, in alphabetical order."""
    return tuple(sorted(_entries("bound", tuple(sys.path))))


def method_names() -> tuple[str, ...]:
    """List the names of all installed planners and bounds, in alphabetical order."""
    return tuple(sorted({*planner_names(), *bound_names()}))


def planner_named(name: str) -> Planner:
    """Load a planner by its registered name.

    Raises
    ------
    StudyError
        If no such planner is installed, a package that it needs is missing, or it is not a planner.
    """
    return cast(Planner, _load("planner", name, tuple(sys.path)))


def method_named(name: str) -> Method:
    """Load a planner or a bound by its registered name.

    Raises
    ------
    StudyError
        If neither is installed under this name, a package is missing, or the object is neither.
    """
    if name not in method_names():
        raise unknown("planner", name, method_names())
    return cast(Method, _load(_kind(name), name, tuple(sys.path)))


def planner_about(name: str) -> str:
    """Line with which a planner describes itself, or the reason why it cannot be loaded."""
    try:
        return planner_named(name).about
    except StudyError as error:
        return str(error)


def unavailable_planners() -> dict[str, str]:
    """Say of every installed planner and bound that cannot be loaded why not."""
    reasons = {}
    for name in method_names():
        try:
            method_named(name)
        except StudyError as error:
            reasons[name] = str(error)
    return reasons


def planner_version(name: str) -> str:
    """Name and version of the distribution that brings a planner or bound, such as `time-optimal-study 0.1.0`."""
    distribution = _method_entry(name).dist
    return f"{distribution.name} {distribution.version}" if distribution else "unknown"


def planner_code(name: str) -> str:
    """Version of a planner or bound and checksum of its sources: a change of either makes other results of all."""
    return f"{planner_version(name)}; code {code_digest(_method_entry(name).module)[:16]}"


def is_foreign(name: str) -> bool:
    """Tell whether another package brings a planner or bound; False for a name that is not installed."""
    return name in method_names() and _method_entry(name).module.partition(".")[0] not in OURS


def _kind(name: str) -> str:
    return "bound" if name in bound_names() else "planner"


def _method_entry(name: str) -> EntryPoint:
    return _entry(_kind(name), name, tuple(sys.path))


@cache
def _entries(kind: str, path: tuple[str, ...]) -> dict[str, EntryPoint]:
    """Entry points by name; the search path is part of the key, so a changed path is looked through again."""
    several = [entry for group in KINDS[kind] for entry in entry_points(group=group)]
    return {entry.name: entry for entry in reversed(several)}


def _entry(kind: str, name: str, path: tuple[str, ...]) -> EntryPoint:
    known = _entries(kind, path)
    if name not in known:
        raise unknown(kind, name, known)
    return known[name]


@cache
def _load(kind: str, name: str, path: tuple[str, ...]) -> object:
    entry = _entry(kind, name, path)
    way = "plan" if kind == "planner" else "bound"
    try:
        loaded = entry.load()
        method = loaded() if isinstance(loaded, type) or (callable(loaded) and not hasattr(loaded, way)) else loaded
    except ModuleNotFoundError as error:
        raise StudyError(
            f"{kind} {name!r} needs the Python package {error.name!r}, which is not installed; {_remedy(entry)}"
        ) from error
    except Exception as error:  # a stranger's module may raise anything on import
        raise StudyError(f"{kind} {name!r} could not be loaded from {entry.value!r}: {unforeseen(error)}") from error
    if reason := undescribed(method) if kind == "planner" else undescribed_bound(method):
        raise StudyError(f"{kind} {name!r} ({entry.value}) is not a {kind}: {reason}")
    return method


def _remedy(entry: EntryPoint) -> str:
    """Way to install the package that a method needs: the extra that its entry point names."""
    if not entry.extras or entry.dist is None:
        return "install it with pip"
    return f"install it with: pip install '{entry.dist.name}[{','.join(entry.extras)}]'"
