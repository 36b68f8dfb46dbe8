"""Compiled variants of the curve families' peak rates; the files of this folder import numba, the folder does not."""

from __future__ import annotations

from dataclasses import replace
from types import ModuleType

from study.curves import Curve
from study.engine import compiled_module


def with_engine(curve: Curve, evaluations: int | None = None) -> Curve:
    """Curve with the peak rates of the engine chosen for a run.

    Parameters
    ----------
    curve : Curve
    evaluations : int, optional
        Budget of the run; without one the run counts as long.
    """
    compiled = compiled_module(_peaks, evaluations)
    if compiled is None or curve.name not in compiled.PEAKS:
        return curve
    return replace(curve, peaks=compiled.PEAKS[curve.name], demand=compiled.demand, penalty=compiled.penalty)


def _peaks() -> ModuleType:
    from study.curves.compiled import peaks  # here: importing the module imports numba

    return peaks
