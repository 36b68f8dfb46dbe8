"""The compiled variant of the elimination; importing this file imports numba.

It solves the equations of `baselines.free_path.elimination` to rounding, in other coordinates: the reflections that
make the closing equations triangular, Ey Q = [L 0], are applied to the Hessian too. There the first unknowns follow
from the equations, the others from a Cholesky factor, and no basis of the null space is ever written down. With
B = Q' (Hyy + shift) Q, C = Q' Hyt and F = -L^-1 Et, split into the first rows 1 and the others 2,

    W = C2 + B21 F,    U' U = B22,    G = U'^-1 W,    Y = (F, -U^-1 G),

and the share in the reduced Hessian is Htt + F' (B11 F + C1) + C1' F - G' G.

The Hessian is summed piece by piece, with the sensitivities of x1 and x2 carried along, in z = (x1, x2 at the
beginning, u0, h0, u1, h1, ...), of which the states of a piece depend on the first few.
"""

from __future__ import annotations

import numpy as np

from baselines.free_path.compiled_algebra import (
    factored,
    kernel,
    reflect,
    reflect_both,
    reflect_columns,
    solve_above,
    solve_below,
)
from baselines.free_path.elimination import SHARED, WIDE
from baselines.free_path.question import Integers
from study.problem import Floats


@kernel
def _add_piece(g: Floats, s1: Floats, s2: Floats, first: int, hessian: Floats) -> None:
    """Add the second derivatives of a piece, given those in its five numbers, to the lower triangle.

    `first` is where its u0 stands, the last place with a sensitivity; h and u1 follow.
    """
    for a in range(3):
        place = first + (0, 2, 1)[a]
        for b in range(a + 1):
            beside = first + (0, 2, 1)[b]
            hessian[max(place, beside), min(place, beside)] += g[a + 2, b + 2]
        along1, along2 = g[a + 2, 1], g[a + 2, 0]
        for p in range(first + 1):
            hessian[place, p] += along1 * s1[p] + along2 * s2[p]
    hessian[first, first] += g[2, 1] * s1[first] + g[2, 0] * s2[first]
    ranged = g[0, 0] != 0.0
    for p in range(first + 1):
        value = g[1, 1] * s1[p]
        for q in range(p + 1):
            hessian[p, q] += value * s1[q]
        if ranged:
            value, other = g[0, 0] * s2[p] + g[1, 0] * s1[p], g[1, 0] * s2[p]
            for q in range(p + 1):
                hessian[p, q] += value * s2[q] + other * s1[q]


@kernel
def _advance(s1: Floats, s2: Floats, y: Floats, gains: tuple[float, float], first: int) -> None:
    """Carry the sensitivities of x1 and x2 over a piece."""
    c1, c2 = gains
    x1, u0, u1, h = y[1], y[2], y[3], y[4]
    for p in range(first + 1):
        s2[p] += c2 * h * s1[p]
    both = c1 * c2 * h
    s2[first] += both * h / 3
    s2[first + 2] += both * h / 6
    s2[first + 1] += c2 * x1 + both * (2 * u0 + u1) / 3
    s1[first] += c1 * h / 2
    s1[first + 2] += c1 * h / 2
    s1[first + 1] += c1 * (u0 + u1) / 2


@kernel
def _sum_up(local: Floats, states: Floats, gains: tuple[float, float], hessian: Floats, closing: Floats) -> None:
    """Hessian in z, and the last sensitivities."""
    s1, s2, y = closing[0], closing[1], np.empty(5)
    closing[:] = 0.0
    s1[0] = s2[1] = 1.0
    hessian[:] = 0.0
    for k in range(len(local)):
        for row in range(5):
            y[row] = states[row, k]
        _add_piece(local[k], s1, s2, 2 + 2 * k, hessian)
        _advance(s1, s2, y, gains, 2 + 2 * k)
    for p in range(len(hessian)):
        for q in range(p):
            hessian[q, p] = hessian[p, q]


@kernel
def _gather(
    hessian: Floats, inside: Integers, ends: Integers, shares: Floats, out: tuple[Floats, Floats, Floats]
) -> None:
    """Hyy, Hyt and Htt of one block; without widths among the unknowns they follow the duration."""
    inner, cross, outer = out
    pieces, free = len(shares), len(inside) >= len(shares)
    cross[:] = 0.0
    outer[:] = 0.0
    for p in range(len(inside)):
        row = hessian[inside[p]]
        for q in range(len(inside)):
            inner[p, q] = row[inside[q]]
        for q in range(4):
            cross[p, q] = row[ends[q]]
    for p in range(4):
        for q in range(4):
            outer[p, q] = hessian[ends[p], ends[q]]
    if free:
        return
    for k in range(pieces):
        row = hessian[3 + 2 * k]
        for p in range(len(inside)):
            cross[p, 6] += shares[k] * row[inside[p]]
        for p in range(4):
            outer[p, 6] += shares[k] * row[ends[p]]
        for m in range(pieces):
            outer[6, 6] += shares[k] * shares[m] * row[3 + 2 * m]
    for p in range(4):
        outer[6, p] = outer[p, 6]


