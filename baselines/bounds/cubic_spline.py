"""Lower bound on the total time of clamped cubic splines with few segments: branch and bound over boxes of durations.

On a box of durations h the spline is relaxed to a linear programme that minimises their sum. With w = 1/h, v the
velocities at the waypoints and d the steps, all of one joint,

* two pieces meet with the same acceleration: w_k (v_k + 2 v_k+1) + w_k+1 (2 v_k+1 + v_k+2) =
  3 (d_k w_k^2 + d_k+1 w_k+1^2);
* acceleration at the start of a piece is 6 d w^2 - 4 v_k w - 2 v_k+1 w, at its end -6 d w^2 + 2 v_k w + 4 v_k+1 w;
* jerk is constant in a piece, so |a_k+1 - a_k| <= J h_k;
* velocity at a fraction of a piece is linear in d w and the velocities at its ends.

So only w = 1/h, q = w^2 and the products v w are not linear. The first two are convex and lie between tangents and
secant, the products between McCormick's four planes. That takes ranges of v: the first equation divided by 2 (w_k +
w_k+1) makes v_k+1 a mean of 1.5 d w less half a mean of its neighbours, so intervals around them shrink by half with
every pass over the waypoints. All rows are necessary conditions, so the value is a lower bound on every spline of the
box; where the programme has no solution there is none. Velocity is held at some points only, which makes the bound
looser, never wrong. The solver's tolerance of 1e-7 on rows of order one is met by a deduction of `SAFETY`.

References
----------
G. P. McCormick, Computability of global solutions to factorable nonconvex programs, Mathematical Programming 10, 1976.
"""

from __future__ import annotations

import heapq
from typing import Any

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from baselines.units import dimensionless, largest_steps
from study.deadline import NEVER, Deadline
from study.problem import Floats, Problem

SAFETY = 1e-5
"""Relative deduction for the tolerances of the linear programmes."""

FRACTIONS = tuple(k / 16 for k in range(1, 16))
"""Of a segment, where velocity is held."""

PASSES = 12
INFEASIBLE = 2
"""Status of `linprog`."""

SHORTEST = 1e-3
"""Lower bound on a duration, over the mean, below which the linear programmes are ill-posed."""


def velocity_ranges(problem: Problem, w_low: Floats, w_high: Floats) -> tuple[Floats, Floats]:
    """Enclose the velocities at all waypoints, two arrays of shape (n_waypoints, n_joints); crossed if infeasible."""
    steps, limit = np.diff(problem.waypoints, axis=0), problem.limits.velocity
    dw = np.sort([steps * w_low[:, None], steps * w_high[:, None]], axis=0)
    share_low = (w_low[1:] / (w_high[:-1] + w_low[1:]))[:, None]
    share_high = (w_high[1:] / (w_low[:-1] + w_high[1:]))[:, None]
    bound = np.minimum(limit, 3 * np.abs(dw).max(axis=(0, 1)))
    low, high = (np.full((len(steps) + 1, len(limit)), side) * bound for side in (-1.0, 1.0))
    low[[0, -1]] = high[[0, -1]] = 0.0
    for _ in range(PASSES):
        smallest = 1.5 * dw[0], 0.5 * high
        largest = 1.5 * dw[1], 0.5 * low
        new_low = _mean(smallest[0], share_low, share_high, np.minimum) - _mean_ends(
            smallest[1], share_low, share_high, np.maximum
        )
        new_high = _mean(largest[0], share_low, share_high, np.maximum) - _mean_ends(
            largest[1], share_low, share_high, np.minimum
        )
        low[1:-1], high[1:-1] = np.maximum(low[1:-1], new_low), np.minimum(high[1:-1], new_high)
    return low, high


def _mean(values: Floats, share_low: Floats, share_high: Floats, pick: Any) -> Floats:
    """Extreme of (1 - s) values[k] + s values[k + 1] over shares s."""
    before, after = values[:-1], values[1:]
    return np.asarray(pick(before + share_low * (after - before), before + share_high * (after - before)))


def _mean_ends(values: Floats, share_low: Floats, share_high: Floats, pick: Any) -> Floats:
    """The same for the neighbours k and k + 2."""
    before, after = values[:-2], values[2:]
    return np.asarray(pick(before + share_low * (after - before), before + share_high * (after - before)))


