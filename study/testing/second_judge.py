"""A second judge, for tests only, from another derivation than the first: Bernstein enclosures in extended precision.

The first judge finds extrema at the roots of derivatives. This one finds no root at all. A polynomial over [0, 1] lies between
the smallest and the largest of its Bernstein coefficients, and takes the first and the last; halving the interval draws
the coefficients together, so every supremum is enclosed as closely as one likes. The shape of a path is settled by halving
time: within a short time some polynomial place along the straight line is near enough to every joint, or at an instant none is.

References
----------
Farouki, The Bernstein polynomial basis: a centennial retrospective (2012), sections 4 and 6.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from study.limits import JointLimits
from study.problem import Problem, StraightPath
from study.testing.bernstein import GAP, Curve, Long, halved, stacked, suprema
from study.tolerances import TOLERANCE
from study.trajectory import Trajectory

HUGE = 1e300
"""Size beyond which the first judge may overflow on the way to a finite answer."""


class Answer(Enum):
    """Answer of the second judge."""

    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class SecondVerdict:
    """Enclosure of the largest relative excess over any demand."""

    low: float
    high: float

    @property
    def answer(self) -> Answer:
        """Answer to the question whether the demands are met, as far as the enclosure decides."""
        if self.high <= TOLERANCE:
            return Answer.FEASIBLE
        return Answer.INFEASIBLE if self.low > TOLERANCE else Answer.UNDECIDED


def second_judge(problem: Problem, motion: Trajectory) -> SecondVerdict:
    """Enclose the largest relative excess of a motion over everything that a problem demands.

    Parameters
    ----------
    problem : Problem
    motion : Trajectory
    """
    with np.errstate(all="ignore"):
        curve = Curve(motion)
        times = motion.waypoint_times
        ordered = bool((np.diff(times) >= 0).all()) and abs(times[0]) <= TOLERANCE * motion.duration
        if not ordered or abs(times[-1] - motion.duration) > TOLERANCE * motion.duration:
            return SecondVerdict(np.inf, np.inf)
        size = curve.size()
        if not size < HUGE:
            return SecondVerdict(0.0 if size <= np.finfo(float).max else np.inf, np.inf)
        points = [0.0, *(float(x) for x in _point_excesses(problem, curve))]
        low, high = suprema(stacked(list(_questions(problem, curve))))
        lows, highs = [max(points), low.max(initial=0.0) - 1], [max(points), high.max(initial=0.0) - 1]
        for inner, outer in _spells(problem, curve):
            lows.append(inner)
            highs.append(outer)
        return SecondVerdict(float(max(lows)), float(max(highs)))


def _questions(problem: Problem, curve: Curve) -> Iterator[Long]:
    """Polynomials that must nowhere exceed 1."""
    for segment, limits in [(None, problem.limits), *problem.segment_limits.items()]:
        derivatives = [curve.unit(order) if segment is None else curve.segment(segment, order) for order in range(4)]
        position = derivatives[0]
        for order in range(1, 4):
            yield from _within(derivatives[order], limits.highest_rates[order - 1], limits.lowest_rates[order - 1])
        yield from _inside(position, limits, problem.position_tolerance / TOLERANCE)


def _within(rate: Long, highest: NDArray[np.float64], lowest: NDArray[np.float64]) -> Iterator[Long]:
    for bound in (highest, lowest):
        limited = np.isfinite(bound)
        yield rate[:, limited] / bound[limited, None]


def _inside(position: Long, limits: JointLimits, scale: NDArray[np.float64]) -> Iterator[Long]:
    for bound, sign in ((limits.upper, 1.0), (limits.lower, -1.0)):
        limited = np.isfinite(bound)
        yield 1 + sign * (position[:, limited] - bound[limited, None]) / scale[limited, None]


def _point_excesses(problem: Problem, curve: Curve) -> Iterator[np.longdouble]:
    """Excesses at single instants: waypoints, steps at knots, ends and stops, and of the duration."""
    span = problem.position_tolerance / TOLERANCE
    allowed = problem.tolerances.copy()
    if isinstance(problem.path, StraightPath):
        allowed[1:-1] = np.maximum(allowed[1:-1], problem.path.of(problem.n_joints))
    for waypoint, time in enumerate(curve.passed):
        error = np.abs(curve.at(time) - problem.waypoints[waypoint])
        yield ((error - allowed[waypoint]) / span).max()
    every = [problem.limits, *problem.segment_limits.values()]
    limited = np.any([np.isfinite(limits.rates) for limits in every], axis=0)
    heavy = problem.arm is not None and problem.arm.forbids_steps
    held = [np.full(problem.n_joints, True), limited[1] | limited[2] | heavy, limited[2]]
    scales = [span, *(_scale(problem, curve, order) for order in (1, 2))]
    for order in range(3):
        unit = curve.unit(order)
        steps = np.abs(unit[1:, :, 0] - unit[:-1, :, -1])[:, held[order]] / scales[order][held[order]]
        yield steps.max(initial=0.0)
    for instant, state in zip((0, -1), problem.end_states, strict=True):
        time = curve.knots[instant]
        for order, rate in enumerate(state.rates, start=1):
            if rate is not None:
                off = np.abs(curve.at(time, order) - rate) / scales[order]
                yield off[held[order]].max(initial=0.0)
    for waypoint in {*problem.stops, *problem.dwells}:
        yield (np.abs(curve.at(curve.passed[waypoint], 1)) / scales[1])[held[1]].max(initial=0.0)
    if problem.timing is not None:
        yield np.longdouble(problem.timing.excess(float(curve.knots[-1])))


def _scale(problem: Problem, curve: Curve, order: int) -> Long:
    """Limits, or where there is none the size of the joint's largest rate."""
    coefficients = curve.unit(order)
    for _ in range(6):
        coefficients = np.concatenate(halved(coefficients))
    peak = np.abs(coefficients[..., [0, -1]]).max(axis=(0, 2))
    bound = problem.limits.rates[order - 1]
    scale = np.where(np.isfinite(bound), bound, np.maximum(peak, peak.max()))
    return np.where(scale > 0, scale, 1.0)


