"""Which code computes a population's peak rates: NumPy, always there, or numba's compiled twin, with the extra `fast`.

The choice depends on the run's own budget and on what is installed, never on how far a run has come or on the machine's
load, so that a cell's result is the same whoever computes it. Both agree to rounding only: a search may turn at another
last bit, and so results record the engine.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from types import ModuleType

from study.curves import Curve
from study.errors import unknown

VARIABLE = "STUDY_ENGINE"
AUTO, NUMPY, NUMBA = "auto", "numpy", "numba"
CHOICES = (AUTO, NUMPY, NUMBA)
WORTHWHILE = 50_000
"""Evaluations of one run from which `auto` compiles: a worker pays about a second once to import numba and load its code,
as long as NumPy takes for 10^5 evaluations of a spline; the quick study has 2000 for each run."""


def installed() -> bool:
    """Whether numba can be imported; does not import it."""
    return find_spec("numba") is not None


def chosen(evaluations: int | None = None) -> str:
    """Name the engine, `numpy` or `numba`, for a run with that many evaluations; without a number, for a long one.

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


def with_engine(curve: Curve, evaluations: int | None = None) -> Curve:
    """Give a curve the peaks of the engine chosen for a run; numba is imported here and not before.

    Parameters
    ----------
    curve : Curve
    evaluations : int, optional
        Budget of the run; without one the run counts as long.
    """
    compiled = twins(_compiled, evaluations)
    if compiled is None or curve.name not in compiled.PEAKS:
        return curve
    return replace(curve, peaks=compiled.PEAKS[curve.name], demand=compiled.demand, penalty=compiled.penalty)


def twins(load: Callable[[], ModuleType], evaluations: int | None = None) -> ModuleType | None:
    """Import compiled twins for a run with that many evaluations; none where NumPy computes.

    Parameters
    ----------
    load : callable () -> module
        Imports them, and numba with them.
    evaluations : int, optional
        Budget of the run; without one the run counts as long.
    """
    return None if chosen(evaluations) == NUMPY else _loaded(load)


@cache
def _loaded(load: Callable[[], ModuleType]) -> ModuleType | None:
    """Import compiled twins once; none where numba does not load or finds no folder for its cache."""
    try:
        return load()
    except (ImportError, RuntimeError):
        return None


def _compiled() -> ModuleType:
    from study.curves import compiled

    return compiled


def described() -> str:
    """Say in a few words what computes peak rates here, for a result's environment."""
    if not installed():
        return "NumPy"
    wish = os.environ.get(VARIABLE) or AUTO
    if wish == AUTO:
        return f"NumPy, numba from {WORTHWHILE} evaluations in a run"
    return "numba" if chosen() == NUMBA else "NumPy"