class TripleRows:
    """Collect rows of the linear programme as index and value triples."""

    def __init__(self) -> None:
        self.entries: list[tuple[int, int, float]] = []
        self.right: list[float] = []

    def add(self, terms: dict[int, float], right: float) -> None:
        """Add the row sum of terms <= right."""
        self.entries += [(len(self.right), column, value) for column, value in terms.items() if value]
        self.right.append(right)

    def within(self, terms: dict[int, float], limit: float) -> None:
        """Add the rows for |sum of terms| <= limit."""
        if np.isfinite(limit):
            self.add(terms, limit)
            self.add({column: -value for column, value in terms.items()}, limit)

    def matrix(self, n_columns: int) -> Any:
        """The rows as a sparse matrix."""
        rows, columns, values = (np.array(part) for part in zip(*self.entries, strict=True))
        return sparse.csr_array((values, (rows, columns)), shape=(len(self.right), n_columns))


class Relaxation:
    """The linear programme of one box. Columns: h, w, q for every segment, then v, x and y for every joint.

    x and y are the products of w with the velocities at the start and at the end of the segment.
    """

    def __init__(self, problem: Problem, low: Floats, high: Floats) -> None:
        self.problem, self.low, self.high = problem, low, high
        self.n, self.joints = problem.n_segments, problem.n_joints
        self.steps = np.diff(problem.waypoints, axis=0)
        self.v_low, self.v_high = velocity_ranges(problem, 1 / high, 1 / low)
        self.rows, self.equal = TripleRows(), TripleRows()

    @property
    def n_columns(self) -> int:
        """Number of variables."""
        return 3 * self.n + self.joints * (3 * self.n + 1)

    def columns(self, joint: int) -> tuple[int, int, int]:
        """First columns of a joint's v, x and y."""
        start = 3 * self.n + joint * (3 * self.n + 1)
        return start, start + self.n + 1, start + 2 * self.n + 1

    def solve(self) -> float:
        """Smallest sum of durations, less the deduction; infinite where the box holds no motion."""
        if (self.v_low > self.v_high + SAFETY).any():
            return np.inf
        for i in range(self.n):
            self._powers(i)
        for j in range(self.joints):
            self._joint(j)
        v = np.sort(np.stack([self.v_low.T, self.v_high.T], axis=2), axis=2)
        free = np.full((2 * self.n, 2), [-np.inf, np.inf])
        w = np.stack([1 / self.high, 1 / self.low], axis=1)
        bounds = [np.stack([self.low, self.high], axis=1), w, w**2, *(part for row in v for part in (row, free))]
        cost = np.zeros(self.n_columns)
        cost[: self.n] = 1.0
        equal: dict[str, Any] = {}
        if self.equal.right:
            equal = {"A_eq": self.equal.matrix(self.n_columns), "b_eq": np.array(self.equal.right)}
        rows, right = self.rows.matrix(self.n_columns), np.array(self.rows.right)
        solve: Any = linprog  # its stubs know no arguments that depend on the rows
        solved = solve(cost, rows, right, bounds=np.concatenate(bounds), method="highs", **equal)
        if solved.status == INFEASIBLE:
            return np.inf
        shortest = float(self.low.sum())  # all that is known where the solver gives up
        return shortest if solved.fun is None else max(float(solved.fun) * (1 - SAFETY), shortest)

    def _powers(self, i: int) -> None:
        """Tangents and secants of w = 1/h and q = w^2."""
        n, low, high = self.n, float(self.low[i]), float(self.high[i])
        for p in (low, np.sqrt(low * high), high):
            self.rows.add({n + i: -1.0, i: -1 / p**2}, -2 / p)
            self.rows.add({2 * n + i: -1.0, n + i: 2 / p}, 1 / p**2)
        self.rows.add({n + i: 1.0, i: 1 / (low * high)}, 1 / low + 1 / high)
        self.rows.add({2 * n + i: 1.0, n + i: -(1 / low + 1 / high)}, -1 / (low * high))

    def _joint(self, j: int) -> None:
        n, steps, (velocity, acceleration, jerk) = self.n, self.steps[:, j], self.problem.limits.rates[:, j]
        v, x, y = self.columns(j)
        starts = [{2 * n + i: 6 * steps[i], x + i: -4.0, y + i: -2.0} for i in range(n)]
        stops = [{2 * n + i: -6 * steps[i], x + i: 2.0, y + i: 4.0} for i in range(n)]
        for i in range(n):
            self._product(x + i, v + i, i, (self.v_low[i, j], self.v_high[i, j]))
            self._product(y + i, v + i + 1, i, (self.v_low[i + 1, j], self.v_high[i + 1, j]))
            self.rows.within(starts[i], acceleration)
            self.rows.within(stops[i], acceleration)
            change = {2 * n + i: -12 * steps[i], x + i: 6.0, y + i: 6.0}
            if np.isfinite(jerk):
                self.rows.add(change | {i: -jerk}, 0.0)
                self.rows.add({column: -value for column, value in change.items()} | {i: -jerk}, 0.0)
            for u in FRACTIONS:
                ends = {v + i: 1 - 4 * u + 3 * u**2, v + i + 1: 3 * u**2 - 2 * u}
                self.rows.within({n + i: 6 * u * (1 - u) * steps[i]} | ends, velocity)
        for before, after in zip(stops[:-1], starts[1:], strict=True):
            self.equal.add(before | {column: -value for column, value in after.items()}, 0.0)

    def _product(self, product: int, v: int, i: int, ends: tuple[float, float]) -> None:
        """McCormick's planes around product = v w."""
        w, w_low, w_high = self.n + i, 1 / float(self.high[i]), 1 / float(self.low[i])
        v_low, v_high = min(ends), max(ends)
        for a, b in ((v_low, w_low), (v_high, w_high)):
            self.rows.add({product: -1.0, v: b, w: a}, a * b)
        for a, b in ((v_low, w_high), (v_high, w_low)):
            self.rows.add({product: 1.0, v: -b, w: -a}, -a * b)


