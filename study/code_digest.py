"""Checksum of the code behind a result: of the source files that can change the answer of a planner.

The files are the planner's own module and whatever it imports, directly or not, from the same package, this one or the
baselines, and the judge with what it imports. The imports are read from the text and nothing is run, so one edited file
invalidates the planners that use it and no others. Libraries such as NumPy or IPOPT are outside it.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

ALWAYS = ("study.judge",)
OURS = ("study", "baselines")
EXEMPT = frozenset({"study.search.compiled"})
"""Modules that cannot change a result: compiled variants with the same bits as the NumPy code that they stand for."""


@cache
def code_digest(module: str) -> str:
    """Checksum of the sources behind a module, the same wherever they are installed.

    Parameters
    ----------
    module : str
        Where a planner is defined, such as `baselines.path_timing.toppra`.
    """
    packages = frozenset({*OURS, module.partition(".")[0]})
    waiting, seen = [module, *ALWAYS], set[str]()
    while waiting:
        name = waiting.pop()
        if name in seen | EXEMPT or name.partition(".")[0] not in packages or _source(name) is None:
            continue
        seen.add(name)
        waiting += _imports(name)
        if (package := name.rpartition(".")[0]) not in OURS:  # whose files only hand names on
            waiting.append(package)  # a module runs its package's file first
    digest = hashlib.sha256()
    for name in sorted(seen):
        digest.update(f"{name}\n{_file_digest(name)}\n".encode())
    return digest.hexdigest()


def has_source(module: str) -> bool:
    """Tell whether a module is installed as Python source; one of this project that is not there has been removed."""
    return module.partition(".")[0] in OURS or _source(module) is not None


@cache
def _source(module: str) -> Path | None:
    """File of a module, found without importing anything; None for what is not a module of Python source."""
    top, *rest = module.split(".")
    try:
        spec = find_spec(top)
    except (ImportError, ValueError):  # such as __main__
        return None
    if spec is None or spec.origin is None or not spec.origin.endswith(".py"):
        return None
    first = Path(spec.origin)
    if not rest:
        return first
    place = first.parent.joinpath(*rest)
    files = (place / "__init__.py", place.with_name(place.name + ".py"))
    return next((file for file in files if first.name == "__init__.py" and file.is_file()), None)


@cache
def _text(module: str) -> bytes:
    path = _source(module)
    return b"" if path is None else path.read_bytes().replace(b"\r\n", b"\n")


@cache
def _file_digest(module: str) -> str:
    return hashlib.sha256(_text(module)).hexdigest()


@cache
def _imports(module: str) -> tuple[str, ...]:
    """Names that a module imports anywhere in its text; `from a import b` may mean a module a.b."""
    return tuple(name for node in ast.walk(ast.parse(_text(module))) for name in _named(module, node))


def _named(module: str, node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        base = ".".join(filter(None, (_package(module, node.level), node.module)))
        parts = [f"{base}.{alias.name}" for alias in node.names]
        yield from parts
        if not all(map(_source, parts)):  # a part that is no module stands in the base's own file
            yield base


def _package(module: str, level: int) -> str:
    """Package that a relative import starts from; nothing for an absolute one."""
    if level == 0:
        return ""
    path = _source(module)
    inside = module if path is not None and path.name == "__init__.py" else module.rpartition(".")[0]
    return inside.rsplit(".", level - 1)[0]
