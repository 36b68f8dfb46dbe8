"""Drake's KinematicTrajectoryOptimization: one B-spline and its duration, by SNOPT; the extra `arms`.

The waypoints' places on the curve cannot be optimised, so they are given: those of TOPP-RA's motion along a
centripetal spline, which is also the start. Limits hold on control points. Order 5 with limits of jerk, else 4; two
control points and more for each waypoint.

References
----------
R. Tedrake and the Drake development team, Drake: model-based design and verification for robotics, 2019.
"""

from __future__ import annotations

import importlib
from typing import Any, ClassVar

import numpy as np

from baselines.peers.base import Peer, needs
from baselines.peers.drake_curve import cut, snopt
from baselines.peers.toppra_package import path_speeds
from study.problem import Demand, Floats, Problem
from study.trajectory import Trajectory

needs("pydrake")

FARTHEST = 1e3
"""Range of positions where a joint has none."""


class DrakeKto(Peer):
    """Planner `drake-kto`."""

    about = "Drake's kinematic trajectory optimisation of one B-spline, waypoints at TOPP-RA's places on it"
    knows: ClassVar[frozenset[Demand]] = frozenset({Demand.POSITION_RANGE})
    most: ClassVar[int | None] = 50

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Optimise; the curve and the places of the waypoints, or None where SNOPT does not succeed."""
        drake: Any = importlib.import_module("pydrake.planning")
        spline, points, speeds = path_speeds(problem, 0.5, "natural")
        times = np.append(0.0, np.cumsum(2 * np.diff(points) / (speeds[:-1] + speeds[1:])))
        at = times[np.searchsorted(points, spline.x)] / times[-1]
        order = 5 if np.isfinite(problem.limits.jerk).all() else 4
        control = max(2 * problem.n_waypoints + 2 * order, 16)
        program = drake.KinematicTrajectoryOptimization(problem.n_joints, control, order, 1.3 * times[-1])
        program.AddDurationCost(1.0)
        program.AddDurationConstraint(0.3 * times[-1], 30 * times[-1])
        _limit(program, problem, at)
        bspline = program.basis()
        greville = np.array([np.mean(bspline.knots()[k + 1 : k + order]) for k in range(control)])
        start = spline(np.interp(greville * times[-1], times, points)).T
        trajectories: Any = importlib.import_module("pydrake.trajectories")
        program.SetInitialGuess(trajectories.BsplineTrajectory(bspline, [start[:, [k]] for k in range(control)]))
        solver, options = snopt(time_limit)
        answer = solver.Solve(program.prog(), None, options)
        return (program.ReconstructTrajectory(answer), at) if answer.is_success() else None

    def motion(self, problem: Problem, answer: tuple[Any, Floats]) -> Trajectory:
        """Take the B-spline as it is, cut at the waypoints."""
        curve, at = answer
        knots = np.array(curve.basis().knots())
        return cut(curve, at * (knots[-1] - knots[0]) + knots[0], knots, curve.basis().order() - 1)


def _limit(program: Any, problem: Problem, at: Floats) -> None:
    """Give a program the limits, the waypoints and rest at both ends."""
    limits, jerky = problem.limits, bool(np.isfinite(problem.limits.jerk).all())
    program.AddPositionBounds(np.maximum(limits.lower, -FARTHEST), np.minimum(limits.upper, FARTHEST))
    program.AddVelocityBounds(-limits.velocity, limits.velocity)
    program.AddAccelerationBounds(-limits.acceleration, limits.acceleration)
    if jerky:
        program.AddJerkBounds(-limits.jerk, limits.jerk)
    zero = np.zeros(problem.n_joints)
    for s in (0, 1):
        program.AddPathVelocityConstraint(zero, zero, s)
        if jerky:
            program.AddPathAccelerationConstraint(zero, zero, s)
    for s, point in zip(at, problem.waypoints, strict=True):
        program.AddPathPositionConstraint(point, point, s)
