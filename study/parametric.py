"""The sibling of the piecewise polynomial: time and positions over a common parameter, with rates rational in it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import polynomial
from study.arrays import positive, row
from study.errors import StudyError
from study.motion_arguments import affine, chosen, derivative, instants, window
from study.problem import Floats, frozen_array
from study.trajectory import Extrema


@dataclass(frozen=True, eq=False)
class ParametricTrajectory:
    """A motion given by time t(u) and positions q(u), both piecewise cubic over the same unit pieces.

    Its rates are rational in u: velocity q'/t', acceleration N/t'^3 with N = q''t' - q't'', jerk M/t'^5 with
    M = N't' - 3Nt''. Their extrema are roots of N, M and M't' - 5Mt''.

    Parameters
    ----------
    time : array of shape (n_pieces, degree + 1), s
        Ascending powers of u in [0, 1]; strictly increasing over every piece.
    position : array of shape (n_pieces, degree + 1, n_joints), rad or m

    Raises
    ------
    StudyError
        If shapes disagree or time does not increase strictly.
    """

    time: Floats
    position: Floats

    def __post_init__(self) -> None:
        for name in ("time", "position"):
            object.__setattr__(self, name, frozen_array(getattr(self, name), f"parametric trajectory: {name}"))
            if not np.isfinite(getattr(self, name)).all():
                raise StudyError(f"parametric trajectory: {name} must be finite")
        if self.time.ndim != 2 or self.position.ndim != 3 or len(self.time) != len(self.position) or not self.time.size:
            raise StudyError(
                "parametric trajectory: time and position need one row of coefficients per piece, "
                f"got {self.time.shape} and {self.position.shape}"
            )
        if not (polynomial.extrema(polynomial.derivative(self.time))[0] > 0).all():
            raise StudyError("parametric trajectory: t(u) must increase strictly; the durations are too uneven")

    @property
    def knots(self) -> Floats:
        """Times where pieces meet, shape (n_pieces + 1,), s."""
        return np.append(self.time[:, 0], self.time[-1].sum()) - self.time[0, 0]

    @property
    def waypoint_times(self) -> Floats:
        """Times at which the waypoints are passed: the knots, s."""
        return self.knots

    @property
    def duration(self) -> float:
        """Total time, s."""
        return float(self.knots[-1])

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return int(self.position.shape[2])

    def rate(self, order: int) -> tuple[Floats, Floats]:
        """Numerator (n_pieces, n_joints, k) and denominator (n_pieces, 1, l) of a derivative, as polynomials in u."""
        return rational_rate(self.time[:, None, :], np.moveaxis(self.position, 1, 2), derivative(order))

    def __call__(self, t: ArrayLike, order: int = 0) -> Floats:
        """Position or its derivative of the given order, shape (n_times, n_joints); times are clipped to the motion."""
        times = instants(t, self.duration)
        piece = np.clip(np.searchsorted(self.knots, times, side="right") - 1, 0, len(self.time) - 1)
        u = self._parameters(times, piece)
        over, under = self.rate(order)
        return polynomial.value(over[piece], u) / polynomial.value(under[piece], u)

    def _parameters(self, times: Floats, piece: NDArray[np.intp]) -> Floats:
        """Parameter u of every time within its piece, shape (n_times, 1)."""
        late = self.time[piece].copy()
        late[:, 0] -= times + self.time[0, 0]
        candidates = np.pad(polynomial.roots(late), ((0, 0), (1, 1)), constant_values=((0, 0), (0, 1)))
        errors = np.abs(polynomial.value(late[:, None, :], candidates))
        return np.take_along_axis(candidates, errors.argmin(axis=1, keepdims=True), 1)

    def extrema(self, order: int = 0) -> Extrema:
        """Exact extrema of the derivative of the given order over the whole motion."""
        time, position = self.time[:, None, :], np.moveaxis(self.position, 1, 2)
        points, values = rational_candidates(time, position, derivative(order))
        lowest, at_lowest, highest, at_highest = polynomial.pick_extrema(points, values)
        columns = np.arange(self.n_joints)
        low, high = lowest.argmin(axis=0), highest.argmax(axis=0)
        start = self.time[0, 0]
        return Extrema(
            lowest[low, columns],
            polynomial.value(self.time[low], at_lowest[low, columns]) - start,
            highest[high, columns],
            polynomial.value(self.time[high], at_highest[high, columns]) - start,
        )

    def jumps(self, order: int = 0) -> Floats:
        """Steps at inner knots, right minus left, shape (n_pieces - 1, n_joints)."""
        over, under = self.rate(order)
        left = polynomial.value(over, np.ones(1)) / polynomial.value(under, np.ones(1))
        right = polynomial.value(over, np.zeros(1)) / polynomial.value(under, np.zeros(1))
        return right[1:] - left[:-1]

    def scaled(self, factor: float) -> ParametricTrajectory:
        """Run the same path `factor` times as slowly."""
        with np.errstate(over="ignore"):  # what is not finite is refused
            return replace(self, time=self.time * positive(factor, "the factor of a slower run"))

    def joints(self, indices: list[int]) -> ParametricTrajectory:
        """Keep some of the joints."""
        return replace(self, position=self.position[:, :, chosen(indices, self.n_joints)])

    def between(self, start: float, stop: float) -> ParametricTrajectory:
        """Part of the motion between two times, s, as a motion of its own that starts at 0."""
        start, stop, first, last = window(self.knots, start, stop)
        time, position = self.time[first:last].copy(), np.moveaxis(self.position[first:last], 1, 2).copy()
        ends = np.array([start, stop])
        inside = self._parameters(ends, np.array([first, last - 1]))[:, 0]
        low, high = np.where(ends == self.knots[[first, last]], [0.0, 1.0], inside)
        for pieces in (time, position):
            pieces[0] = polynomial.clipped(pieces[0], low, high if len(time) == 1 else 1.0)
            if len(time) > 1:
                pieces[-1] = polynomial.clipped(pieces[-1], 0.0, high)
        return ParametricTrajectory(time, np.moveaxis(position, 2, 1))

    def mapped(self, matrix: Floats, offset: Floats) -> ParametricTrajectory:
        """Image under an affine map: matrix of shape (n_images, n_joints), offset of shape (n_images,)."""
        matrix, offset = affine(matrix, offset, self.n_joints)
        position = self.position @ matrix.T
        position[:, 0] += offset
        return replace(self, position=position)

    def crossings(self, levels: Floats) -> Floats:
        """Times, s, that include every instant at which a joint passes its level; levels of shape (n_joints,)."""
        unit = np.moveaxis(self.position, 1, 2).copy()
        unit[:, :, 0] -= row(levels, self.n_joints, "levels to cross")
        return np.unique(polynomial.value(self.time[:, None, None, :], polynomial.roots(unit))) - self.time[0, 0]


def rational_rate(time: Floats, position: Floats, order: int) -> tuple[Floats, Floats]:
    """Numerator and denominator, in u, of the derivative of q(u) with respect to t(u); leading axes broadcast."""
    if order == 0:
        return position, np.ones((*time.shape[:-1], 1))
    slope = polynomial.derivative(time)
    numerator, power = polynomial.derivative(position), 1
    for _ in range(order - 1):
        numerator = _next_numerator(numerator, slope, power)
        power += 2
    denominator = slope
    for _ in range(power - 1):
        denominator = polynomial.product(denominator, slope)
    return numerator, denominator


def _next_numerator(numerator: Floats, slope: Floats, power: int) -> Floats:
    """Differentiate numerator / slope^power by t: the new numerator, over slope^(power + 2)."""
    first = polynomial.product(polynomial.derivative(numerator), slope)
    second = power * polynomial.product(numerator, polynomial.derivative(slope))
    width = max(first.shape[-1], second.shape[-1])
    pads = [[(0, 0)] * (a.ndim - 1) + [(0, width - a.shape[-1])] for a in (first, second)]
    return np.pad(first, pads[0]) - np.pad(second, pads[1])


def rational_candidates(time: Floats, position: Floats, order: int) -> tuple[Floats, Floats]:
    """Points of [0, 1] that include every extremum of a derivative, and its values there, both (..., n_points)."""
    numerator, _ = rational_rate(time, position, order)
    slope = polynomial.derivative(time)
    critical = polynomial.roots(
        polynomial.derivative(position) if order == 0 else _next_numerator(numerator, slope, 2 * order - 1)
    )
    edge = np.zeros((*critical.shape[:-1], 1))
    points = np.concatenate([edge, critical, edge + 1.0], axis=-1)
    values = polynomial.value(numerator[..., None, :], points)
    if order:
        values = values / polynomial.value(slope[..., None, :], points) ** (2 * order - 1)
    return points, values
