"""pyroboplan's CubicTrajectoryOptimization: one cubic for each segment by direct collocation and SNOPT.

Nothing makes its acceleration zero at the ends, so it declines a problem that asks for that. Velocity and position
are held at 11 instants of each segment, the package's default; the start is the middle of the allowed durations. The
package pins matplotlib, pin and toppra to versions other than ours, so no extra brings it: `pip install --no-deps
pyroboplan` beside the extras `arms` and `dynamics` does.

References
----------
M. Kelly, An introduction to trajectory optimization, SIAM Review 59(4), 2017.
"""

from __future__ import annotations

import contextlib
import importlib
import io
from typing import Any, ClassVar

import numpy as np

from baselines.peers.arm_text import urdf
from baselines.peers.base import Peer, needs, through_states
from study.problem import EndCondition, Problem
from study.trajectory import Trajectory

for package in ("pyroboplan", "pinocchio", "pydrake"):
    needs(package)


class PyRoboPlan(Peer):
    """Planner `pyroboplan`."""

    about = "pyroboplan's direct collocation: one cubic for each segment, by SNOPT"
    most: ClassVar[int | None] = 20

    def declines(self, problem: Problem, time_limit: float) -> str:
        """Decline, too, what asks for no acceleration at the ends."""
        smooth = (
            "nothing makes the package's acceleration zero at the ends" if problem.end is EndCondition.SMOOTH else ""
        )
        return super().declines(problem, time_limit) or smooth

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Optimise; None where SNOPT does not succeed. The time limit is SNOPT's, which comes after the building."""
        pinocchio: Any = importlib.import_module("pinocchio")
        package: Any = importlib.import_module("pyroboplan.trajectory.trajectory_optimization")
        velocity, acceleration, jerk = problem.limits.rates
        least = (np.abs(np.diff(problem.waypoints, axis=0)) / velocity).max(axis=1)
        options = package.CubicTrajectoryOptimizationOptions(
            num_waypoints=problem.n_waypoints,
            min_segment_time=max(float(least.min()) / 2, 1e-3),
            max_segment_time=10.0 * float(least.max()) + 2.0,
            min_vel=-velocity,
            max_vel=velocity,
            min_accel=-acceleration,
            max_accel=acceleration,
            min_jerk=-jerk,
            max_jerk=jerk,
            max_planning_time=time_limit,
        )
        with contextlib.redirect_stdout(io.StringIO()):
            planner = package.CubicTrajectoryOptimization(
                pinocchio.buildModelFromXML(urdf(problem)), pinocchio.GeometryModel(), options
            )
            return planner.plan(list(problem.waypoints))

    def motion(self, problem: Problem, answer: Any) -> Trajectory:
        """Take the cubics as they are."""
        times = np.append([pair[0] for pair in answer.segment_times], answer.segment_times[-1][1])
        positions, velocities = zip(*(answer.evaluate(t)[:2] for t in times), strict=True)
        return through_states(problem, times, positions, velocities)