def _spells(problem: Problem, curve: Curve) -> Iterator[tuple[float, float]]:
    """Enclosures of the excess over spells of time: dwells and the shape of the path."""
    for waypoint, time in problem.dwells.items():
        start, following = curve.passed[waypoint : waypoint + 2]
        if start + time > following * (1 + 1e-15):
            late = float((start + time - following) / time)
            yield late, late
        part = curve.between(start, min(start + time, following))
        moved = np.ptp(part[..., [0, -1]], axis=(0, 2)) if part.size else np.full(problem.n_joints, np.inf)
        outer = np.ptp(part, axis=(0, 2)) if part.size else moved
        scale = problem.position_tolerance / TOLERANCE
        yield float((moved / scale).max()), float((outer / scale).max())
    if problem.path is not None:
        for segment in range(problem.n_segments):
            start, stop = curve.passed[segment : segment + 2]
            if start < stop:
                yield along_line(problem, curve.between(start, stop), segment)


def along_line(problem: Problem, parts: Long, segment: int) -> tuple[float, float]:
    """Decide whether a segment keeps near its line: (0, 0) where it does, (1, 1) where not, (0, 1) where undecided."""
    straight = isinstance(problem.path, StraightPath)
    radius = np.zeros(problem.n_joints) if problem.path is None else problem.path.of(problem.n_joints)
    line = _Line(problem, segment, problem.position_tolerance if straight else radius * (1 + TOLERANCE))
    corners = [problem.waypoints[k] for k in (segment, segment + 1) if straight and 0 < k < problem.n_waypoints - 1]
    for _ in range(40):
        edges = parts[..., 0]
        first, last = line.places(edges, 1 + GAP)
        free = [(np.abs(edges - corner) <= radius * (1 + GAP)).all(axis=1) for corner in corners]
        if ((first > last) & ~np.any(free, axis=0)).any():
            return 1.0, 1.0
        done = line.keeps(parts)
        for corner in corners:
            done |= (np.abs(parts - corner[:, None]) <= radius[:, None] * (1 + GAP)).all(axis=(1, 2))
        parts = parts[~done]
        if not len(parts):
            return 0.0, 0.0
        if len(parts) > 2000:
            break
        parts = np.concatenate(halved(parts))
    return 0.0, 1.0


class _Line:
    """Straight line of a segment with some room around it in every joint."""

    def __init__(self, problem: Problem, segment: int, room: NDArray[np.float64]) -> None:
        self.start = problem.waypoints[segment].astype(np.longdouble)
        self.step = problem.waypoints[segment + 1] - self.start
        self.room = room

    def places(self, positions: Long, share: float) -> tuple[Long, Long]:
        """First and last place on the line, from 0 to 1, within a share of the room; crossed where there is none.

        Positions have shape (n, n_joints).
        """
        low, high = (positions - self.start + sign * share * self.room for sign in (-1, 1))
        moving = self.step != 0
        away = ((low > 0) | (high < 0))[:, ~moving].any(axis=1)
        ends = np.stack([low[:, moving] / self.step[moving], high[:, moving] / self.step[moving]])
        first, last = ends.min(axis=0).max(axis=1, initial=0.0), ends.max(axis=0).min(axis=1, initial=1.0)
        return np.where(away, 2.0, first), last

    def keeps(self, parts: Long) -> NDArray[np.bool_]:
        """Parts for which a place near enough at every instant is known: the projection, or a linear run of places."""
        away = parts - self.start[:, None]
        weights = self.step / self.room**2
        norm = weights @ self.step
        projected = np.einsum("j,pjk->pk", weights / (norm if norm > 0 else 1.0), away)
        kept = self._fits(away, projected)
        middles = [0.5 * np.add(*self.places(parts[..., end], 1.0)) for end in (0, -1)]
        run = np.linspace(0.0, 1.0, parts.shape[-1])
        linear = np.clip(middles[0][:, None] * (1 - run) + middles[1][:, None] * run, 0.0, 1.0)
        return kept | self._fits(away, linear)

    def _fits(self, away: Long, places: Long) -> NDArray[np.bool_]:
        on_line = ((places >= -1e-13) & (places <= 1 + 1e-13)).all(axis=1)
        off = np.abs(away - self.step[:, None] * places[:, None, :])
        return on_line & (off <= (self.room * (1 - GAP))[:, None]).all(axis=(1, 2))
