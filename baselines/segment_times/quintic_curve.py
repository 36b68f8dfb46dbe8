"""Quintic segments with free velocities and accelerations at the waypoints, transcribed for CasADi.

Every cubic spline and the 3-5-3 curve are such motions: two derivatives are continuous and no segment needs a higher
power. Only their end conditions matter: a clamped spline has an acceleration at its ends, so it is one where that is
free.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from baselines.ipopt import ca
from baselines.segment_times.critical_points import Critical, polynomial_critical
from baselines.segment_times.model import Rows
from baselines.segment_times.polynomial_curves import (
    PolynomialFamily,
    flat,
    rate_rows,
    shortest_of,
    slot_symbols,
    stacked,
)
from study import polynomial
from study.curves import curve_named
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Motion, Trajectory

FIRST_POINTS = {1: (0.25, 0.5, 0.75), 2: (1 / 3, 2 / 3), 3: (0.0, 0.5, 1.0)}
"""With the bounds at the waypoints enough points to fix each rate's polynomial: a first solve cannot stray far."""


PULL = 1e-4
"""Weight on the distance to the last round's rates: joints with slack would wander, and break limits elsewhere.

The pull is towards the round before, so it is nothing where the rounds have come to rest.
"""


@dataclass(frozen=True)
class Quintic(PolynomialFamily):
    """Durations, and velocity and acceleration of every joint at every waypoint; those limits are bounds there."""

    @property
    def slot_shapes(self) -> dict[int, tuple[int, int, int]]:
        """The first points of every segment, and three for its peaks."""
        return {order: (self.n_waypoints - 1, self.n_joints, len(FIRST_POINTS[order]) + 3) for order in self.orders}

    def rows(self) -> Rows:
        """Build the symbolic model."""
        n, joints = self.n_waypoints - 1, self.n_joints
        h, v, a = ca.SX.sym("h", n), ca.SX.sym("v", n + 1, joints), ca.SX.sym("a", n + 1, joints)
        d, weights, u = ca.SX.sym("d", n, joints), ca.SX.sym("w", 3, joints), slot_symbols(self.slot_shapes)
        wide = ca.repmat(h, 1, joints)
        speeds, pushes = (v[:-1, :] * wide, v[1:, :] * wide), (a[:-1, :] * wide**2, a[1:, :] * wide**2)
        pieces = [0, *polynomial.hermite_quintic(d, *speeds, *pushes)]
        rows = [r for k in self.orders for r in rate_rows(pieces, h, weights[k - 1, :], k, u[k])]
        x = ca.vertcat(h, ca.vec(v), ca.vec(a))
        start = ca.SX.sym("start", *x.shape)
        p = ca.vertcat(ca.vec(d), ca.vec(weights), *stacked(u), start)
        total = ca.sum1(h) + PULL * ca.sumsqr(x[n:] - start[n:])
        return Rows(x, p, total, ca.vertcat(*rows), proximal=True)

    def lift(self, problem: Problem, durations: Floats) -> Floats:
        """Rates at the waypoints of the clamped cubic spline with these durations."""
        return self.lift_motion(curve_named("cubic-spline").motion(problem.waypoints, durations), problem)

    def lift_motion(self, motion: Motion, problem: Problem) -> Floats:
        """Rates of a motion at the waypoints, as far as the end condition allows them."""
        times = motion.waypoint_times
        rates = np.array([motion(times, 1), motion(times, 2)])
        held = _held(problem)
        rates[held, 0] = rates[held, -1] = 0.0
        return np.concatenate([np.diff(times), flat(rates[0]), flat(rates[1])])

    def motion(self, problem: Problem, x: Floats) -> Trajectory:
        """Motion of given variables."""
        n, h = self.n_waypoints, self.durations(x)
        speed, push = np.moveaxis(x[n - 1 :].reshape(2, self.n_joints, n), 2, 1)
        speeds, pushes = ([rate[:-1] * w, rate[1:] * w] for rate, w in ((speed, h[:, None]), (push, h[:, None] ** 2)))
        quintic = polynomial.hermite_quintic(np.diff(problem.waypoints, axis=0), *speeds, *pushes)
        unit = np.stack([problem.waypoints[:-1], *quintic], axis=1)
        return Trajectory.from_pieces(h, unit / (h[:, None] ** np.arange(6))[:, :, None])

    def variable_bounds(self, problem: Problem) -> tuple[Floats, Floats]:
        """Shortest durations, and at the waypoints the limits and the end condition."""
        peaks = np.repeat(problem.limits.rates[:2, None, :], self.n_waypoints, axis=1)
        held = _held(problem)
        peaks[held, 0] = peaks[held, -1] = 0.0
        lower = np.full(self.n_waypoints - 1, shortest_of(problem))
        rates = np.concatenate([flat(peaks[0]), flat(peaks[1])])
        return np.concatenate([lower, -rates]), np.concatenate([np.full_like(lower, np.inf), rates])

    def critical(self, problem: Problem, x: Floats, order: int) -> Critical:
        """Critical points of every segment."""
        critical = polynomial_critical(problem, self.motion(problem, x), order)
        if order == 3:
            return critical
        inside = (critical.points > 0) & (critical.points < 1)  # at the ends the limit is a bound already
        return replace(critical, ratios=np.where(inside, critical.ratios, 0.0))


def _held(problem: Problem) -> list[int]:
    """Rates that are zero at both ends: 0 for velocity, 1 for acceleration."""
    return {EndCondition.FREE: [], EndCondition.REST: [0], EndCondition.SMOOTH: [0, 1]}[problem.end]
