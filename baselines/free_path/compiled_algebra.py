"""Small dense linear algebra for the compiled elimination; importing this file imports numba."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numba import njit

from study.problem import Floats

Kernel = TypeVar("Kernel", bound=Callable[..., object])


def kernel(function: Kernel) -> Kernel:
    """Compile a function on its first call, and keep it in numba's cache; sums may be reordered."""
    compiled: Any = njit(cache=True, fastmath={"reassoc", "contract"})(function)
    return compiled


@kernel
def reflect(work: Floats, left: Floats, count: int) -> None:
    """Householder reflections of `work` (n_inner, count); `left` becomes the orthogonal factor."""
    size = len(work)
    left[:] = np.eye(size)
    normal = np.empty(size)
    for k in range(count):
        norm = 0.0
        for p in range(k, size):
            norm += work[p, k] * work[p, k]
        norm = np.sqrt(norm)
        for p in range(k, size):
            normal[p] = work[p, k]
        normal[k] += np.copysign(norm, normal[k])
        square = 0.0
        for p in range(k, size):
            square += normal[p] * normal[p]
        for c in range(k, count):
            total = 0.0
            for p in range(k, size):
                total += normal[p] * work[p, c]
            total *= 2 / square
            for p in range(k, size):
                work[p, c] -= total * normal[p]
        for row in range(size):
            total = 0.0
            for p in range(k, size):
                total += left[row, p] * normal[p]
            total *= 2 / square
            for p in range(k, size):
                left[row, p] -= total * normal[p]


@kernel
def right_inverse(left: Floats, triangle: Floats, count: int, inverse: Floats) -> None:
    """Solve for the right inverse, column by column from the last."""
    for c in range(count - 1, -1, -1):
        for p in range(len(left)):
            value = left[p, c]
            for r in range(c + 1, count):
                value -= inverse[p, r] * triangle[c, r]
            inverse[p, c] = value / triangle[c, c]


@kernel
def multiply(left: Floats, right: Floats, sign: float, product: Floats) -> None:
    """Product of two matrices, up to its sign, row by row so that the inner loop runs along memory."""
    for p in range(len(left)):
        for q in range(right.shape[1]):
            product[p, q] = 0.0
        for r in range(len(right)):
            value = sign * left[p, r]
            for q in range(right.shape[1]):
                product[p, q] += value * right[r, q]


@kernel
def project(left: Floats, product: Floats, count: int, hessian: Floats) -> None:
    """Hessian in the null space of the equations."""
    size = len(left)
    free = size - count
    hessian[:free, :free] = 0.0
    for r in range(size):
        for p in range(free):
            value = left[r, count + p]
            for q in range(p + 1):
                hessian[p, q] += value * product[r, q]
    for p in range(free):
        for q in range(p):
            hessian[q, p] = hessian[p, q]


@kernel
def factored(matrix: Floats, shift: float, size: int, factor: Floats) -> bool:
    """Cholesky factor of the leading part of a matrix plus a multiple of the identity; whether there is one."""
    for p in range(size):
        for q in range(p + 1):
            total = matrix[p, q]
            if p == q:
                total += shift
            for r in range(q):
                total -= factor[p, r] * factor[q, r]
            if p == q:
                if not total > 0.0:
                    return False
                factor[p, p] = np.sqrt(total)
            else:
                factor[p, q] = total / factor[q, q]
    return True
