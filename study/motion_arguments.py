"""Arguments of the methods of every motion, read or refused with one sentence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from study.arrays import Floats, frozen_array, index_in, row, whole
from study.errors import StudyError, short

HIGHEST = 20
"""Order of the highest derivative that is asked for."""


def instants(t: ArrayLike, duration: float) -> Floats:
    """Read times, clipped to a motion, shape (n_times,), s.

    Raises
    ------
    StudyError
        If they are no row of numbers.
    """
    times = np.atleast_1d(frozen_array(t, "times"))
    if times.ndim != 1:
        raise StudyError(f"times must be one number or a row of them, got shape {times.shape}")
    return np.clip(times, 0.0, duration)


def derivative(order: int) -> int:
    """Read the order of a derivative.

    Raises
    ------
    StudyError
        If it is no whole number from 0 to `HIGHEST`.
    """
    return whole(order, 0, "the order of a derivative", HIGHEST)


def chosen(indices: Sequence[int], n_joints: int) -> list[int]:
    """Read numbers of joints, counted from 0."""
    if not isinstance(indices, list | tuple | range | np.ndarray):
        raise StudyError(f"joints are chosen by a list of their numbers, got {short(indices)}")
    return [index_in(index, range(n_joints), "joint") for index in indices]


def affine(matrix: ArrayLike, offset: ArrayLike, n_joints: int) -> tuple[Floats, Floats]:
    """Read an affine map of joints: matrix of shape (n_images, n_joints), offset of shape (n_images,).

    Raises
    ------
    StudyError
        If they are anything else.
    """
    factors = frozen_array(matrix, "the matrix of a map")
    if factors.ndim != 2 or factors.shape[1] != n_joints:
        raise StudyError(
            f"the matrix of a map must have {n_joints} columns, one for each joint, got shape {factors.shape}"
        )
    return factors, row(offset, len(factors), "the offset of a map")


def window(knots: Floats, start: float, stop: float) -> tuple[float, float, int, int]:
    """Snap a part of a motion to knots that differ from its ends by rounding only, and find the pieces that it touches.

    Returns
    -------
    start, stop : float, s
    first, last : int
        The pieces are `first` to `last - 1`.

    Raises
    ------
    StudyError
        If the part is empty or leaves the motion.
    """
    ends = frozen_array([start, stop], "the ends of a part of a motion")
    if ends.shape != (2,):
        raise StudyError(f"a part of a motion runs between two times, got {short(start)} and {short(stop)}")
    start, stop = map(float, ends)
    near = [float(knots[np.abs(knots - t).argmin()]) for t in (start, stop)]
    rounding = 1e-12 * knots[-1]
    begin, end = (k if abs(k - t) <= rounding else float(t) for k, t in zip(near, (start, stop), strict=True))
    if begin >= end:
        begin, end = start, stop
    if not 0 <= begin < end <= knots[-1]:
        raise StudyError(f"a part of a motion of {knots[-1]:g} s cannot run from {start:g} to {stop:g} s")
    return begin, end, int(np.searchsorted(knots, begin, side="right")) - 1, int(np.searchsorted(knots, end))
