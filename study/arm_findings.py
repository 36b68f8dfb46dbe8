"""Torque and the tool's rates, enclosed over whole intervals of time: what holds between the samples is proved, not hoped.

Each interval gives a number that the largest share there does not exceed, and one that it reaches. Intervals that could
hold the largest share of all, or of which it is open whether they keep the limit, are halved, until the two numbers are
within one part in a thousand and on one side of the limit. What stays open counts as broken.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from study import polynomial
from study.arm import ArmLimits
from study.findings import Finding
from study.parametric import ParametricTrajectory
from study.problem import Floats, Problem
from study.taylor import Model
from study.tolerances import ENCLOSED, TOLERANCE
from study.trajectory import Motion, Trajectory

ROUNDS, MOST, AT_ONCE = 48, 400_000, 4096
"""Halvings of an interval, intervals in all, and intervals that are measured at once, at most."""


@dataclass(frozen=True, eq=False)
class Enclosure:
    """Bounds of the largest share of every limit of an arm: torques by joint, the tool's speed and its acceleration.

    Attributes
    ----------
    lowest, highest : arrays of shape (n_joints + 2,)
        The largest share lies between the two; 0 where there is no limit.
    times : array of shape (n_joints + 2,), s
        When the lower one is reached.
    """

    lowest: Floats
    highest: Floats
    times: Floats

    @classmethod
    def none(cls, n_joints: int) -> Enclosure:
        """Enclosure for a problem that does not limit the arm."""
        return cls(*np.zeros((3, n_joints + 2)))


def arm_findings(problem: Problem, enclosure: Enclosure) -> Iterator[Finding]:
    """Say of every limit of an arm whether it is proved to be kept."""
    if problem.arm is None:
        return
    names = problem.arm.names(problem.joint_names)
    for name, low, high, time in zip(names, enclosure.lowest, enclosure.highest, enclosure.times, strict=True):
        said = f"reaches {low:.6g} of its limit at {time:.4f} s"
        if low <= 1 + TOLERANCE:
            said = f"is not proved to keep its limit: it may reach {high:.6g} of it"
        yield Finding(float(high) - 1.0, f"{name} {said}")


def enclosed(limits: ArmLimits | None, motion: Motion) -> Enclosure:
    """Enclose the largest share of every limit of an arm along a motion.

    Parameters
    ----------
    limits : ArmLimits, optional
    motion : Motion
        Of a kind that the study knows; of any other nothing is proved.
    """
    if limits is None:
        return Enclosure.none(motion.n_joints)
    pieces = _pieces(motion)
    if pieces is None:
        nothing = Enclosure.none(motion.n_joints)
        return replace(nothing, highest=nothing.highest + np.inf)
    best, times, proved = np.zeros((3, motion.n_joints + 2))
    piece, low, high = np.arange(pieces.count), np.zeros(pieces.count), np.ones(pieces.count)
    measured = 0
    for _ in range(ROUNDS):
        lows, places, highs = _measured(limits, pieces, piece, low, high)
        measured += len(piece)
        new = lows.max(axis=1)
        where = lows.argmax(axis=1)
        place = (low + high)[where] / 2 + places[np.arange(len(where)), where] * (high - low)[where] / 2
        times = np.where(new > best, pieces.times(piece[where], place), times)
        best = np.maximum(best, new)
        unsettled = (highs > _settled(best)[:, None]).any(axis=0)
        if (~unsettled).any():
            proved = np.maximum(proved, highs[:, ~unsettled].max(axis=1))
        if not unsettled.any() or measured > MOST:
            break
        middle = 0.5 * (low + high)[unsettled]
        piece = np.tile(piece[unsettled], 2)
        low, high = np.concatenate([low[unsettled], middle]), np.concatenate([middle, high[unsettled]])
    if unsettled.any():
        proved = np.maximum(proved, highs.max(axis=1))
    return Enclosure(best, np.maximum(proved, best), times)


def _settled(best: Floats) -> Floats:
    """Share up to which an interval need not be looked at more closely, given the largest share that is reached."""
    near = best * (1 + ENCLOSED)
    return np.where(
        (best <= 1 + TOLERANCE) & (near > 1 + TOLERANCE), np.maximum(1 + TOLERANCE, best * (1 + 1e-9)), near
    )


def _measured(
    limits: ArmLimits, pieces: _Pieces, piece: NDArray[np.intp], low: Floats, high: Floats
) -> tuple[Floats, Floats, Floats]:
    lows, places, highs = [], [], []
    with np.errstate(all="ignore"):  # what overflows is not proved
        for start in range(0, len(piece), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            rates = pieces.rates(piece[part], 0.5 * (low + high)[part], 0.5 * (high - low)[part])
            least, place, most = limits.shares(limits.mechanism.swing(*rates))
            lows.append(np.where(np.isfinite(least), least, 0.0))
            places.append(place)
            highs.append(np.where(np.isnan(most), np.inf, most))
    lowest, at, highest = (np.concatenate(parts, axis=1) for parts in (lows, places, highs))
    return lowest, at, highest


class _Pieces(Protocol):
    """Pieces of a motion over a parameter from 0 to 1 each."""

    @property
    def count(self) -> int:
        """Number of pieces."""

    def times(self, piece: NDArray[np.intp], place: Floats) -> Floats:
        """Times, s, of places on pieces, both of shape (n,)."""

    def rates(self, piece: NDArray[np.intp], middle: Floats, half: Floats) -> tuple[Model, Model, Model]:
        """Models of position, velocity and acceleration, shape (n_joints, n), on parts of pieces."""


def _pieces(motion: Motion) -> _Pieces | None:
    if isinstance(motion, Trajectory):
        return _InTime(motion)
    return _Parametric(motion) if isinstance(motion, ParametricTrajectory) else None


def _part(coefficients: Floats, middle: Floats, half: Floats) -> Model:
    """Model of polynomials of shape (n, n_joints, degree + 1) over the parts around their middles."""
    near = polynomial.stretched(polynomial.shifted(coefficients, middle[:, None]), half[:, None])
    return Model.of(near.transpose(2, 1, 0))


class _InTime:
    """Polynomials in time."""

    def __init__(self, motion: Trajectory) -> None:
        self._knots, self._widths = motion.knots, np.diff(motion.knots)
        unit = polynomial.stretched(np.moveaxis(motion.coefficients, 1, 2), self._widths[:, None])
        first = polynomial.derivative(unit) / self._widths[:, None, None]
        self._orders = (unit, first, polynomial.derivative(first) / self._widths[:, None, None])
        self.count = len(unit)

    def times(self, piece: NDArray[np.intp], place: Floats) -> Floats:
        return self._knots[piece] + place * self._widths[piece]

    def rates(self, piece: NDArray[np.intp], middle: Floats, half: Floats) -> tuple[Model, Model, Model]:
        position, velocity, acceleration = (_part(order[piece], middle, half) for order in self._orders)
        return position, velocity, acceleration


class _Parametric:
    """Time and positions as polynomials in a parameter."""

    def __init__(self, motion: ParametricTrajectory) -> None:
        time, position = motion.time[:, None, :], np.moveaxis(motion.position, 1, 2)
        self._time, self._start = motion.time, motion.time[0, 0]
        slopes = polynomial.derivative(time), polynomial.derivative(position)
        self._orders = (position, *slopes, *(polynomial.derivative(slope) for slope in slopes))
        self.count = len(position)

    def times(self, piece: NDArray[np.intp], place: Floats) -> Floats:
        return polynomial.value(self._time[piece], place) - self._start

    def rates(self, piece: NDArray[np.intp], middle: Floats, half: Floats) -> tuple[Model, Model, Model]:
        position, slope, first, bend, second = (_part(order[piece], middle, half) for order in self._orders)
        share = slope.inverse()
        velocity = first * share
        return position, velocity, (second - velocity * bend) * share * share
