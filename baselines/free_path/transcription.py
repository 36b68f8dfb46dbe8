"""Transcription of the free-path program for IPOPT: free segment durations, K equal pieces per segment, exact limits.

Velocity is a parabola in a piece of linear acceleration. It is held at the piece's ends and at one inner point u, there
by v(u) + kappa a(u)^2 <= V: with kappa = h / (2 |a1 - a0|) that is the height of the peak wherever in the piece it
stands. Where a piece ends, v + a^2 / (2 J) <= V holds too, as it must where the acceleration can fade no faster than at
J.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from baselines.ipopt import Ipopt, Solution, alone, ca
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Trajectory

IntArray = NDArray[np.intp]
OPTIONS = {"tol": 1e-9, "max_iter": 300}
SHORTEST = 1e-6
"""Shortest duration of a segment, over the mean from stop to stop."""

FLAT = 0.01
"""Share of the full change of acceleration below which a peak counts as flat: it then needs no second-order term."""


@dataclass(frozen=True, eq=False)
class Nodes:
    """A motion by its values where the pieces meet.

    Attributes
    ----------
    durations : array of shape (n_segments,), s
    velocity, acceleration : arrays of shape (n_segments * K + 1, n_joints)
    """

    durations: Floats
    velocity: Floats
    acceleration: Floats

    @property
    def widths(self) -> Floats:
        """Width of every piece, shape (n_pieces,), s."""
        pieces = (len(self.velocity) - 1) // len(self.durations)
        return np.repeat(self.durations / pieces, pieces)


@dataclass(frozen=True, eq=False)
class Kinds:
    """Joints by the kind of their pieces; int arrays.

    Attributes
    ----------
    cubic, quadratic, straight : int arrays
        Joints with a jerk limit, with an acceleration limit only, and all others, among them those that never move.
    """

    cubic: IntArray
    quadratic: IntArray
    straight: IntArray

    @classmethod
    def of(cls, problem: Problem) -> Kinds:
        """Tell the kinds by the limits and by what moves."""
        limited = np.isfinite(problem.limits.rates) & (np.ptp(problem.waypoints, axis=0) > 0)
        degree = np.where(limited[2], 3, np.where(limited[1], 2, 1))
        return cls(*(np.flatnonzero(degree == kind) for kind in (3, 2, 1)))

    @property
    def optimised(self) -> IntArray:
        """Joints whose velocity the solver chooses: the cubic ones, then the quadratic ones."""
        return np.concatenate([self.cubic, self.quadratic])


class Peaks(NamedTuple):
    """Inner points at which velocity is held; arrays of shape (n_pieces, n_cubic_joints).

    `at` are fractions of the pieces, `curvature` the factors kappa of the second-order term.
    """

    at: Floats
    curvature: Floats


class PieceProgram:
    """Nonlinear program of one problem and one number of pieces per segment.

    Parameters
    ----------
    problem : Problem
        Dimensionless.
    pieces : int
        Equal pieces per segment, K.
    time_limit : float, s
    """

    @alone()
    def __init__(self, problem: Problem, pieces: int, time_limit: float = 60.0) -> None:
        self.problem, self.pieces, self.kinds = problem, pieces, Kinds.of(problem)
        self._count = problem.n_segments * pieces
        self._limits = problem.limits.rates
        self._moving = self.kinds.optimised
        self._velocity_shape = (self._count + 1, len(self._moving))
        self._acceleration_shape = (self._count + 1, len(self.kinds.cubic))
        durations = ca.SX.sym("T", problem.n_segments)
        velocity, acceleration = ca.SX.sym("v", *self._velocity_shape), ca.SX.sym("a", *self._acceleration_shape)
        peaks = [ca.SX.sym(name, self._count, len(self.kinds.cubic)) for name in ("u", "kappa")]
        rows = self._rows(durations, velocity, acceleration, peaks)
        self._lower, self._upper = (np.concatenate([row[side] for row in rows]) for side in (1, 2))
        nlp = {
            "x": ca.vertcat(durations, ca.vec(velocity), ca.vec(acceleration)),
            "p": ca.vertcat(*(ca.vec(part) for part in peaks)),
            "f": ca.sum1(durations),
            "g": ca.vertcat(*(ca.vec(row[0]) for row in rows)),
        }
        self._solver = Ipopt(nlp, OPTIONS, time_limit)

    def _rows(
        self, durations: Any, velocity: Any, acceleration: Any, peaks: list[Any]
    ) -> list[tuple[Any, Floats, Floats]]:
        """All constraints as (expressions, lower, upper): what a piece does, then where a segment ends."""
        n_cubic = len(self.kinds.cubic)
        h = ca.kron(durations, ca.SX.ones(self.pieces, 1)) / self.pieces
        limits = self._limits[:, self._moving]
        v0, v1 = velocity[:-1, :], velocity[1:, :]
        a0, a1 = acceleration[:-1, :], acceleration[1:, :]
        wide = ca.repmat(h, 1, n_cubic)
        gain = wide * (a0 + a1) / 2
        at, curvature = peaks
        middle = v0[:, :n_cubic] + wide * (at * a0 + at**2 * (a1 - a0) / 2)
        rise = curvature * (a0 + at * (a1 - a0)) ** 2
        brake = acceleration**2 / ca.repmat(2 * ca.DM(self._limits[2, self.kinds.cubic]).T, self._count + 1, 1)
        inside, ends = (np.broadcast_to(limits[0, :n_cubic], (k, n_cubic)) for k in (self._count, self._count + 1))
        travel = ca.horzcat(
            wide * v0[:, :n_cubic] + wide**2 * (2 * a0 + a1) / 6,
            ca.repmat(h, 1, velocity.shape[1] - n_cubic) * (v0 + v1)[:, n_cubic:] / 2,
        )
        per_segment = ca.kron(ca.SX.eye(self.problem.n_segments), ca.SX.ones(1, self.pieces))
        steps = np.diff(self.problem.waypoints, axis=0)[:, self._moving]
        rows = [
            _equal(per_segment @ travel, steps),
            _equal(v1[:, :n_cubic] - v0[:, :n_cubic] - gain, np.zeros((self._count, n_cubic))),
            _below(middle + rise, inside),
            _below(rise - middle, inside),
            _below(brake + velocity[:, :n_cubic], ends),
            _below(brake - velocity[:, :n_cubic], ends),
        ]
        for difference, limit in ((a1 - a0, limits[2, :n_cubic]), ((v1 - v0)[:, n_cubic:], limits[1, n_cubic:])):
            if difference.shape[1]:
                room = h @ ca.DM(limit).T
                rows.append(_above(room - difference))
                rows.append(_above(room + difference))
        return rows

    def _bounds(self) -> tuple[Floats, Floats]:
        """Box of the variables: limits at the pieces' ends, end conditions, and what the straight joints need."""
        steps = np.abs(np.diff(self.problem.waypoints, axis=0))
        shortest = (steps / self._limits[0])[:, self.kinds.straight].max(axis=1, initial=SHORTEST)
        v = np.broadcast_to(self._limits[0, self._moving], self._velocity_shape).copy()
        a = np.broadcast_to(self._limits[1, self.kinds.cubic], self._acceleration_shape).copy()
        if self.problem.end is not EndCondition.FREE:
            v[[0, -1]] = 0.0
        if self.problem.end is EndCondition.SMOOTH:
            a[[0, -1]] = 0.0
        high = np.concatenate([np.full(len(shortest), np.inf), v.ravel(order="F"), a.ravel(order="F")])
        low = -high
        low[: len(shortest)] = shortest
        return low, high

    def solve(self, start: Nodes, peaks: Peaks) -> tuple[Nodes, Solution]:
        """Run IPOPT once."""
        p = np.concatenate([part.ravel(order="F") for part in peaks])
        low, high = self._bounds()
        solution = self._solver.solve(x0=self._pack(start), p=p, lbx=low, ubx=high, lbg=self._lower, ubg=self._upper)
        return self._unpack(solution.x), solution

    @property
    def middles(self) -> Peaks:
        """Inner points in the middle of every piece, without a second-order term."""
        shape = (self._count, len(self.kinds.cubic))
        return Peaks(np.full(shape, 0.5), np.zeros(shape))

    def moved(self, peaks: Peaks, nodes: Nodes) -> Peaks:
        """Move every inner point to where velocity peaks in its piece; a piece without a peak keeps its point."""
        a0, a1 = nodes.acceleration[:-1, self.kinds.cubic], nodes.acceleration[1:, self.kinds.cubic]
        width = nodes.widths[:, None]
        crossing = a0 * a1 < 0
        fall = np.where(crossing, np.abs(a1 - a0), 1.0)
        sharp = crossing & (fall > FLAT * self._limits[2, self.kinds.cubic] * width)
        return Peaks(np.where(crossing, np.abs(a0) / fall, peaks.at), np.where(sharp, width / (2 * fall), 0.0))

    def _pack(self, nodes: Nodes) -> Floats:
        velocity, acceleration = nodes.velocity[:, self._moving], nodes.acceleration[:, self.kinds.cubic]
        return np.concatenate([nodes.durations, velocity.ravel(order="F"), acceleration.ravel(order="F")])

    def _unpack(self, x: Floats) -> Nodes:
        n, split = self.problem.n_segments, self.problem.n_segments + int(np.prod(self._velocity_shape))
        velocity = np.zeros((self._count + 1, self.problem.n_joints))
        acceleration = np.zeros_like(velocity)
        velocity[:, self._moving] = x[n:split].reshape(self._velocity_shape, order="F")
        acceleration[:, self.kinds.cubic] = x[split:].reshape(self._acceleration_shape, order="F")
        return Nodes(x[:n], velocity, acceleration)


