"""The compiled variant of the elimination; importing this file imports numba.

It follows `baselines.free_path.elimination` step by step, so that both give the same blocks to rounding; see there for
the equations. The lower triangle of every Hessian is summed piece by piece, with the sensitivities of x1 and x2 carried
along.
"""

from __future__ import annotations

import numpy as np

from baselines.free_path.compiled_algebra import factored, kernel, multiply, project, reflect, right_inverse
from baselines.free_path.question import Integers
from study.problem import Floats

SHARED = 7


@kernel
def _add_piece(
    g: Floats, s1: Floats, s2: Floats, columns: tuple[int, int, int], used: Integers, hessian: Floats
) -> None:
    """Add the second derivatives of a piece, given those in its five numbers; only `used` sensitivities are nonzero."""
    for a in range(3):
        for b in range(a + 1):
            hessian[columns[a], columns[b]] += g[a + 2, b + 2]
    ranged = g[0, 0] != 0.0
    for a in range(len(used)):
        p = used[a]
        for b in range(a + 1):
            q = used[b]
            hessian[p, q] += g[1, 1] * s1[p] * s1[q]
            if ranged:
                hessian[p, q] += g[0, 0] * s2[p] * s2[q] + g[1, 0] * (s1[p] * s2[q] + s2[p] * s1[q])
        for b in range(3):
            value = g[b + 2, 1] * s1[p] + g[b + 2, 0] * s2[p]
            column = columns[b]
            if p > column:
                hessian[p, column] += value
            elif p < column:
                hessian[column, p] += value
            else:
                hessian[p, p] += 2 * value


@kernel
def _advance(s1: Floats, s2: Floats, y: Floats, gains: tuple[float, float], k: int, pieces: int) -> None:
    """Carry the sensitivities of x1 and x2 over piece k."""
    c1, c2 = gains
    x1, u0, u1, h = y[1], y[2], y[3], y[4]
    for p in range(len(s1)):
        s2[p] += c2 * h * s1[p]
    both, width = c1 * c2 * h, pieces + 1 + k
    s2[k] += both * h / 3
    s2[k + 1] += both * h / 6
    s2[width] += c2 * x1 + both * (2 * u0 + u1) / 3
    s1[k] += c1 * h / 2
    s1[k + 1] += c1 * h / 2
    s1[width] += c1 * (u0 + u1) / 2


@kernel
def _sum_up(local: Floats, y: Floats, gains: tuple[float, float], hessian: Floats, closing: Floats) -> None:
    """Hessian in z, and the last sensitivities."""
    pieces, size = local.shape[0], len(hessian)
    s1, s2 = closing[0], closing[1]
    s1[:] = 0.0
    s2[:] = 0.0
    s1[size - 2] = 1.0
    s2[size - 1] = 1.0
    hessian[:] = 0.0
    used = np.empty(size, dtype=np.int64)
    for k in range(pieces):
        used[: k + 1] = np.arange(k + 1)
        used[k + 1 : 2 * k + 1] = np.arange(pieces + 1, pieces + 1 + k)
        used[2 * k + 1] = size - 2
        used[2 * k + 2] = size - 1
        _add_piece(local[k], s1, s2, (k, k + 1, pieces + 1 + k), used[: 2 * k + 3], hessian)
        _advance(s1, s2, y[:, k], gains, k, pieces)
    for p in range(size):
        for q in range(p):
            hessian[q, p] = hessian[p, q]


@kernel
def _gather(
    hessian: Floats,
    inside: Integers,
    ends: Integers,
    shares: Floats,
    out: tuple[Floats, Floats, Floats],
) -> None:
    """Hyy, Hyt and Htt of one block; without widths among the unknowns they follow the duration."""
    inner, cross, outer = out
    pieces, free = len(shares), len(inside) >= len(shares)
    for p in range(len(inside)):
        for q in range(len(inside)):
            inner[p, q] = hessian[inside[p], inside[q]]
        for q in range(4):
            cross[p, q] = hessian[inside[p], ends[q]]
        cross[p, 4:] = 0.0
    outer[:] = 0.0
    for p in range(4):
        for q in range(4):
            outer[p, q] = hessian[ends[p], ends[q]]
    if free:
        return
    for k in range(pieces):
        row = hessian[pieces + 1 + k]
        for p in range(len(inside)):
            cross[p, 6] += shares[k] * row[inside[p]]
        for p in range(4):
            outer[p, 6] += shares[k] * row[ends[p]]
        for m in range(pieces):
            outer[6, 6] += shares[k] * shares[m] * row[pieces + 1 + m]
    for p in range(4):
        outer[6, p] = outer[p, 6]


@kernel
def _equations(
    closing: Floats,
    scales: Floats,
    kind: int,
    inside: Integers,
    ends: Integers,
    shares: Floats,
    work: Floats,
    outside: Floats,
) -> int:
    """Ey' and Et of one block, and how many equations there are."""
    pieces, free, count = len(shares), len(inside) >= len(shares), 0
    work[:] = 0.0
    outside[:] = 0.0
    for row in range(2):
        if kind <= row + 1:
            continue
        for p in range(len(inside)):
            work[p, count] = closing[row, inside[p]] / scales[row]
        for p in range(4):
            outside[count, p] = closing[row, ends[p]] / scales[row]
        outside[count, 4 + row] = -1 / scales[row]
        if not free:
            for k in range(pieces):
                outside[count, 6] += shares[k] * closing[row, pieces + 1 + k] / scales[row]
        count += 1
    if free:
        work[pieces - 1 :, count] = 1.0
        outside[count, 6] = -1.0
        count += 1
    return count


