"""A third opinion on motions, for tests only: dense samples by NumPy's own polynomials, with no extremum and no line of the judge."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from study.parametric import ParametricTrajectory
from study.problem import Floats, JointLimits, Problem, StraightPath
from study.testing.second_dynamics import arm_shares
from study.tolerances import TOLERANCE
from study.trajectory import Motion, Trajectory

PER_PIECE = 25
"""Samples of every polynomial, its ends among them."""

ROOM = 1.5
"""Times the judge's tolerance that rounding may add up to between two ways to calculate."""


@dataclass(frozen=True)
class Sampled:
    """Result of sampling a motion.

    Attributes
    ----------
    instants : int
    excess : float
        Largest relative excess over a demand, as the judge counts it.
    worst : str
        The demand that is exceeded most.
    """

    instants: int
    excess: float
    worst: str

    @property
    def confirmed(self) -> bool:
        """Whether no sample breaks a demand by more than rounding."""
        return bool(self.excess <= ROOM * TOLERANCE)


def sampled(problem: Problem, motion: Motion, per_piece: int = PER_PIECE) -> Sampled:
    """Hold samples of a motion against everything that a problem demands.

    Parameters
    ----------
    problem : Problem
    motion : Trajectory or ParametricTrajectory
    per_piece : int
    """
    with np.errstate(all="ignore"):
        samples = _Samples(problem, motion, per_piece)
        excesses = [(float(np.max(excess, initial=0.0)), name) for name, excess in samples.excesses()]
    excess, worst = max((np.inf if np.isnan(excess) else excess, name) for excess, name in excesses)
    return Sampled(samples.times.size, excess, worst)