@kernel
def _equations(
    closing: Floats,
    scales: Floats,
    kind: int,
    places: tuple[Integers, Integers],
    shares: Floats,
    rows: Floats,
    outside: Floats,
) -> int:
    """Ey and Et of one block, and how many equations there are."""
    inside, ends = places
    pieces, free, count = len(shares), len(inside) >= len(shares), 0
    rows[:] = 0.0
    outside[:] = 0.0
    for row in range(2):
        if kind <= row + 1:
            continue
        for p in range(len(inside)):
            rows[count, p] = closing[row, inside[p]] / scales[row]
        for p in range(4):
            outside[count, p] = closing[row, ends[p]] / scales[row]
        outside[count, 4 + row] = -1 / scales[row]
        if not free:
            for k in range(pieces):
                outside[count, 6] += shares[k] * closing[row, 3 + 2 * k] / scales[row]
        count += 1
    if free:
        rows[count, pieces - 1 :] = 1.0
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
    """Do for every block what does not depend on the regularisation; `out` is filled with B, C, Htt, F, L, normals."""
    inner, cross, outer, lead, triangle, normals = out
    size = 2 * local.shape[2] + 3
    hessian, closing, image = np.empty((size, size)), np.empty((2, size)), np.empty(inner.shape[3])
    for i in range(local.shape[0]):
        for j in range(local.shape[1]):
            gain = gains[0][i, j, 0], gains[1][i, j, 0]
            _sum_up(local[i, j], states[:, i, j], gain, hessian, closing)
            _gather(hessian, places[0], places[1], shares[i, j], (inner[i, j], cross[i, j], outer[i, j]))
            rows, first, normal = triangle[i, j], lead[i, j], normals[i, j]
            count = _equations(closing, closures[i, j], kinds[j], places, shares[i, j], rows, first)
            reflect(rows, count, normal)
            reflect_columns(normal, count, cross[i, j])
            reflect_both(normal, count, inner[i, j], image)
            for c in range(count):
                for r in range(c):
                    for a in range(WIDE):
                        first[c, a] += rows[c, r] * first[r, a]
                for a in range(WIDE):
                    first[c, a] /= -rows[c, c]


@kernel
def finish(
    least: float, counts: Integers, shifts: tuple[float, float], given: tuple[Floats, ...], out: tuple[Floats, ...]
) -> None:
    """Eliminate all blocks with a regularisation; `out` is filled with U, the shifts, Y and the reduced Hessians."""
    inner, cross, outer, lead = given
    factors, shifted, follow, reduced = out
    first, growth = shifts
    ny = inner.shape[2]
    image, onto = np.empty((ny, WIDE)), np.empty((WIDE, WIDE))
    for i in range(inner.shape[0]):
        for j in range(inner.shape[1]):
            count, factor = counts[j], factors[i, j]
            nn, shift = ny - count, least
            if nn and not factored(inner[i, j], count, shift, factor):
                shift = first
                while not factored(inner[i, j], count, shift, factor) and shift < 1e30:
                    shift *= growth
                shift = max(2 * shift, least)
                factored(inner[i, j], count, shift, factor)
            shifted[i, j] = shift if nn else 0.0
            block = inner[i, j], cross[i, j], lead[i, j], factor
            _reduce(block, count, shifted[i, j], (follow[i, j], image, onto))
            for a in range(SHARED):
                for b in range(SHARED):
                    reduced[i, j, a, b] = outer[i, j, a, b] + onto[a, b]


@kernel
def _reduce(
    block: tuple[Floats, Floats, Floats, Floats], count: int, shift: float, out: tuple[Floats, Floats, Floats]
) -> None:
    """Y of one block, and what the block adds to Htt."""
    inner, cross, lead, factor = block
    follow, image, onto = out
    size = len(inner)
    onto[:] = 0.0
    for p in range(size):
        for a in range(WIDE):
            image[p, a] = cross[p, a] + (shift * lead[p, a] if p < count else 0.0)
        for c in range(count):
            value = inner[p, c]
            for a in range(WIDE):
                image[p, a] += value * lead[c, a]
    for c in range(count):
        follow[c] = lead[c]
        for a in range(WIDE):
            left, right = lead[c, a], cross[c, a]
            for b in range(WIDE):
                onto[a, b] += left * image[c, b] + right * lead[c, b]
    rest, own = image[count:], follow[count:]
    solve_below(factor, size - count, rest)
    for p in range(size - count):
        for a in range(WIDE):
            value = rest[p, a]
            own[p, a] = -value
            for b in range(WIDE):
                onto[a, b] -= value * rest[p, b]
    solve_above(factor, size - count, own)
