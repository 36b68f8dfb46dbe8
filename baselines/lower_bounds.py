"""A time below which no motion through the waypoints can stay, whatever curve it takes: the sandwich's lower half.

Proof. Take any motion that passes the waypoints and keeps velocity and acceleration limits; let T_i be the time that it
spends in segment i, and v_i the velocity of one joint at waypoint i. Jerk limits and ranges of positions only make the set of
motions smaller, so leaving them out is safe.

1.  One joint, one segment. Put every waypoint velocity into one of finitely many cells. Where v_i lies in a cell with
    upper end a and v_{i+1} in one with upper end b, the joint's velocity never exceeds min(a + A t, b + A (T - t), V) in
    the segment, so its displacement is at most the integral of that, `reach(T; a, b)`; mirrored, it is at least
    -reach(T; -a', -b') with the lower ends a', b'. And T is at least the distance between the cells over A. The smallest
    T that satisfies the three is a lower bound tau_i(cell, next cell) on T_i.
2.  A first bound L_i on T_i is the largest, over joints, of the smallest tau_i over all pairs of cells. All joints spend
    the same time in a segment, so in step 1 only T >= L_i have to be looked at; this matters where a joint can arrive
    early or late but not in between.
3.  All segments, all joints. For weights w_ij >= 0 that add up to 1 over the joints of every segment,

        sum_i T_i = sum_j sum_i w_ij T_i >= sum_j min over chains of cells of sum_i w_ij tau_ij(cell_i, cell_i+1),

    because each joint's own cells make one of the chains. The minimum over chains is found by dynamic programming.

Any weights give a valid bound, so the search for good weights needs no proof; it is the dual of the choice of one mixture
of chains for every joint, solved by adding one chain per joint and round to a linear program. At rest at both ends, the
first and the last cell are the point 0; where the end condition is free, all cells are allowed there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from baselines.closed_forms import rest_to_rest_time
from study.problem import EndCondition, Floats, Problem

SMOOTHING = 0.5
"""Share of the best weights so far in the next ones: the linear program alone jumps from corner to corner."""

SAFETY = 1e-9
"""Relative deduction for rounding."""


def reach(time: Floats, a: Floats, b: Floats, velocity: float, acceleration: float) -> Floats:
    """Integral of min(a + A t, b + A (T - t), V) over [0, T], for a, b <= V: the module's upper bound on displacements."""
    w = (a + b + acceleration * time) / 2
    over = np.maximum(w - velocity, 0.0)
    with np.errstate(invalid="ignore"):
        both = (w**2 - over**2 - (a**2 + b**2) / 2) / acceleration
    low = np.minimum(a, b)
    return np.where(acceleration * time >= np.abs(a - b), both, low * time + acceleration * time**2 / 2)


def last_crossing(distance: float, a: Floats, b: Floats, velocity: float, acceleration: float) -> Floats:
    """Largest T with reach(T; a, b) = distance, s; 0 where reach exceeds the distance at all times."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    single = low**2 + 2 * acceleration * distance
    early = (np.sqrt(np.maximum(single, 0.0)) - low) / acceleration
    square = acceleration * distance + (a**2 + b**2) / 2
    w = np.sqrt(np.maximum(square, 0.0))
    w = np.where(w > velocity, (square + velocity**2) / (2 * velocity), w)
    late = (2 * w - a - b) / acceleration
    return np.maximum(np.where(w >= high, late, np.where(single >= 0, early, 0.0)), 0.0)


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of velocity at one waypoint; arrays of shape (n_cells,)."""

    low: Floats
    high: Floats


def shortest_times(distance: float, start: Cells, end: Cells, rates: Floats, at_least: float) -> Floats:
    """Lower bounds on the time between two waypoints for all pairs of cells, shape (n_start, n_end), s: step 1.

    Parameters
    ----------
    distance : float
        Signed.
    start, end : Cells
    rates : array of shape (3,)
        The joint's limits, velocity and acceleration finite.
    at_least : float, s
        A bound that is known already: step 2.
    """
    if distance < 0:
        start, end = Cells(-start.high, -start.low), Cells(-end.high, -end.low)
    d, (velocity, acceleration) = abs(distance), rates[:2]
    a, b = start.high[:, None], end.high[None]
    low_a, low_b = start.low[:, None], end.low[None]
    apart = np.maximum(np.maximum(low_b - a, low_a - b), 0.0) / acceleration
    soonest = np.maximum(last_crossing(d, a, b, velocity, acceleration) if d > 0 else 0.0, apart)
    soonest = np.maximum(soonest, at_least)
    overshoots = reach(soonest, -low_a, -low_b, velocity, acceleration) < -d - SAFETY * (d + velocity * soonest)
    late = last_crossing(-d, -low_a, -low_b, velocity, acceleration)
    return np.where(overshoots, np.maximum(soonest, late), soonest)


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
        value = np.zeros(self.times[-1].shape[1])
        choices = []
        for weight, times in zip(weights[::-1], self.times[::-1], strict=True):
            sums = weight * times + value
            choices.append(sums.argmin(axis=1))
            value = sums.min(axis=1)
        cell = int(value.argmin())
        chain = []
        for choice, times in zip(choices[::-1], self.times, strict=True):
            chain.append(times[cell, choice[cell]])
            cell = int(choice[cell])
        return float(value.min()), np.array(chain)


