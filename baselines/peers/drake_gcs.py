"""Drake's GcsTrajectoryOptimization: a Bezier curve for each segment, waypoints as points between them; extra `arms`.

There is one region, the range of positions, so that the graph is a chain and its convex relaxation has nothing to
choose. Limits of acceleration and jerk are nonlinear in curve and duration, so SNOPT solves the restriction. Order 9
with limits of jerk, else 7.

References
----------
T. Marcucci, M. Petersen, D. von Wrangel, R. Tedrake, Motion planning around obstacles with convex optimization,
Science Robotics 8(84), 2023.
"""

from __future__ import annotations

import importlib
from typing import Any, ClassVar

import numpy as np

from baselines.peers.base import Peer, needs
from baselines.peers.drake_curve import cut, snopt
from study.problem import Demand, Problem
from study.trajectory import Trajectory

needs("pydrake")

FARTHEST, SHORTEST, LONGEST = 10.0, 1e-3, 20.0
"""Range of positions where a joint has none, rad or m; times between which a segment's duration lies, s."""


class DrakeGcs(Peer):
    """Planner `drake-gcs`."""

    about = "Drake's graph of convex sets: a Bezier curve for each segment, by SNOPT"
    knows: ClassVar[frozenset[Demand]] = frozenset({Demand.POSITION_RANGE})
    most: ClassVar[int | None] = 10

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Optimise; the curve, or None where there is no success. The time limit is SNOPT's, which comes last."""
        sets: Any = importlib.import_module("pydrake.geometry.optimization")
        program, start, end = _program(problem)
        options = sets.GraphOfConvexSetsOptions()
        options.convex_relaxation, options.max_rounded_paths = True, 1
        options.restriction_solver, options.restriction_solver_options = snopt(time_limit)
        curve, answer = program.SolvePath(start, end, options)
        return curve if answer.is_success() else None

    def motion(self, problem: Problem, answer: Any) -> Trajectory:
        """Take the Bezier curves as they are."""
        parts = [answer.segment(k) for k in range(answer.get_number_of_segments())]
        parts = [part for part in parts if part.order()]  # the ends are regions of their own
        marks = np.array([parts[0].start_time(), *(part.end_time() for part in parts)])
        return cut(answer, marks, marks, max(part.order() for part in parts))


def _program(problem: Problem) -> tuple[Any, Any, Any]:
    """The program and its first and last region."""
    drake: Any = importlib.import_module("pydrake.planning")
    sets: Any = importlib.import_module("pydrake.geometry.optimization")
    limits, points, jerky = problem.limits, problem.waypoints, bool(np.isfinite(problem.limits.jerk).all())
    box = sets.HPolyhedron.MakeBox(np.maximum(limits.lower, -FARTHEST), np.minimum(limits.upper, FARTHEST))
    order, smooth = (9, 2) if jerky else (7, 1)
    program = drake.GcsTrajectoryOptimization(problem.n_joints)
    parts = [program.AddRegions([box], order, SHORTEST, LONGEST, name=f"s{k}") for k in range(problem.n_segments)]
    for before, after, point in zip(parts[:-1], parts[1:], points[1:-1], strict=True):
        edges = program.AddEdges(before, after, sets.Point(point))
        for derivative in range(1, smooth + 1):
            edges.AddContinuityConstraints(derivative)
    start = program.AddRegions([sets.Point(points[0])], 0, name="start")
    end = program.AddRegions([sets.Point(points[-1])], 0, name="end")
    for edges in (program.AddEdges(start, parts[0]), program.AddEdges(parts[-1], end)):
        for derivative in range(1, smooth + 1):
            edges.AddZeroDerivativeConstraints(derivative)
    program.AddTimeCost()
    program.AddVelocityBounds(-limits.velocity, limits.velocity)
    program.AddNonlinearDerivativeBounds(-limits.acceleration, limits.acceleration, 2)
    if jerky:
        program.AddNonlinearDerivativeBounds(-limits.jerk, limits.jerk, 3)
    return program, start, end
