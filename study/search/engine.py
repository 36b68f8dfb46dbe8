"""Which code moves the candidates: NumPy, or numba's compiled twin for a long run. Both give the same bits.

So a result does not tell which of the two it was, and nothing records it; see `study.curves.engine` for the choice.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from study.curves.engine import twins

if TYPE_CHECKING:
    from study.search.loop import Search


def with_engine(search: Search[Any], evaluations: int | None = None) -> Search[Any]:
    """Give a search the compiled steps of the engine chosen for a run, if it has any.

    Parameters
    ----------
    search : Search
    evaluations : int, optional
        Budget of the run; without one the run counts as long.
    """
    compiled = twins(_compiled, evaluations)
    return search if compiled is None else compiled.twin(search)


def _compiled() -> ModuleType:
    """Import them by name, so that they do not count as code of every search, which they cannot change a bit of."""
    return import_module("study.search.compiled")