@kernel
def prepare(
    local: Floats,
    states: Floats,
    gains: tuple[Floats, Floats],
    closures: Floats,
    kinds: Integers,
    places: tuple[Integers, Integers],
    shares: Floats,
    out: tuple[Floats, ...],
) -> None:
    """Do for every block what does not depend on the regularisation; `out` is filled."""
    inside, ends = places
    inner, cross, outer, inverse, feasible, basis, projected = out
    size, ny = 2 * local.shape[2] + 3, len(inside)
    hessian, closing = np.empty((size, size)), np.empty((2, size))
    work, left, outside, product = np.empty((ny, 3)), np.empty((ny, ny)), np.empty((3, SHARED)), np.empty((ny, ny))
    for i in range(local.shape[0]):
        for j in range(local.shape[1]):
            gain = gains[0][i, j, 0], gains[1][i, j, 0]
            _sum_up(local[i, j], states[:, i, j], gain, hessian, closing)
            _gather(hessian, inside, ends, shares[i, j], (inner[i, j], cross[i, j], outer[i, j]))
            count = _equations(closing, closures[i, j], kinds[j], inside, ends, shares[i, j], work, outside)
            reflect(work, left, count)
            columns = inverse[i, j]
            right_inverse(left, work, count, columns)
            multiply(columns, outside[:count], -1.0, feasible[i, j])
            if kinds[j] == 1 and count == 1:  # the only equation is the third
                columns[:, 2] = columns[:, 0]
                columns[:, 0] = 0.0
            if kinds[j] == 2 and count == 2:
                columns[:, 2] = columns[:, 1]
                columns[:, 1] = 0.0
            basis[i, j] = left
            multiply(inner[i, j], left[:, count:], 1.0, product)
            project(left, product, count, projected[i, j])


@kernel
def finish(
    least: float, counts: Integers, shifts: tuple[float, float], given: tuple[Floats, ...], out: tuple[Floats, ...]
) -> None:
    """Eliminate all blocks with a regularisation; `out` is filled, and its first part holds Hyy before the call.

    The projection N is kept as its factor Z L^-T.
    """
    cross, outer, feasible, basis, hessians = given
    inner, half, follow, reduced = out
    first, growth = shifts
    ny = inner.shape[2]
    factor, right, image = np.empty((ny, ny)), np.empty((ny, SHARED)), np.empty((ny, SHARED))
    for i in range(inner.shape[0]):
        for j in range(inner.shape[1]):
            count = counts[j]
            nn, shift = ny - count, least
            if nn and not factored(hessians[i, j], shift, nn, factor):
                shift = first
                while not factored(hessians[i, j], shift, nn, factor) and shift < 1e30:
                    shift *= growth
                shift = max(2 * shift, least)
                factored(hessians[i, j], shift, nn, factor)
            own, root = inner[i, j], half[i, j]
            for p in range(ny if nn else 0):
                own[p, p] += shift
            for p in range(ny):
                for q in range(nn):
                    total = basis[i, j, p, count + q]
                    for r in range(q):
                        total -= root[p, r] * factor[q, r]
                    root[p, q] = total / factor[q, q]
                root[p, nn:] = 0.0
            out_of = follow[i, j], reduced[i, j], right, image
            _reduce(own, cross[i, j], outer[i, j], feasible[i, j], root[:, :nn], out_of)


@kernel
def _reduce(
    inner: Floats,
    cross: Floats,
    outer: Floats,
    feasible: Floats,
    root: Floats,
    out: tuple[Floats, Floats, Floats, Floats],
) -> None:
    """Y and the share in the reduced Hessian of one block.

    With F = -P Et, W = Hyt + Hyy F and G = (Z L^-T)' W these are F - Z L^-T G and Htt + F' W + Hyt' F - G' G.
    """
    follow, reduced, right, image = out
    multiply(inner, feasible, 1.0, right)
    right += cross
    nn = root.shape[1]
    image[:nn] = 0.0
    for p in range(len(root)):
        for r in range(nn):
            value = root[p, r]
            for a in range(SHARED):
                image[r, a] += value * right[p, a]
    for p in range(len(root)):
        follow[p] = feasible[p]
        for r in range(nn):
            value = root[p, r]
            for a in range(SHARED):
                follow[p, a] -= value * image[r, a]
    reduced[:] = outer
    for p in range(len(inner)):
        for a in range(SHARED):
            left, beside = feasible[p, a], cross[p, a]
            for b in range(SHARED):
                reduced[a, b] += left * right[p, b] + beside * feasible[p, b]
    for r in range(nn):
        for a in range(SHARED):
            value = image[r, a]
            for b in range(SHARED):
                reduced[a, b] -= value * image[r, b]
