"""Small dense linear algebra for the compiled elimination; importing this file imports numba."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numba import njit

from baselines.free_path.elimination import WIDE
from study.problem import Floats

Kernel = TypeVar("Kernel", bound=Callable[..., object])


def kernel(function: Kernel) -> Kernel:
    """Compile a function on its first call, and keep it in numba's cache; sums may be reordered."""
    compiled: Any = njit(cache=True, fastmath={"reassoc", "contract", "arcp", "nsz"})(function)
    return compiled


@kernel
def reflect(rows: Floats, count: int, normals: Floats) -> None:
    """Make the first `count` rows lower triangular by reflections I - n n' from the right; the normals n are kept."""
    size = rows.shape[1]
    for k in range(count):
        norm = 0.0
        for p in range(k, size):
            norm += rows[k, p] * rows[k, p]
        norm = np.sqrt(norm)
        corner = rows[k, k] + np.copysign(norm, rows[k, k])
        scale = np.sqrt(2.0 / (norm * norm - rows[k, k] * rows[k, k] + corner * corner))
        for p in range(size):
            normals[k, p] = rows[k, p] * scale if p > k else 0.0
        normals[k, k] = corner * scale
        for c in range(k, count):
            total = 0.0
            for p in range(k, size):
                total += normals[k, p] * rows[c, p]
            for p in range(k, size):
                rows[c, p] -= total * normals[k, p]


@kernel
def reflected(normals: Floats, count: int, vector: Floats) -> None:
    """Reflect a vector at all normals, the first one first."""
    for k in range(count):
        _reflect_once(normals[k], vector)


@kernel
def reflected_back(normals: Floats, count: int, vector: Floats) -> None:
    """Undo `reflected`."""
    for k in range(count - 1, -1, -1):
        _reflect_once(normals[k], vector)


@kernel
def _reflect_once(normal: Floats, vector: Floats) -> None:
    total = 0.0
    for p in range(len(vector)):
        total += normal[p] * vector[p]
    for p in range(len(vector)):
        vector[p] -= total * normal[p]


@kernel
def reflect_columns(normals: Floats, count: int, matrix: Floats) -> None:
    """Reflect all columns of a matrix of `WIDE` columns."""
    totals = np.empty(WIDE)
    for k in range(count):
        totals[:] = 0.0
        for p in range(k, len(matrix)):
            for a in range(WIDE):
                totals[a] += normals[k, p] * matrix[p, a]
        for p in range(k, len(matrix)):
            for a in range(WIDE):
                matrix[p, a] -= normals[k, p] * totals[a]


@kernel
def reflect_both(normals: Floats, count: int, matrix: Floats, image: Floats) -> None:
    """Reflect rows and columns of a symmetric matrix; `image` is room for a column."""
    size = len(matrix)
    for k in range(count):
        normal = normals[k]
        image[:] = 0.0
        for p in range(k, size):
            value = normal[p]
            for q in range(size):
                image[q] += value * matrix[p, q]
        half = 0.0
        for p in range(size):
            half += normal[p] * image[p]
        half *= 0.5
        for p in range(size):
            image[p] -= half * normal[p]
        for p in range(size):
            left, right = normal[p], image[p]
            for q in range(size):
                matrix[p, q] -= left * image[q] + right * normal[q]


@kernel
def factored(matrix: Floats, count: int, shift: float, factor: Floats) -> bool:
    """Upper Cholesky factor of a matrix without its first `count` rows and columns, plus a multiple of the identity.

    Whether there is one; the diagonal of `factor` holds reciprocals.
    """
    size = len(matrix) - count
    for p in range(size):
        for q in range(p, size):
            factor[p, q] = matrix[count + p, count + q]
        factor[p, p] += shift
    for k in range(size):
        if not factor[k, k] > 0.0:
            return False
        inverse = 1.0 / np.sqrt(factor[k, k])
        factor[k, k] = inverse
        for q in range(k + 1, size):
            factor[k, q] *= inverse
        for p in range(k + 1, size):
            value = factor[k, p]
            for q in range(p, size):
                factor[p, q] -= value * factor[k, q]
    return True


@kernel
def solve_below(factor: Floats, size: int, right: Floats) -> None:
    """Solve U' x = right for `WIDE` columns, in place."""
    for k in range(size):
        for a in range(WIDE):
            right[k, a] *= factor[k, k]
        for p in range(k + 1, size):
            value = factor[k, p]
            for a in range(WIDE):
                right[p, a] -= value * right[k, a]


@kernel
def solve_above(factor: Floats, size: int, right: Floats) -> None:
    """Solve U x = right for `WIDE` columns, in place."""
    for k in range(size - 1, -1, -1):
        for p in range(k + 1, size):
            value = factor[k, p]
            for a in range(WIDE):
                right[k, a] -= value * right[p, a]
        for a in range(WIDE):
            right[k, a] *= factor[k, k]


@kernel
def solve_one(factor: Floats, size: int, right: Floats) -> None:
    """Solve U' U x = right for one column, in place."""
    for k in range(size):
        right[k] *= factor[k, k]
        for p in range(k + 1, size):
            right[p] -= factor[k, p] * right[k]
    for k in range(size - 1, -1, -1):
        total = right[k]
        for p in range(k + 1, size):
            total -= factor[k, p] * right[p]
        right[k] = total * factor[k, k]
