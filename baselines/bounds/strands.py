"""One joint through some of the waypoints: cells and least times between them; see `baselines.bounds.lower_bounds`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from baselines.bounds.cell_times import Cells, first_times, past_gaps
from baselines.bounds.joined_times import SAFETY
from study.deadline import NEVER, Deadline
from study.problem import EndCondition, Floats, Problem

T = TypeVar("T")


class DeadlineExceeded(Exception):
    """The deadline came in the middle of a step; what the steps before it proved holds."""


def in_time(items: Iterable[T], deadline: Deadline) -> Iterator[T]:
    """Hand items out until the deadline; then raise `DeadlineExceeded`."""
    for item in items:
        if deadline.passed():
            raise DeadlineExceeded
        yield item


@dataclass(frozen=True, eq=False)
class Chains:
    """One joint's bounds on all segments: for every segment an array of shape (n_start_cells, n_end_cells), s."""

    times: list[Floats]

    def cheapest(self, weights: Floats) -> tuple[float, Floats]:
        """Minimise the weighted sum of times over chains of cells, by dynamic programming from the last waypoint.

        Parameters
        ----------
        weights : array of shape (n_segments,)

        Returns
        -------
        value : float, s
        times : array of shape (n_segments,), s
            The times along the cheapest chain.
        """
        onward = self.onward(weights)
        cell = int(onward[0].argmin())
        chain = []
        for weight, times, value in zip(weights, self.times, onward[1:], strict=True):
            following = int((weight * times[cell] + value).argmin())
            chain.append(times[cell, following])
            cell = following
        return float(onward[0].min()), np.array(chain)

    def onward(self, weights: Floats) -> list[Floats]:
        """Cheapest weighted sum from every cell of every waypoint to the end, s."""
        values = [np.zeros(self.times[-1].shape[1])]
        for weight, times in zip(weights[::-1], self.times[::-1], strict=True):
            values.append((weight * times + values[-1]).min(axis=1))
        return values[::-1]

    def through(self, weights: Floats) -> list[Floats]:
        """Cheapest weighted sum of all chains through every cell of every waypoint, s."""
        back = Chains([times.T for times in self.times[::-1]]).onward(weights[::-1])[::-1]
        return [before + after for before, after in zip(back, self.onward(weights), strict=True)]


@dataclass(frozen=True, eq=False)
class Strand:
    """One joint through some of the waypoints, the first and the last among them: the cells that are left there."""

    joint: int
    points: NDArray[np.intp]
    cells: list[Cells]

    @property
    def cover(self) -> NDArray[np.intp]:
        """The strand's part that each segment of the problem lies in, shape (n_segments,)."""
        return np.repeat(np.arange(len(self.points) - 1), np.diff(self.points))

    @property
    def says_nothing(self) -> bool:
        """Whether nothing but the limit of velocity is known of the joint."""
        return bool(np.isinf(self.cells[0].high).any())


def first_strands(problem: Problem, n_cells: int, known: float, strides: Iterable[int] = (1,)) -> list[Strand]:
    """Every joint through every waypoint, every second and so on, with equal cells between the velocity limits.

    One cell says nothing for a joint without what the bounds need. A joint without velocity limit is nowhere faster
    than A U, if it starts at rest and the motion takes at most U.
    """
    strands, n = [], problem.n_segments
    for joint, (velocity, acceleration) in enumerate(problem.limits.rates[:2].T):
        if np.isinf(velocity) and problem.end is not EndCondition.FREE:
            velocity = acceleration * known
        if not np.isfinite([velocity, acceleration]).all():
            unknown = Cells(np.array([-np.inf]), np.array([np.inf]))
            strands.append(Strand(joint, np.arange(n + 1), [unknown] * (n + 1)))
            continue
        edges, rest = np.linspace(-velocity, velocity, n_cells + 1), np.zeros(1)
        inner = Cells(edges[:-1], edges[1:])
        steepest = 0.0 if problem.end is EndCondition.SMOOTH else np.inf
        ends = inner if problem.end is EndCondition.FREE else Cells(rest, rest, steepest)
        for parts in sorted({-(-n // stride) for stride in strides}, reverse=True):
            points = np.round(np.linspace(0, n, parts + 1)).astype(np.intp)
            strands.append(Strand(joint, points, [ends, *[inner] * (parts - 1), ends]))
    return strands


def all_chains(problem: Problem, strands: list[Strand], deadline: Deadline = NEVER) -> list[Chains]:
    """Steps 1 and 2 for every strand; raises `DeadlineExceeded` where the deadline comes first."""
    first = [_first_times(problem, strand, deadline) for strand in strands]
    at_least = np.zeros(problem.n_segments)
    for _ in range(2):
        chains = [
            _chains(problem, strand, times, at_least, deadline) for strand, times in zip(strands, first, strict=True)
        ]
        for strand, bounds in zip(strands, chains, strict=True):
            if len(strand.points) > problem.n_segments:
                at_least = np.maximum(at_least, [times.min() for times in bounds.times])
    return chains


def _first_times(problem: Problem, strand: Strand, deadline: Deadline) -> list[Floats]:
    rates, steps = problem.limits.rates[:, strand.joint], np.diff(problem.waypoints[strand.points, strand.joint])
    if strand.says_nothing:
        return [np.full((1, 1), abs(d) / rates[0]) for d in steps.tolist()]
    pairs = zip(steps.tolist(), strand.cells[:-1], strand.cells[1:], strict=True)
    return [first_times(d, start, end, rates) for d, start, end in in_time(pairs, deadline)]


def _chains(problem: Problem, strand: Strand, first: list[Floats], at_least: Floats, deadline: Deadline) -> Chains:
    rates, steps = problem.limits.rates[:, strand.joint], np.diff(problem.waypoints[strand.points, strand.joint])
    known = np.add.reduceat(at_least, strand.points[:-1]) * (1 - SAFETY)
    times = [np.maximum(least, bound) for least, bound in zip(first, known.tolist(), strict=True)]
    if strand.says_nothing:
        return Chains(times)
    pairs = zip(times, steps.tolist(), strand.cells[:-1], strand.cells[1:], strict=True)
    return Chains([past_gaps(time, d, start, end, rates) for time, d, start, end in in_time(pairs, deadline)])