def velocity_cells(problem: Problem, velocity: float, n_cells: int) -> list[Cells]:
    """Cells of one joint's velocity at every waypoint; the point 0 at both ends where the motion starts and ends at rest."""
    edges = np.linspace(-velocity, velocity, n_cells + 1)
    inner = Cells(edges[:-1], edges[1:])
    rest = Cells(np.zeros(1), np.zeros(1))
    ends = inner if problem.end is EndCondition.FREE else rest
    return [ends, *[inner] * (problem.n_waypoints - 2), ends]


def all_chains(problem: Problem, n_cells: int) -> list[Chains]:
    """Steps 1 and 2 for every joint."""
    steps = np.diff(problem.waypoints, axis=0)
    slow = float(rest_to_rest_time(steps, problem.limits.rates).max(axis=1).sum())
    known = np.zeros(problem.n_segments)
    for _ in range(2):
        joints = [_chains(problem, j, n_cells, slow, known) for j in range(problem.n_joints)]
        known = np.max([[times.min() for times in joint.times] for joint in joints], axis=0)
    return joints


def _chains(problem: Problem, joint: int, n_cells: int, slow: float, known: Floats) -> Chains:
    rates, steps = problem.limits.rates[:, joint], np.diff(problem.waypoints[:, joint])
    velocity = min(rates[0], rates[1] * slow if problem.end is not EndCondition.FREE else np.inf)
    if not np.isfinite(rates[1]) or not np.isfinite(velocity):
        return Chains([np.full((1, 1), max(abs(d) / rates[0], k)) for d, k in zip(steps, known, strict=True)])
    cells = velocity_cells(problem, velocity, n_cells)
    limits = np.array([velocity, rates[1]])
    return Chains([shortest_times(d, cells[i], cells[i + 1], limits, known[i]) for i, d in enumerate(steps.tolist())])


@dataclass(frozen=True, eq=False)
class Bound:
    """A lower bound and how it was found.

    Attributes
    ----------
    value : float, s
        No motion through the waypoints within the limits is faster.
    rounds : int
        Linear programs solved.
    ceiling : float, s
        What the best weights could reach with these cells.
    """

    value: float
    rounds: int
    ceiling: float


def bound(problem: Problem, n_cells: int = 160, rounds: int = 60, tolerance: float = 1e-4) -> Bound:
    """Find good weights for step 3.

    Parameters
    ----------
    problem : Problem
    n_cells : int
        Cells of velocity between the limits, for every joint and waypoint; more cells, tighter bound.
    rounds : int
    tolerance : float
        Relative distance to the best that any weights can do at which the search ends.
    """
    joints = all_chains(problem, n_cells)
    slow = float(rest_to_rest_time(np.diff(problem.waypoints, axis=0), problem.limits.rates).max(axis=1).sum())
    pool: list[list[Floats]] = [[] for _ in joints]
    weights = np.full((problem.n_segments, problem.n_joints), 1.0 / problem.n_joints)
    best, ceiling, done, centre = 0.0, np.inf, 0, weights
    while done < rounds:
        done += 1
        found = [joint.cheapest(weights[:, j]) for j, joint in enumerate(joints)]
        total = sum(value for value, _ in found)
        if total > best:
            best, centre = total, weights
        for chains, (_, times) in zip(pool, found, strict=True):
            chains.append(times)
        if ceiling - best <= tolerance * best:
            break
        weights, ceiling = _master(pool)
        weights = SMOOTHING * centre + (1 - SMOOTHING) * weights
    return Bound(min(best * (1 - SAFETY), slow), done, ceiling)


def _master(pool: list[list[Floats]]) -> tuple[Floats, float]:
    """Best weights for the chains so far: maximise the joints' smallest weighted sums; and the value, s."""
    n_joints, n_segments = len(pool), len(pool[0][0])
    cuts = sum(len(chains) for chains in pool)
    owner = np.repeat(np.arange(n_joints), [len(chains) for chains in pool])
    rows: Any = sparse.lil_array((cuts, n_joints * n_segments + n_joints))
    for row, times in enumerate(times for chains in pool for times in chains):
        j = int(owner[row])
        rows[row, j * n_segments : (j + 1) * n_segments] = -times
        rows[row, n_joints * n_segments + j] = 1.0
    shares: Any = sparse.hstack(
        [sparse.kron(np.ones((1, n_joints)), sparse.eye(n_segments)), sparse.csr_array((n_segments, n_joints))]
    )
    cost = np.append(np.zeros(n_joints * n_segments), -np.ones(n_joints))
    solved = linprog(
        cost,
        A_ub=rows.tocsr(),
        b_ub=np.zeros(cuts),
        A_eq=shares,
        b_eq=np.ones(n_segments),
        bounds=(0, None),
        method="highs",
    )
    if solved.x is None or solved.fun is None:
        return np.full((n_segments, n_joints), 1.0 / n_joints), np.inf
    weights = np.maximum(solved.x[: n_joints * n_segments], 0.0).reshape(n_joints, n_segments).T
    return weights / weights.sum(axis=1, keepdims=True), float(-solved.fun)


def lower_bound(problem: Problem) -> float:
    """Time that no motion through the waypoints under the problem's limits can undercut, s; see the module for the proof.

    Parameters
    ----------
    problem : Problem
    """
    return bound(problem).value