def _equal(expression: Any, values: Floats) -> tuple[Any, Floats, Floats]:
    flat = values.ravel(order="F")
    return expression, flat, flat


def _below(expression: Any, bound: Floats) -> tuple[Any, Floats, Floats]:
    flat = bound.ravel(order="F")
    return expression, np.full(len(flat), -np.inf), flat


def _above(expression: Any) -> tuple[Any, Floats, Floats]:
    zero = np.zeros(expression.numel())
    return expression, zero, np.full(len(zero), np.inf)


def realise(problem: Problem, nodes: Nodes) -> Trajectory:
    """Make the exact trajectory; every segment starts from its own waypoint, so no rounding adds up."""
    kinds, h = Kinds.of(problem), nodes.widths[:, None]
    pieces = len(h) // problem.n_segments
    a0, a1 = nodes.acceleration[:-1].copy(), nodes.acceleration[1:].copy()
    v0, v1 = nodes.velocity[:-1].copy(), nodes.velocity[1:].copy()
    steps = np.diff(problem.waypoints, axis=0)
    a0[:, kinds.quadratic] = a1[:, kinds.quadratic] = ((v1 - v0) / h)[:, kinds.quadratic]
    v0[:, kinds.straight] = np.repeat(steps / nodes.durations[:, None], pieces, axis=0)[:, kinds.straight]
    a0[:, kinds.straight] = a1[:, kinds.straight] = 0.0
    travel = (h * v0 + h**2 * (2 * a0 + a1) / 6).reshape(-1, pieces, problem.n_joints)
    before = np.cumsum(travel, axis=1) - travel
    position = (problem.waypoints[:-1, None] + before).reshape(-1, problem.n_joints)
    return Trajectory.from_pieces(h[:, 0], np.stack([position, v0, a0 / 2, (a1 - a0) / h / 6], axis=1), pieces)