def shortest_durations(problem: Problem) -> Floats:
    """Lower bound on every segment's duration, shape (n_segments,), s: by velocity limits and duration bounds."""
    straight = np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity
    shortest: Floats = np.maximum(straight.max(axis=1), problem.duration_bounds[0])
    return shortest


def spline_bound(
    problem: Problem, total: float, most: int = 200, gap: float = 1e-3, deadline: Deadline = NEVER
) -> tuple[float, int]:
    """Bound the total time of all clamped cubic splines through the waypoints from below.

    Parameters
    ----------
    problem : Problem
    total : float, s
        Of a feasible spline.
    most : int
        Linear programmes at most.
    gap : float
        Relative distance to `total` at which it ends.
    deadline : Deadline
        After it no box is cut any more. The bound holds all the same.

    Returns
    -------
    value : float, s
    boxes : int
        Linear programmes solved.
    """
    scaled, units = dimensionless(problem, total / problem.n_segments, largest_steps(problem))
    unit, ceiling = units.time, total / units.time
    low = shortest_durations(problem) / unit
    if (low < SHORTEST).any():
        return float(low.sum()) * unit, 0
    heap: list[tuple[float, int, Floats, Floats]] = [(float(low.sum()), 0, low, np.full(len(low), np.inf))]
    done = 0
    while heap and done < most and heap[0][0] < ceiling * (1 - gap):
        if deadline.passed():
            break
        known, _, low, high = heapq.heappop(heap)
        for lower, upper in [(low, high)] if done == 0 else _halves(low, high):
            upper = np.minimum(upper, ceiling - (lower.sum() - lower))
            if (upper < lower).any():
                continue
            done += 1
            value = Relaxation(scaled, lower, np.maximum(upper, lower * (1 + SAFETY))).solve()
            if value < ceiling:
                heapq.heappush(heap, (max(value, known), done, lower, upper))
    return min(heap[0][0] if heap else ceiling, ceiling) * unit * (1 - SAFETY), done


def _halves(low: Floats, high: Floats) -> list[tuple[Floats, Floats]]:
    """Cut a box in two where it is widest, by ratio."""
    k = int(np.argmax(high / low))
    middle = float(np.sqrt(low[k] * high[k]))
    left, right = high.copy(), low.copy()
    left[k] = right[k] = middle
    return [(low, left), (right, high)]