class _Samples:
    """States of a motion, shape (4, n_pieces, per_piece, n_joints), and their times, shape (n_pieces, per_piece)."""

    def __init__(self, problem: Problem, motion: Motion, per_piece: int) -> None:
        self.problem, self.motion = problem, motion
        unit = np.linspace(0.0, 1.0, per_piece)[None, :, None]
        if isinstance(motion, Trajectory):
            self.coefficients = np.moveaxis(motion.coefficients, 1, 0)[:, :, None]
            inside = unit * np.diff(motion.knots)[:, None, None]
            self.states = np.stack([_value(self.coefficients, inside, order) for order in range(4)])
            self.times = motion.knots[:-1, None] + inside[..., 0]
        elif isinstance(motion, ParametricTrajectory):
            time, place = (
                [_value(np.moveaxis(part, 1, 0)[:, :, None], unit, order) for order in range(4)]
                for part in (motion.time[..., None], motion.position)
            )
            v = place[1] / time[1]
            a = (place[2] - v * time[2]) / time[1] ** 2
            j = (place[3] - 3 * a * time[1] * time[2] - v * time[3]) / time[1] ** 3
            self.states, self.times = np.stack([place[0], v, a, j]), time[0][..., 0] - motion.time[0, 0]
        else:
            raise TypeError(f"a {type(motion).__name__} cannot be sampled")
        self.passed = motion.waypoint_times
        self.span = problem.position_tolerance / TOLERANCE

    def at(self, waypoint: int) -> Floats:
        """States at a waypoint, shape (4, n_joints)."""
        if not isinstance(self.motion, Trajectory):  # a waypoint stands at every knot
            return self.states[:, -1, -1] if waypoint == len(self.passed) - 1 else self.states[:, waypoint, 0]
        knots, time = self.motion.knots, self.passed[waypoint]
        piece = min(max(int(np.searchsorted(knots, time, side="right")) - 1, 0), len(knots) - 2)
        here = np.full((1, 1, 1), time - knots[piece])
        return np.stack([_value(self.coefficients[:, piece : piece + 1], here, order)[0, 0] for order in range(4)])

    def excesses(self) -> Iterator[tuple[str, Any]]:
        """Demands by name, and relative excesses over each."""
        problem, allowed = self.problem, self.problem.tolerances.copy()
        yield "duration", 0.0 if problem.timing is None else problem.timing.excess(self.motion.duration)
        yield from self._within(problem.limits, np.ones(self.times.shape, dtype=bool), "limit")
        for segment, limits in problem.segment_limits.items():
            yield from self._within(limits, self._between(segment), f"limit of segment {segment}")
        if isinstance(problem.path, StraightPath):
            allowed[1:-1] = np.maximum(allowed[1:-1], problem.path.of(problem.n_joints))
        reached = np.stack([self.at(k)[0] for k in range(problem.n_waypoints)])
        yield "waypoints", (np.abs(reached - problem.waypoints) - allowed) / self.span
        yield "order of waypoints", float((np.diff(self.passed) < 0).any())
        yield from self._smooth()
        yield from self._still()
        if problem.arm is not None:
            states = self.states[:3].reshape(3, -1, problem.n_joints)
            shares = arm_shares(problem.arm, *states).max(axis=0, initial=0.0)
            yield from zip(problem.arm.names(problem.joint_names), shares - 1, strict=True)
        if problem.path is not None:
            yield "path", max(self._off_path(segment) for segment in range(problem.n_segments))

    def _within(self, limits: JointLimits, chosen: Any, name: str) -> Iterator[tuple[str, Any]]:
        for order in range(1, 4):
            rates = self.states[order][chosen]
            for bound in (limits.highest_rates[order - 1], limits.lowest_rates[order - 1]):
                yield f"{name} of order {order}", np.where(np.isfinite(bound), rates / bound - 1, 0.0)
        position = self.states[0][chosen]
        yield f"{name} of position", np.maximum(position - limits.upper, limits.lower - position) / self.span

    def _between(self, segment: int) -> Any:
        start, stop = self.passed[segment : segment + 2]
        room = 1e-9 * self.motion.duration
        return (self.times > start + room) & (self.times < stop - room)

    def _smooth(self) -> Iterator[tuple[str, Any]]:
        """Steps between pieces, and rates at both ends."""
        every = [self.problem.limits, *self.problem.segment_limits.values()]
        limited = np.any([np.isfinite(limits.rates) for limits in every], axis=0)
        heavy = self.problem.arm is not None and self.problem.arm.forbids_steps
        held = (np.ones(self.problem.n_joints, dtype=bool), limited[1] | limited[2] | heavy, limited[2])
        for order in range(3):
            scale = self.span
            if order:
                peaks, bound = np.abs(self.states[order]).max(axis=(0, 1)), self.problem.limits.rates[order - 1]
                scale = np.where(np.isfinite(bound), bound, np.maximum(peaks.max(), np.finfo(float).tiny))
            steps = np.abs(self.states[order, 1:, 0] - self.states[order, :-1, -1]) / scale
            yield f"steps of order {order}", steps[:, held[order]]
            for instant, state in zip((0, -1), self.problem.end_states, strict=True):
                rate = state.rates[order - 1] if order else None
                if rate is not None:
                    off = np.abs(self.states[order, instant, instant] - rate) / scale
                    yield f"end rates of order {order}", off[held[order]]
            if order == 1:
                stops = {*self.problem.stops, *self.problem.dwells}
                yield "stops", [np.abs(self.at(k)[1] / scale)[held[1]].max(initial=0.0) for k in stops]

    def _still(self) -> Iterator[tuple[str, Any]]:
        for waypoint, time in self.problem.dwells.items():
            start, following = self.passed[waypoint : waypoint + 2]
            spell = (self.times >= start) & (self.times <= start + time)
            positions = np.concatenate([self.at(waypoint)[:1], self.states[0][spell]])
            yield "dwells", np.maximum(np.ptp(positions, axis=0) / self.span, (start + time - following) / time)

    def _off_path(self, segment: int) -> float:
        """1 where a sample has no place on the straight line near enough to all its joints, else 0."""
        problem, path = self.problem, self.problem.path
        straight = isinstance(path, StraightPath)
        radius = np.zeros(problem.n_joints) if path is None else path.of(problem.n_joints)
        room = (problem.position_tolerance if straight else radius) * (1 + ROOM * TOLERANCE)
        start, step = problem.waypoints[segment], np.diff(problem.waypoints[segment : segment + 2], axis=0)[0]
        positions = self.states[0][self._between(segment)]
        ends = np.sort([(positions - start - room) / step, (positions - start + room) / step], axis=0)
        away = (np.abs(positions - start) > room) & (step == 0)
        first = np.where(step == 0, 0.0, ends[0]).max(axis=1, initial=0.0)
        last = np.where(step == 0, 1.0, ends[1]).min(axis=1, initial=1.0)
        off = (first > last) | away.any(axis=1)
        for corner in (segment, segment + 1):
            if straight and 0 < corner < problem.n_waypoints - 1:
                near = np.abs(positions - problem.waypoints[corner]) <= radius * (1 + ROOM * TOLERANCE)
                off &= ~near.all(axis=1)
        return float(off.any())


def _value(coefficients: Any, where: Any, order: int) -> Any:
    """Derivative of polynomials: coefficients of shape (degree + 1, n_pieces, 1, n_joints) at (n_pieces, n, 1)."""
    return polyval(where, polyder(coefficients, order) if order else coefficients, tensor=False)
