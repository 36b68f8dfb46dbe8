"""Everything that moves: one interface, and one exact piecewise polynomial in time that meets it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from study import polynomial
from study.arrays import index_in, positive, row, whole
from study.errors import StudyError, short
from study.problem import Floats, frozen_array


class Extrema(NamedTuple):
    """Smallest and largest value of every joint and when they occur; all arrays of shape (n_joints,)."""

    lowest: Floats
    at_lowest: Floats
    highest: Floats
    at_highest: Floats

    @property
    def peak(self) -> Floats:
        """Largest absolute value, shape (n_joints,)."""
        return np.maximum(-self.lowest, self.highest)

    @property
    def at_peak(self) -> Floats:
        """Time of the largest absolute value, shape (n_joints,), s."""
        return np.where(-self.lowest > self.highest, self.at_lowest, self.at_highest)


@runtime_checkable
class Motion(Protocol):
    """Interface of a motion for the judge, the report and the recording."""

    @property
    def knots(self) -> Floats:
        """Times where pieces meet, shape (n_pieces + 1,), s, from 0 to the duration."""

    @property
    def waypoint_times(self) -> Floats:
        """Times at which the waypoints are passed, shape (n_waypoints,), s."""

    @property
    def duration(self) -> float:
        """Total time, s."""

    @property
    def n_joints(self) -> int:
        """Number of joints."""

    def __call__(self, t: ArrayLike, order: int = 0) -> Floats:
        """Position or its derivative of the given order, shape (n_times, n_joints)."""

    def extrema(self, order: int = 0) -> Extrema:
        """Exact extrema of the derivative of the given order over the whole motion."""

    def jumps(self, order: int = 0) -> Floats:
        """Steps at inner knots, right minus left, shape (n_pieces - 1, n_joints)."""

    def scaled(self, factor: float) -> Motion:
        """Run the same path `factor` times as slowly."""

    def joints(self, indices: list[int]) -> Motion:
        """Keep some of the joints."""

    def between(self, start: float, stop: float) -> Motion:
        """Part of the motion between two times, s, as a motion of its own that starts at 0."""

    def mapped(self, matrix: Floats, offset: Floats) -> Motion:
        """Image under an affine map: matrix of shape (n_images, n_joints), offset of shape (n_images,)."""

    def crossings(self, levels: Floats) -> Floats:
        """Times, s, that include every instant at which a joint passes its level; levels of shape (n_joints,)."""


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


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A motion that is a polynomial in time between knots.

    Parameters
    ----------
    knots : array of shape (n_pieces + 1,), s
        Strictly increasing from 0.
    coefficients : array of shape (n_pieces, degree + 1, n_joints), rad/s^k or m/s^k
        Ascending powers of the time since the piece's own first knot.
    waypoint_times : array of shape (n_waypoints,), s

    Raises
    ------
    StudyError
        If shapes disagree, a number is not finite, or knots do not increase from 0.
    """

    knots: Floats
    coefficients: Floats
    waypoint_times: Floats

    def __post_init__(self) -> None:
        for name in ("knots", "coefficients", "waypoint_times"):
            array = frozen_array(getattr(self, name), f"trajectory: {name}")
            if not np.isfinite(array).all():
                raise StudyError(f"trajectory: {name} must be finite")
            object.__setattr__(self, name, array)
        if self.coefficients.ndim != 3 or self.knots.shape != (len(self.coefficients) + 1,):
            raise StudyError(
                "trajectory: coefficients must have shape (n_pieces, degree + 1, n_joints) and knots n_pieces + 1 entries, "
                f"got {self.coefficients.shape} and {self.knots.shape}"
            )
        if self.knots[0] != 0 or (np.diff(self.knots) <= 0).any():
            raise StudyError("trajectory: knots must start at 0 and increase strictly")

    @classmethod
    def from_pieces(cls, durations: Floats, coefficients: Floats, pieces_per_segment: ArrayLike = 1) -> Trajectory:
        """Join pieces of the given durations; a waypoint stands after every so many pieces.

        Parameters
        ----------
        durations : array of shape (n_pieces,), s
        coefficients : array of shape (n_pieces, degree + 1, n_joints)
        pieces_per_segment : int or array of int of shape (n_segments,)

        Raises
        ------
        StudyError
            As for the motion itself, or if the segments have another number of pieces together.
        """
        knots = np.concatenate([[0.0], np.cumsum(np.atleast_1d(frozen_array(durations, "durations of pieces")))])
        counts = frozen_array(pieces_per_segment, "pieces of a segment")
        if counts.ndim == 0 and counts > 0:
            counts = np.full(int((len(knots) - 1) // counts), counts)
        if counts.ndim != 1 or (counts < 1).any() or (counts % 1).any() or counts.sum() != len(knots) - 1:
            raise StudyError(f"whole numbers of pieces of the segments must add up to all {len(knots) - 1} pieces")
        marks = np.concatenate([[0], np.cumsum(counts.astype(int))])
        return cls(knots, coefficients, knots[marks])

    @property
    def duration(self) -> float:
        """Total time, s."""
        return float(self.knots[-1])

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return int(self.coefficients.shape[2])

    @property
    def degree(self) -> int:
        """Highest power of time."""
        return int(self.coefficients.shape[1]) - 1

    def __call__(self, t: ArrayLike, order: int = 0) -> Floats:
        """Position or its derivative of the given order, shape (n_times, n_joints); times are clipped to the motion."""
        times = instants(t, self.duration)
        piece = np.clip(np.searchsorted(self.knots, times, side="right") - 1, 0, len(self.coefficients) - 1)
        ascending = np.moveaxis(self._coefficients(order), 1, 2)
        return polynomial.value(ascending[piece], (times - self.knots[piece])[:, None])

    def _coefficients(self, order: int) -> Floats:
        result: Floats = np.moveaxis(self.coefficients, 1, 2)
        for _ in range(derivative(order)):
            result = polynomial.derivative(result)
        return np.moveaxis(result, 2, 1)

    @cached_property
    def _known(self) -> dict[int, Extrema]:
        return {}

    def extrema(self, order: int = 0) -> Extrema:
        """Exact extrema of the derivative of the given order over the whole motion."""
        if derivative(order) not in self._known:
            self._known[order] = self._extrema(order)
        return self._known[order]

    def _extrema(self, order: int) -> Extrema:
        widths = np.diff(self.knots)
        unit = polynomial.stretched(np.moveaxis(self._coefficients(order), 1, 2), widths[:, None])
        mask = polynomial.may_be_extreme(unit)
        lowest, highest = np.full(mask.shape, np.inf), np.full(mask.shape, -np.inf)
        at_lowest, at_highest = np.zeros(mask.shape), np.zeros(mask.shape)
        lowest[mask], at_lowest[mask], highest[mask], at_highest[mask] = polynomial.extrema(unit[mask])
        columns = np.arange(self.n_joints)
        low, high = lowest.argmin(axis=0), highest.argmax(axis=0)
        return Extrema(
            lowest[low, columns],
            self.knots[low] + at_lowest[low, columns] * widths[low],
            highest[high, columns],
            self.knots[high] + at_highest[high, columns] * widths[high],
        )

    def jumps(self, order: int = 0) -> Floats:
        """Steps at inner knots, right minus left, shape (n_pieces - 1, n_joints)."""
        ascending = np.moveaxis(self._coefficients(order), 1, 2)
        widths = np.diff(self.knots)[:-1, None]
        return ascending[1:, :, 0] - polynomial.value(ascending[:-1], widths)

    def scaled(self, factor: float) -> Trajectory:
        """Run the same path `factor` times as slowly."""
        factor = positive(factor, "the factor of a slower run")
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):  # what is not finite is refused
            powers = factor ** np.arange(self.degree + 1)
            knots, times = self.knots * factor, self.waypoint_times * factor
            return Trajectory(knots, self.coefficients / powers[:, None], times)

    def joints(self, indices: list[int]) -> Trajectory:
        """Keep some of the joints."""
        return replace(self, coefficients=self.coefficients[:, :, chosen(indices, self.n_joints)])

    def between(self, start: float, stop: float) -> Trajectory:
        """Part of the motion between two times, s, as a motion of its own that starts at 0."""
        start, stop, first, last = window(self.knots, start, stop)
        pieces = np.moveaxis(self.coefficients[first:last], 1, 2).copy()
        pieces[0] = polynomial.shifted(pieces[0], start - self.knots[first])
        knots = np.concatenate([[start], self.knots[first + 1 : last], [stop]]) - start
        return Trajectory(knots, np.moveaxis(pieces, 2, 1), knots[[0, -1]])

    def mapped(self, matrix: Floats, offset: Floats) -> Trajectory:
        """Image under an affine map: matrix of shape (n_images, n_joints), offset of shape (n_images,)."""
        matrix, offset = affine(matrix, offset, self.n_joints)
        coefficients = self.coefficients @ matrix.T
        coefficients[:, 0] += offset
        return replace(self, coefficients=coefficients)

    def crossings(self, levels: Floats) -> Floats:
        """Times, s, that include every instant at which a joint passes its level; levels of shape (n_joints,)."""
        widths = np.diff(self.knots)
        unit = polynomial.stretched(np.moveaxis(self.coefficients, 1, 2), widths[:, None])
        unit[:, :, 0] -= row(levels, self.n_joints, "levels to cross")
        return np.unique(self.knots[:-1, None, None] + polynomial.roots(unit) * widths[:, None, None])
