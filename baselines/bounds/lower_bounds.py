"""Lower bound on the duration of every motion through the waypoints, whatever curve it takes.

Proof. Take any motion that passes the waypoints within the limits; let T_i be the time that it spends in segment i, and
v_i the velocity of one joint at waypoint i. Ranges of positions and end accelerations only make the set of motions
smaller, so leaving them out is safe.

1.  One joint, one segment. Put every waypoint velocity into one of finitely many cells. For every pair of cells at the
    segment's ends, `baselines.bounds.cell_times` bounds T_i from below by tau_i(cell, next cell).
2.  All joints spend the same time in a segment. So L_i, the largest over joints of the smallest tau_i over pairs of
    cells, is a lower bound on T_i, and in step 1 only T >= L_i have to be looked at; this matters where a joint can
    arrive early or late but not in between.
3.  All segments, all joints. For weights w_ij >= 0 that add up to 1 over the joints of every segment,

        sum_i T_i = sum_j sum_i w_ij T_i >= sum_j min over chains of cells of sum_i w_ij tau_ij(cell_i, cell_i+1),

    because each joint's own cells make one of the chains. The minimum over chains is found by dynamic programming.
4.  Refinement. Let U be the duration of some feasible motion. If the sum in step 3, with one joint's chains forced
    through one cell, is more than U, no motion faster than U uses that cell: it is dropped. The cells that are left are
    halved, and steps 1 to 3 are done again. Then every motion takes at least the smaller of U and the new sum.

Before step 1, jerk and velocity limits bound acceleration too where a motion starts and ends at rest. Say a joint
accelerates at a > 0. Under its jerk limit J it gains a^2 / (2 J) on the way there and as much again afterwards, unless
the motion starts or ends in between. If neither happens, a^2 / J <= 2 V. If it starts on the way there, it starts at
rest, so a^2 / (2 J) <= V; the same holds if it ends afterwards, and both cannot happen, for the joint would not be at
rest at both ends. So a <= sqrt(2 V J); for a < 0 by symmetry.

Any weights give a valid bound, so the search for good weights needs no proof; it is the dual of the choice of one
mixture of chains for every joint, solved by adding one chain per joint and round to a linear program. At rest at both
ends, the first and the last cell are the point 0; where the end condition is free, all cells are allowed there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from baselines.bounds.cell_times import SAFETY, Cells, shortest_times
from baselines.bounds.chain_weights import chain_weights
from baselines.closed_forms import rest_to_rest_time
from study.deadline import NEVER, Deadline
from study.problem import EndCondition, Floats, Problem

SMOOTHING = 0.5
"""Share of the best weights so far in the next ones: the linear program alone jumps from corner to corner."""

ROUNDS, TOLERANCE = 60, 1e-4
"""Linear programs per refinement, and the relative distance to the best that any weights can do at which they end."""

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


Grid = list[list[Cells]]
"""For every joint and every waypoint the cells that are left."""


def with_implied_acceleration(problem: Problem) -> Problem:
    """Lower acceleration limits to what jerk and velocity limits leave of them, where the motion rests at both ends."""
    velocity, acceleration, jerk = problem.limits.rates
    if problem.end is EndCondition.FREE:
        return problem
    implied = np.minimum(acceleration, np.sqrt(2 * velocity * jerk) * (1 + SAFETY))
    return replace(problem, limits=replace(problem.limits, acceleration=implied))


def first_cells(problem: Problem, n_cells: int, known: float) -> Grid:
    """Equal cells between the velocity limits; one that says nothing for a joint without what the bounds need.

    A joint without velocity limit is nowhere faster than A U, if it starts at rest and the motion takes at most U.
    """
    grid = []
    for velocity, acceleration in problem.limits.rates[:2].T:
        if np.isinf(velocity) and problem.end is not EndCondition.FREE:
            velocity = acceleration * known
        edges = np.linspace(-velocity, velocity, n_cells + 1) if np.isfinite([velocity, acceleration]).all() else None
        inner = Cells(np.array([-np.inf]), np.array([np.inf])) if edges is None else Cells(edges[:-1], edges[1:])
        rest = Cells(np.zeros(1), np.zeros(1))
        ends = inner if problem.end is EndCondition.FREE or edges is None else rest
        grid.append([ends, *[inner] * (problem.n_waypoints - 2), ends])
    return grid


def all_chains(problem: Problem, grid: Grid, deadline: Deadline = NEVER) -> list[Chains]:
    """Steps 1 and 2 for every joint; raises `DeadlineExceeded` where the deadline comes first."""
    at_least = np.zeros(problem.n_segments)
    for _ in range(2):
        joints = [_chains(problem, j, cells, at_least, deadline) for j, cells in enumerate(grid)]
        at_least = np.max([[times.min() for times in joint.times] for joint in joints], axis=0)
    return joints


def _chains(problem: Problem, joint: int, cells: list[Cells], at_least: Floats, deadline: Deadline) -> Chains:
    rates, steps = problem.limits.rates[:, joint], np.diff(problem.waypoints[:, joint])
    pairs = zip(steps.tolist(), at_least.tolist(), cells[:-1], cells[1:], strict=True)
    if np.isinf(cells[1].high).any():
        return Chains([np.full((1, 1), max(abs(d) / rates[0], least)) for d, least, _, _ in pairs])
    return Chains([shortest_times(d, start, end, rates, least) for d, least, start, end in in_time(pairs, deadline)])


@dataclass(frozen=True, eq=False)
class Proof:
    """Lower bound with the effort behind it.

    Attributes
    ----------
    value : float, s
        No motion through the waypoints within the limits is faster.
    rounds : int
        Linear programs solved.
    cells : int
        Cells that were left, over all joints and waypoints.
    """

    value: float
    rounds: int
    cells: int


def bound(
    problem: Problem,
    known: float = np.inf,
    n_cells: int = 64,
    refinements: int = 3,
    most_cells: int = 160,
    deadline: Deadline = NEVER,
) -> Proof:
    """Bound the duration of all motions from below.

    Parameters
    ----------
    problem : Problem
    known : float, s
        Duration of a motion that the judge finds feasible; the shorter, the tighter the bound. Stopping at every
        waypoint is known without being told.
    n_cells : int
        Cells of velocity between the limits at first, for every joint and waypoint.
    refinements : int
        How often cells are dropped and halved.
    most_cells : int
        Cells at one waypoint and joint that are not halved further.
    deadline : Deadline
        After it the best bound so far is returned, at first that of the velocity limits.
    """
    stops = float(rest_to_rest_time(np.diff(problem.waypoints, axis=0), problem.limits.rates).max(axis=1).sum())
    known, problem = min(known, stops) * (1 + SAFETY), with_implied_acceleration(problem)
    grid, best, rounds = first_cells(problem, n_cells, known), 0.0, 0
    for step in range(refinements + 1):
        try:
            joints = all_chains(problem, grid, deadline)
        except DeadlineExceeded:
            best = best or straight_time(problem)
            break
        value, weights, count = best_weights(joints, deadline)
        before, best, rounds = best, max(best, min(value * (1 - SAFETY), known)), rounds + count
        if step == refinements or best - before < TOLERANCE * best or deadline.passed():
            break
        grid = _refined(grid, joints, weights, known, most_cells)
        if not all(len(cells.low) for row in grid for cells in row):
            best = known  # no motion faster than the known one is left
            break
    return Proof(best / (1 + SAFETY), rounds, sum(len(cells.low) for row in grid for cells in row))


def straight_time(problem: Problem) -> float:
    """Sum of what every segment takes at the velocity limits, s: a bound that needs no cells."""
    return float((np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity).max(axis=1).sum())


def _refined(grid: Grid, joints: list[Chains], weights: Floats, known: float, most_cells: int) -> Grid:
    """Step 4: drop cells that no motion faster than the known one uses, and halve the others."""
    values = [joint.cheapest(weights[:, j])[0] for j, joint in enumerate(joints)]
    result = []
    for j, (joint, row) in enumerate(zip(joints, grid, strict=True)):
        room = known - (_added(values) - values[j])
        masks = [through <= room for through in joint.through(weights[:, j])]
        result.append([_halved(cells, mask, most_cells) for cells, mask in zip(row, masks, strict=True)])
    return result


def _added(values: Iterable[float]) -> float:
    """Add from left to right; the built-in `sum` rounds otherwise since Python 3.12."""
    return reduce(add, values)


def _halved(cells: Cells, mask: NDArray[np.bool_], most_cells: int) -> Cells:
    left = cells.picked(mask)
    return left.halved() if np.isfinite(left.high).all() and 2 * len(left.low) <= most_cells else left


def best_weights(joints: list[Chains], deadline: Deadline = NEVER) -> tuple[float, Floats, int]:
    """Search for the weights of step 3; after the deadline the best so far are good enough.

    Returns
    -------
    value : float, s
        The bound that they give.
    weights : array of shape (n_segments, n_joints)
    rounds : int
    """
    n_segments, n_joints = len(joints[0].times), len(joints)
    pool: list[list[Floats]] = [[] for _ in joints]
    trial = centre = np.full((n_segments, n_joints), 1.0 / n_joints)
    best, ceiling, done = -np.inf, np.inf, 0
    while done < ROUNDS and ceiling - best > TOLERANCE * best:
        if done and deadline.passed():
            break
        done += 1
        cheapest = [joint.cheapest(trial[:, j]) for j, joint in enumerate(joints)]
        value = _added(value for value, _ in cheapest)
        if value > best:
            best, centre = value, trial
        for chains, (_, times) in zip(pool, cheapest, strict=True):
            chains.append(times)
        corner, ceiling = chain_weights(pool)
        trial = SMOOTHING * centre + (1 - SMOOTHING) * corner
    return best, centre, done


def lower_bound(problem: Problem) -> float:
    """Lower bound on the time of any motion through the waypoints within the limits, s; see the module for the proof.

    Parameters
    ----------
    problem : Problem
    """
    return bound(problem).value
