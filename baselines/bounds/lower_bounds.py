"""Lower bound on the duration of every motion through the waypoints, whatever curve it takes.

Proof. Take any motion that passes the waypoints within the limits; let T_i be the time that it spends in segment i, and
v_i the velocity of one joint at waypoint i. Ranges of positions and end accelerations only make the set of motions
smaller, so leaving them out is safe.

1.  One joint, one segment. Put every waypoint velocity into one of finitely many cells. For every pair of cells at the
    segment's ends, `baselines.bounds.cell_times` bounds T_i from below by tau_i(cell, next cell).
2.  All joints spend the same time in a segment. So L_i, the largest over joints of the smallest tau_i over pairs of
    cells, is a lower bound on T_i, and in step 1 only T >= L_i have to be looked at; this matters where a joint can
    arrive early or late but not in between.
3.  All segments, all joints. For weights w_ij >= 0 that add up to at most 1 over the joints of every segment,

        sum_i T_i >= sum_j sum_i w_ij T_i >= sum_j min over chains of cells of sum_i w_ij tau_ij(cell_i, cell_i+1),

    because each joint's own cells make one of the chains. The minimum over chains is found by dynamic programming.
    A joint may stand in this sum several times, through every waypoint and through every second, third ... one
    (its strands): a motion passes these, too, and its time from one to the next is a sum of T_i, so that such a part
    has one weight for all its segments. Step 1 forgets a joint's acceleration at every waypoint; where waypoints are
    closer than jerk lets acceleration change, passing fewer of them says more.
4.  Refinement. Let U be the duration of some feasible motion. If the sum in step 3, with one strand's chains forced
    through one cell, is more than U, no motion faster than U uses that cell: it is dropped. The cells that are left are
    halved, and steps 1 to 3 are done again. Then every motion takes at least the smaller of U and the new sum.

Before step 1, jerk and velocity limits bound acceleration too where a motion starts and ends at rest. Say a joint
accelerates at a > 0. Under its jerk limit J it gains a^2 / (2 J) on the way there and as much again afterwards, unless
the motion starts or ends in between. If neither happens, a^2 / J <= 2 V. If it starts on the way there, it starts at
rest, so a^2 / (2 J) <= V; the same holds if it ends afterwards, and both cannot happen, for the joint would not be at
rest at both ends. So a <= sqrt(2 V J); for a < 0 by symmetry.

Any weights give a valid bound, so the search for good weights needs no proof; it is the dual of the choice of one
mixture of chains for every strand, solved by adding one chain per strand and round to a linear program. At rest at both
ends, the first and the last cell are the point 0; where the end condition is free, all cells are allowed there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import reduce
from operator import add

import numpy as np
from numpy.typing import NDArray

from baselines.bounds.cell_times import Cells
from baselines.bounds.chain_weights import Covers, chain_weights, equal_weights
from baselines.bounds.joined_times import SAFETY
from baselines.bounds.strands import Chains, DeadlineExceeded, Strand, all_chains, first_strands
from baselines.closed_forms import rest_to_rest_time
from study.deadline import NEVER, Deadline
from study.problem import EndCondition, Floats, Problem

SMOOTHING = 0.5
"""Share of the best weights so far in the next ones: the linear program alone jumps from corner to corner."""

ROUNDS, TOLERANCE, WEIGHTS_TOLERANCE = 60, 1e-4, 1e-4
"""Linear programs per refinement, and the relative distance to the best that any weights can do at which they end."""

STRIDES = (1, 2, 3, 4, 6, 8)
"""Of the strands: every waypoint, every second and so on."""

MOST_PAIRS = 1e7
"""Pairs of cells, about, over all parts of all strands."""

NEGLIGIBLE = 1e-3
"""Share of the bound of a strand that is not followed further."""


def with_implied_acceleration(problem: Problem) -> Problem:
    """Lower acceleration limits to what jerk and velocity limits leave of them, where the motion rests at both ends."""
    velocity, acceleration, jerk = problem.limits.rates
    if problem.end is EndCondition.FREE:
        return problem
    implied = np.minimum(acceleration, np.sqrt(2 * velocity * jerk) * (1 + SAFETY))
    return replace(problem, limits=replace(problem.limits, acceleration=implied))


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
    known : float, s
        Duration of the fastest motion that was told or found.
    """

    value: float
    rounds: int
    cells: int
    known: float


