"""Compilation options of the kernels: cached on disk, NumPy's divisions, products and sums fused where possible."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}, "nogil": True}


def kernel(function: F) -> F:
    """Compile a function at its first call."""
    compiled: Any = njit(**_OPTIONS)(function)
    return compiled


def exact(function: F) -> F:
    """Compile a function that must give NumPy's own bits: nothing fused, nothing reordered."""
    compiled: Any = njit(**_OPTIONS | {"fastmath": False})(function)
    return compiled


def inlined(function: F) -> F:
    """Compile a function into its callers, so that their loops can become vector instructions."""
    compiled: Any = njit(inline="always", **_OPTIONS)(function)
    return compiled
