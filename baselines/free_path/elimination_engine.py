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

import numpy as np

from baselines.free_path.elimination import SHARED, SHIFTS, Blocks, Elimination, equations_of
from baselines.free_path.model import Model
from baselines.free_path.pieces import Pieces
from baselines.free_path.rows import Rows
from study.engine import AUTO, NUMBA, VARIABLE, chosen, compiled_module
from study.problem import Floats

WORTHWHILE = 3000
"""Pieces of all joints from which importing numba pays, about a second's work of NumPy."""

SOURCES = [
    Path(__file__).with_name(f"{name}.py")
    for name in ("compiled", "compiled_algebra", "compiled_pieces", "compiled_steps")
]
LAST = "compiled.finish", "compiled_pieces.forward", "compiled_steps.complete"
"""Functions that an iteration compiles last."""


def code_for(model: Model) -> tuple[type[Rows], type[Elimination]]:
    """Choose the code for a model; numba is imported here and not before."""
    wish = os.environ.get(VARIABLE) or AUTO
    worth = "numba" in sys.modules or np.prod(model.shape) >= WORTHWHILE
    if chosen() != NUMBA or (wish != NUMBA and not (worth and kept())) or compiled_module(_compiled) is None:
        return Rows, Elimination
    return import_module("baselines.free_path.compiled_pieces").CompiledRows, CompiledElimination


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


def _steps() -> ModuleType:
    return import_module("baselines.free_path.compiled_steps")


class CompiledElimination(Elimination):
    """The same elimination by compiled loops over the blocks."""

    def __init__(self, model: Model, at: Pieces, local: Floats, free: bool, shares: Floats) -> None:
        self._code, pieces = _compiled(), model.pieces
        wide = np.arange(pieces + 1, 2 * pieces + 1)
        inside = np.concatenate([np.arange(1, pieces), wide]) if free else np.arange(1, pieces)
        ends = np.array([0, 2 * pieces + 1, 2 * pieces + 2, pieces])
        self._counts = np.array([len(equations_of(int(kind), free)) for kind in model.kinds])
        shape, size = model.shape[:2], len(inside)
        self.inner, self._basis, self._hessians = (np.empty((*shape, size, size)) for _ in range(3))
        self.cross, self.feasible = np.empty((*shape, size, SHARED)), np.empty((*shape, size, SHARED))
        self.outer, self.inverse = np.empty((*shape, SHARED, SHARED)), np.zeros((*shape, size, 3))
        out = self.inner, self.cross, self.outer, self.inverse, self.feasible, self._basis, self._hessians
        self._code.prepare(
            local,
            at.states,
            model.gains,
            model.closures,
            model.kinds,
            (inside, ends),
            np.ascontiguousarray(shares),
            out,
        )

    def blocks(self, regularisation: float) -> Blocks:
        """Eliminate the inside of all blocks, with a multiple of the identity added to it."""
        inner, half = self.inner.copy(), np.empty_like(self.inner)
        follow, reduced = np.empty_like(self.cross), np.empty_like(self.outer)
        given = self.cross, self.outer, self.feasible, self._basis, self._hessians
        out = inner, half, follow, reduced
        self._code.finish(float(regularisation), self._counts, SHIFTS, given, out)
        return CompiledBlocks(self.inverse, half, inner, self.cross, follow, reduced)


class CompiledBlocks(Blocks):
    """The same blocks; `projected` is Z L^-T, whose product with its own transpose is N."""

    def begin(self, right: Floats, errors: Floats) -> tuple[Floats, Floats]:
        """y0, and the blocks' shares in the right side of the reduced system."""
        out = np.empty_like(right), np.empty((*right.shape[:2], SHARED))
        _steps().begin(right, errors, self._arrays, out)
        return out

    def complete(self, right: Floats, start: Floats, shared: Floats) -> tuple[Floats, Floats]:
        """Step inside of the blocks, and in the multipliers of their equations."""
        inside, multipliers = start.copy(), np.empty((*right.shape[:2], 3))
        _steps().complete(right, shared, self._arrays, inside, multipliers)
        return inside, multipliers

    @property
    def _arrays(self) -> tuple[Floats, ...]:
        return self.inverse, self.projected, self.inner, self.cross, self.follow
