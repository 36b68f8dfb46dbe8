r"""Newton's equations of one segment and joint, reduced to what the joint shares with others.

Inside stand y, the values of u where pieces meet and, if free, the widths; outside t = (u, x1, x2 at the segment's
beginning, u, x1, x2 at its end, T). With the Hessian of the Lagrangian in parts and the closing equations E,

    Hyy dy + Hyt dt + Ey' dn = ry,     Ey dy + Et dt = -e.

Let P be a right inverse of Ey and N = Z (Z' Hyy Z)^-1 Z' for a basis Z of its null space. Then

    dy = P (-e - Et dt) + N (ry - Hyt dt - Hyy P (-e - Et dt)) = y0 + Y dt,
    dn = P' (ry - Hyy dy - Hyt dt),

and the joint's share in the reduced Hessian is [Y; I]' H [Y; I]. The block has the inertia that a minimum needs exactly
if Z' Hyy Z is positive definite; where it is not, a multiple of the identity is added.

P and Z come from Householder reflections of Ey' = Q [R; 0].

References
----------
J. Nocedal and S. Wright, Numerical Optimization, 2nd ed., 2006, sections 16.2 (null-space method) and 19.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from baselines.free_path.model import Model
from baselines.free_path.pieces import U0, U1, X1, X2, H, Pieces
from study.problem import Floats

SHARED = 7
"""Number of shared unknowns of a block."""

WIDE = 8
"""Columns that compiled code keeps for them: one more that stays zero, so that loops are as long as processors like."""

SHIFTS = (1e-6, 3.0)
"""First trial and factor of the shifts that are tried on a block without the right inertia; twice the first that is
enough is taken, because one that is just enough would make the step huge."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """All blocks after elimination; every array begins with (n_segments, n_moving).

    Attributes
    ----------
    inverse : array of shape (..., n_inner, 3)
        P, with a column of zeros for every equation that a joint does not have.
    projected : array of shape (..., n_inner, n_inner)
        N.
    inner, cross : arrays of shape (..., n_inner, n_inner) and (..., n_inner, 7)
        Hyy and Hyt.
    follow : array of shape (..., n_inner, 7)
        Y.
    reduced : array of shape (..., 7, 7)
    """

    inverse: Floats
    projected: Floats
    inner: Floats
    cross: Floats
    follow: Floats
    reduced: Floats

    def begin(self, right: Floats, errors: Floats) -> tuple[Floats, Floats]:
        """y0, and the blocks' shares in the right side of the reduced system.

        Parameters
        ----------
        right : array of shape (..., n_inner)
        errors : array of shape (..., 3)
            What is left of the equations.

        Returns
        -------
        start : array of shape (..., n_inner)
        shared : array of shape (..., 7)
        """
        start = -_times(self.inverse, errors)
        start = start + _times(self.projected, right - _times(self.inner, start))
        rest = right - _times(self.inner, start)
        return start, _times(self.follow.swapaxes(-1, -2), rest) - _times(self.cross.swapaxes(-1, -2), start)

    def complete(self, right: Floats, start: Floats, shared: Floats) -> tuple[Floats, Floats]:
        """Step inside of the blocks, and in the multipliers of their equations, shape (..., 3)."""
        inside = start + _times(self.follow, shared)
        rest = right - _times(self.inner, inside) - _times(self.cross, shared)
        return inside, _times(self.inverse.swapaxes(-1, -2), rest)


def _times(matrix: Floats, vector: Floats) -> Floats:
    return (matrix @ vector[..., None])[..., 0]


def equations_of(kind: int, free: bool) -> list[int]:
    """Indices of the closing equations (x1, x2, sum of widths) that a joint of that kind has."""
    return [row for row in range(2) if kind > row + 1] + [2] * free


class Elimination:
    """Blocks that are ready to be eliminated with any regularisation.

    Parameters
    ----------
    model : Model
    at : Pieces
    local : array of shape (n_segments, n_moving, K, 5, 5)
        From `curvature`.
    free : bool
        Whether widths are unknowns; otherwise they are `shares` of the duration.
    shares : array of shape (n_segments, n_moving, K)
    """

    def __init__(self, model: Model, at: Pieces, local: Floats, free: bool, shares: Floats) -> None:
        hessian, closing = _assembled(model, at, local)
        self.inner, self.cross, self.outer, inside, outside = _partitioned(model, hessian, closing, free, shares)
        self.inverse = np.zeros((*self.inner.shape[:3], 3))
        self._bases = []
        for kind in np.unique(model.kinds):
            group, equations = model.kinds == kind, equations_of(int(kind), free)
            inverse, null = split(inside[:, group][:, :, equations])
            columns = np.zeros((*inverse.shape[:-1], 3))
            columns[..., equations] = inverse
            self.inverse[:, group] = columns
            self._bases.append((group, null, null.swapaxes(-1, -2) @ self.inner[:, group] @ null))
        self.feasible = -self.inverse @ outside

    def blocks(self, regularisation: float) -> Blocks:
        """Eliminate the inside of all blocks, with a multiple of the identity added to it."""
        projected, inner = np.zeros_like(self.inner), self.inner.copy()
        for group, null, hessian in self._bases:
            if not null.shape[-1]:
                continue
            shift = _shift(hessian, regularisation)[..., None, None]
            inner[:, group] += shift * np.eye(inner.shape[-1])
            inverse = np.linalg.inv(hessian + shift * np.eye(hessian.shape[-1]))
            projected[:, group] = null @ inverse @ null.swapaxes(-1, -2)
        follow = self.feasible - projected @ (self.cross + inner @ self.feasible)
        half = self.cross.swapaxes(-1, -2) @ follow
        reduced = self.outer + half + half.swapaxes(-1, -2) + follow.swapaxes(-1, -2) @ inner @ follow
        return Blocks(self.inverse, projected, inner, self.cross, follow, reduced)


def closing_rows(model: Model, states: Floats) -> Floats:
    """Derivative of the closing equations in z = (u, h, x1, x2 at the beginning), shape (..., 2, 2 K + 3)."""
    along1, along2 = _sensitivities(model, states)
    return np.stack([along1[:, :, -1], along2[:, :, -1]], axis=2) / model.closures[..., None]


def _sensitivities(model: Model, states: Floats) -> tuple[Floats, Floats]:
    """Derivatives of x1 and x2 where pieces begin, and at the end, in z = (u, h, x1, x2 at the beginning).

    Each of shape (n_segments, n_moving, K + 1, 2 K + 3).
    """
    first, second = model.gains
    _, x1, u0, u1, h = states
    pieces = model.pieces
    k = np.arange(pieces)
    run1 = np.zeros((*model.shape[:2], pieces + 1, 2 * pieces + 3))
    run2 = run1.copy()
    run1[:, :, k + 1, k] = run1[:, :, k + 1, k + 1] = first * h / 2
    run1[:, :, k + 1, pieces + 1 + k] = first * (u0 + u1) / 2
    run1[:, :, 0, -2] = run2[:, :, 0, -1] = 1.0
    summing = np.tril(np.ones((pieces + 1, pieces + 1)))
    along1 = summing @ run1
    run2[:, :, 1:] = (second * h)[..., None] * along1[:, :, :-1]
    both = first * second * h
    run2[:, :, k + 1, k] += both * h / 3
    run2[:, :, k + 1, k + 1] += both * h / 6
    run2[:, :, k + 1, pieces + 1 + k] += second * x1 + both * (2 * u0 + u1) / 3
    return along1, summing @ run2


def _assembled(model: Model, at: Pieces, local: Floats) -> tuple[Floats, Floats]:
    """Hessian in z, and the derivative of the closing equations, shapes (..., nz, nz) and (..., 2, nz)."""
    along1, along2 = _sensitivities(model, at.states)
    pieces = model.pieces
    k, size = np.arange(pieces), 2 * pieces + 3
    hessian = np.zeros((*model.shape[:2], size, size))
    columns = {U0: k, U1: k + 1, H: pieces + 1 + k}
    for a in (U0, U1, H):
        for b in (U0, U1, H):
            if a >= b:
                part = local[..., a, b] / (2 if a == b else 1)
                hessian[:, :, columns[a], columns[b]] += part
    for state, along in ((X1, along1), (X2, along2)):
        if state == X2 and not local[..., X2].any():
            break
        begin = along[:, :, :-1]
        half = 0.5 * local[..., state, state, None] * begin
        for a in (U0, U1, H):
            half[:, :, k, columns[a]] += local[..., a, state]
        if state == X2:
            half += local[..., X1, X2, None] * along1[:, :, :-1]
        hessian += half.swapaxes(-1, -2) @ begin
    closing = np.stack([along1[:, :, -1], along2[:, :, -1]], axis=2) / model.closures[..., None]
    return hessian + hessian.swapaxes(-1, -2), closing


def _partitioned(model: Model, hessian: Floats, closing: Floats, free: bool, shares: Floats) -> tuple[Floats, ...]:
    """Hyy, Hyt, Htt, Ey and Et."""
    pieces = model.pieces
    segments, joints = model.shape[:2]
    wide = np.arange(pieces + 1, 2 * pieces + 1)
    inside = np.concatenate([np.arange(1, pieces), wide]) if free else np.arange(1, pieces)
    ends = np.array([0, 2 * pieces + 1, 2 * pieces + 2, pieces])
    place = np.array([0, 1, 2, 3])
    inner = hessian[:, :, inside[:, None], inside]
    cross = np.zeros((segments, joints, len(inside), SHARED))
    outer = np.zeros((segments, joints, SHARED, SHARED))
    cross[..., place] = hessian[:, :, inside[:, None], ends]
    outer[..., place[:, None], place] = hessian[:, :, ends[:, None], ends]
    rows = np.zeros((segments, joints, 3, len(inside)))
    shared = np.zeros((segments, joints, 3, SHARED))
    rows[:, :, :2], shared[:, :, :2, :4] = closing[..., inside], closing[..., ends]
    shared[:, :, [0, 1], [4, 5]] = -1 / model.closures
    if free:
        rows[:, :, 2, pieces - 1 :] = 1.0
        shared[:, :, 2, 6] = -1.0
    else:
        along = (hessian[..., wide] @ shares[..., None])[..., 0]
        cross[..., 6] = along[..., inside]
        outer[..., place, 6] = outer[..., 6, place] = along[..., ends]
        outer[..., 6, 6] = (shares * along[..., wide]).sum(axis=-1)
        shared[:, :, :2, 6] = (closing[..., wide] @ shares[..., None])[..., 0]
    return inner, cross, outer, rows, shared


def split(rows: Floats) -> tuple[Floats, Floats]:
    """Right inverse P of the equations and a basis Z of their null space."""
    count = rows.shape[-2]
    basis, triangle = _reflected(rows.swapaxes(-1, -2))
    span, null = basis[..., :count], basis[..., count:]
    return (span @ np.linalg.inv(triangle).swapaxes(-1, -2) if count else span), null


def _reflected(columns: Floats) -> tuple[Floats, Floats]:
    """Full QR factorisation by Householder reflections of matrices with few columns."""
    size, count = columns.shape[-2:]
    left = np.broadcast_to(np.eye(size), (*columns.shape[:-2], size, size)).copy()
    work = columns.copy()
    for k in range(count):
        normal = work[..., k:, k].copy()
        normal[..., 0] += np.copysign(np.linalg.norm(normal, axis=-1), normal[..., 0])
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        normal = normal[..., None]
        work[..., k:, :] -= 2 * normal @ (normal.swapaxes(-1, -2) @ work[..., k:, :])
        left[..., k:] -= 2 * (left[..., k:] @ normal) @ normal.swapaxes(-1, -2)
    return left, work[..., :count, :]


def _shift(hessians: Floats, least: float) -> Floats:
    """Multiple of the identity, at least `least`, that makes every matrix positive definite, one for each."""
    shift = np.full(hessians.shape[:-2], least)
    try:
        np.linalg.cholesky(hessians + least * np.eye(hessians.shape[-1]))
    except np.linalg.LinAlgError:
        lowest = np.linalg.eigvalsh(hessians)[..., 0]
        first, factor = SHIFTS
        steps = np.ceil(np.log(np.maximum(-lowest, first) / first) / np.log(factor))
        shift = np.where(lowest + least <= 0, np.maximum(2 * first * factor**steps, least), shift)
    return shift
