"""Choice of the code that eliminates blocks: NumPy, always there, or numba, with the extra `fast`.

Compiling takes half a minute, which nobody should wait for who only wants a motion. So numba computes if the
environment variable STUDY_ENGINE says `numba`, which compiles once and keeps the code, and from then on for problems
that are large enough to pay for the import. Both give the same blocks to rounding.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from baselines.free_path.elimination import Elimination
from baselines.free_path.model import Model
from baselines.free_path.rows import Rows
from study.engine import AUTO, NUMBA, VARIABLE, chosen, compiled_module

if TYPE_CHECKING:
    from baselines.free_path.compiled_steps import CompiledElimination

WORTHWHILE = 3000
"""Pieces of all joints from which importing numba pays, about a second's work of NumPy."""

SOURCES = [
    Path(__file__).with_name(f"{name}.py")
    for name in ("compiled", "compiled_algebra", "compiled_pieces", "compiled_steps")
]
LAST = "compiled.finish", "compiled_pieces.forward", "compiled_steps.complete"
"""Functions that an iteration compiles last."""


def code_for(model: Model) -> tuple[type[Rows], type[Elimination] | type[CompiledElimination]]:
    """Choose the code for a model; numba is imported here and not before."""
    wish = os.environ.get(VARIABLE) or AUTO
    worth = "numba" in sys.modules or np.prod(model.shape) >= WORTHWHILE
    if chosen() != NUMBA or (wish != NUMBA and not (worth and kept())) or compiled_module(_compiled) is None:
        return Rows, Elimination
    return (
        import_module("baselines.free_path.compiled_pieces").CompiledRows,
        import_module("baselines.free_path.compiled_steps").CompiledElimination,
    )


def kept() -> bool:
    """Whether compiled code of this version was kept by an earlier run."""
    folders = [SOURCES[0].parent / "__pycache__"]
    if elsewhere := os.environ.get("NUMBA_CACHE_DIR"):
        folders = list(Path(elsewhere).glob("*"))
    version = f"py{sys.version_info.major}{sys.version_info.minor}"
    changed = max(source.stat().st_mtime for source in SOURCES)
    return all(
        any(file.stat().st_mtime >= changed for folder in folders for file in folder.glob(f"{last}-*.{version}.nbi"))
        for last in LAST
    )


def _compiled() -> ModuleType:
    return import_module("baselines.free_path.compiled")