def bound(
    problem: Problem,
    known: float = np.inf,
    n_cells: int = 16,
    refinements: int = 6,
    most_cells: int = 160,
    deadline: Deadline = NEVER,
    seek: Callable[[], float] | None = None,
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
        Cells at one waypoint and joint that are not halved further; fewer where there are many segments and joints.
    deadline : Deadline
        After it the best bound so far is returned, at first that of the velocity limits.
    seek : callable, optional
        Finds the duration of another feasible motion; asked once, when a first bound is proved.
    """
    stops = float(rest_to_rest_time(np.diff(problem.waypoints, axis=0), problem.limits.rates).max(axis=1).sum())
    fastest, problem = min(known, stops), with_implied_acceleration(problem)
    known = fastest * (1 + SAFETY)
    strands, weights = first_strands(problem, n_cells, known, STRIDES), None
    most_cells = min(most_cells, int((MOST_PAIRS / sum(len(strand.cells) for strand in strands)) ** 0.5))
    best, rounds = straight_time(problem), 0
    for step in range(refinements + 1):
        try:
            joints = all_chains(problem, strands, deadline)
        except DeadlineExceeded:
            break
        value, weights, count = best_weights(joints, [strand.cover for strand in strands], deadline, weights)
        before, best, rounds = best, max(best, min(value * (1 - SAFETY), known)), rounds + count
        if step == 0 and seek is not None:
            fastest = min(fastest, seek())
            known = fastest * (1 + SAFETY)
        if step == refinements or best - before < TOLERANCE * best or deadline.passed():
            break
        strands, weights = _refined(strands, joints, weights, known, most_cells, NEGLIGIBLE if step else 0.0)
        if not all(len(cells.low) for strand in strands for cells in strand.cells):
            best = known  # no motion faster than the known one is left
            break
    best = min(best, known) / (1 + SAFETY)
    return Proof(best, rounds, sum(len(cells.low) for strand in strands for cells in strand.cells), fastest)


def straight_time(problem: Problem) -> float:
    """Sum of what every segment takes at the velocity limits, s: a bound that needs no cells."""
    return float((np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity).max(axis=1).sum())


def _refined(
    strands: list[Strand], joints: list[Chains], weights: list[Floats], known: float, most_cells: int, negligible: float
) -> tuple[list[Strand], list[Floats]]:
    """Step 4: drop cells that no motion faster than the known one uses, and halve the others; drop light strands."""
    values = [joint.cheapest(weight)[0] for joint, weight in zip(joints, weights, strict=True)]
    result = []
    for strand, joint, weight, value in zip(strands, joints, weights, values, strict=True):
        if value >= negligible * _added(values):
            room = known - (_added(values) - value)
            masks = [through <= room for through in joint.through(weight)]
            cells = [_halved(row, mask, most_cells) for row, mask in zip(strand.cells, masks, strict=True)]
            result.append((replace(strand, cells=cells), weight))
    return [strand for strand, _ in result], [weight for _, weight in result]


def _added(values: Iterable[float]) -> float:
    """Add from left to right; the built-in `sum` rounds otherwise since Python 3.12."""
    return reduce(add, values)


def _halved(cells: Cells, mask: NDArray[np.bool_], most_cells: int) -> Cells:
    left = cells.picked(mask)
    return left.halved() if np.isfinite(left.high).all() and 2 * len(left.low) <= most_cells else left


def best_weights(
    joints: list[Chains], covers: Covers, deadline: Deadline = NEVER, start: list[Floats] | None = None
) -> tuple[float, list[Floats], int]:
    """Search for the weights of step 3; after the deadline the best so far are good enough.

    Returns
    -------
    value : float, s
        The bound that they give.
    weights : list of arrays of shape (n_parts,)
    rounds : int
    """
    pool: list[list[Floats]] = [[] for _ in joints]
    trial = centre = start or equal_weights(covers)
    best, ceiling, done = -np.inf, np.inf, 0
    while done < ROUNDS and ceiling - best > WEIGHTS_TOLERANCE * best:
        if done and deadline.passed():
            break
        done += 1
        cheapest = [joint.cheapest(weight) for joint, weight in zip(joints, trial, strict=True)]
        value = _added(value for value, _ in cheapest)
        if value > best:
            best, centre = value, trial
        for chains, (_, times) in zip(pool, cheapest, strict=True):
            chains.append(times)
        corners, ceiling = chain_weights(pool, covers)
        trial = [SMOOTHING * old + (1 - SMOOTHING) * new for old, new in zip(centre, corners, strict=True)]
    return best, centre, done


def lower_bound(problem: Problem) -> float:
    """Lower bound on the time of any motion through the waypoints within the limits, s; see the module for the proof.

    Parameters
    ----------
    problem : Problem
    """
    return bound(problem).value
