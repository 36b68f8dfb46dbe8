"""Code behind a stored outcome: the planners and modules that it starts from, each with the checksum of its sources."""

from __future__ import annotations

from functools import lru_cache

from study.code_digest import code_digest, has_source
from study.registry import method_names, planner_code
from study.store.codec import canonical
from study.store.content import parsed

PLANNER = "planner "
"""Begins the name of a planner among the names of modules."""


@lru_cache(maxsize=4096)
def code_behind(planners: tuple[str, ...] = (), modules: tuple[str, ...] = ()) -> str:
    """Name the code that planners and modules consist of, with everything that they import.

    Parameters
    ----------
    planners : tuple of str
        Registry names.
    modules : tuple of str
        Full names, such as `study.search.woa`.

    Returns
    -------
    str
        JSON: a checksum for every planner and module.

    Raises
    ------
    StudyError
        If a planner is not installed.
    """
    codes = {PLANNER + name: planner_code(name) for name in planners}
    return canonical(codes | {name: code_digest(name)[:16] for name in modules})


def is_stale(code: str) -> bool:
    """Tell whether installed code differs from what `code_behind` named; what is not installed or read does not differ."""
    try:
        named = dict(parsed(code))
    except (ValueError, TypeError):
        return False
    return any(_present(name) not in (None, stored) for name, stored in named.items())


def _present(name: str) -> str | None:
    if name.startswith(PLANNER):
        planner = name.removeprefix(PLANNER)
        return planner_code(planner) if planner in method_names() else None
    return code_digest(name)[:16] if has_source(name) else None
