"""Choice of the engine that runs populations: NumPy, always there, or numba, with the extra `fast`.

The choice depends on the run's own budget and on the installed packages, never on how far a run has come or on the
machine's load, so that a result is the same whoever computes it. Compiled curves agree with NumPy to rounding only: a
search may turn at another last bit, and so results record the engine. Compiled searches give NumPy's own bits.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from study.errors import unknown

VARIABLE = "STUDY_ENGINE"
AUTO, NUMPY, NUMBA = "auto", "numpy", "numba"
CHOICES = (AUTO, NUMPY, NUMBA)
WORTHWHILE = 50_000
"""Evaluations of one run from which `auto` compiles: a worker pays about a second once to import numba and load its
code, as long as NumPy takes for 10^5 evaluations of a spline; the quick study has 2000 for each run."""


@cache
def installed() -> bool:
    """Tell whether numba can be imported; does not import numba."""
    return find_spec("numba") is not None


def chosen(evaluations: int | None = None) -> str:
    """Name the engine, `numpy` or `numba`, for a run with that many evaluations; without a number, for a long run.

    The environment variable STUDY_ENGINE decides if it says `numpy` or `numba`.

    Raises
    ------
    StudyError
        If the variable says anything else.
    """
    wish = os.environ.get(VARIABLE) or AUTO
    if wish not in CHOICES:
        raise unknown(f"engine in the environment variable {VARIABLE}", wish, CHOICES)
    if wish == NUMPY or not installed():
        return NUMPY
    short = evaluations is not None and evaluations < WORTHWHILE
    return NUMPY if wish == AUTO and short else NUMBA


def compiled_module(load: Callable[[], ModuleType], evaluations: int | None = None) -> ModuleType | None:
    """Import compiled variants for a run with that many evaluations; None where NumPy computes.

    Parameters
    ----------
    load : callable () -> module
        Imports the variants, and numba with them.
    evaluations : int, optional
        Budget of the run; without one the run counts as long.
    """
    return None if chosen(evaluations) == NUMPY else _loaded(load)


@cache
def _loaded(load: Callable[[], ModuleType]) -> ModuleType | None:
    """Import compiled variants once; None where numba does not load or finds no folder for its cache."""
    try:
        import_module("numba")
    except ImportError:
        return None
    try:
        return load()
    except RuntimeError:  # numba's word for no folder
        return None


def described() -> str:
    """Say in a few words which engine computes peak rates here, for a result's environment."""
    if not installed():
        return "NumPy"
    wish = os.environ.get(VARIABLE) or AUTO
    if wish == AUTO:
        return f"NumPy, numba from {WORTHWHILE} evaluations in a run"
    return "numba" if chosen() == NUMBA else "NumPy"
