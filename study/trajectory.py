"""Everything that moves: one interface, and one exact piecewise polynomial in time that meets it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from study import polynomial
from study.arrays import positive, row
from study.errors import StudyError
from study.motion_arguments import affine, chosen, derivative, instants, window
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
        if counts.ndim != 1 or (counts < 0).any() or (counts % 1).any() or counts.sum() != len(knots) - 1:
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
