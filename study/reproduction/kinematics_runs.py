"""Time the sparrow paper's inverse kinematics: one unique domain against all eight solutions and a choice."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from study.problem import Floats
from study.reproduction.jobs import MEASURED, Record, RecordJob
from study.robots import BRANCHES, SOLVERS, robot_named
from study.robots.helix import BRANCH

ROBOT = "ur5e-ssa"


@dataclass(frozen=True)
class KinematicsJob(RecordJob):
    """Seconds per pose of four ways to solve the same poses.

    Attributes
    ----------
    poses : int
    repeats : int
        The least time of so many counts, which other work on the machine disturbs least.
    """

    poses: int = 400
    repeats: int = 7
    kind: ClassVar[str] = "kinematics"
    weight: ClassVar[float] = 2.0

    @property
    def subject(self) -> str:
        """Name of the robot."""
        return ROBOT

    def inputs(self) -> object:
        """Return the robot."""
        return robot_named(ROBOT)

    def run(self) -> Record:
        """Measure seconds per pose: `scalar` (one pose per call) and `vectorised` (all in one call), `eight` and `one`."""
        robot = robot_named(ROBOT)
        configurations = np.random.default_rng(5).uniform(-2.8, 2.8, (self.poses, robot.n_joints))
        targets = robot.forward(configurations)
        solve = SOLVERS["ur"]
        home = np.array([-1.5, 2.2, -2.4, -2.9, 1.5, np.pi])

        def eight(poses: Floats) -> Floats:
            return nearest(solve(robot, poses, BRANCHES), home)

        def one(poses: Floats) -> Floats:
            return solve(robot, poses, (BRANCH,))[:, 0]

        seconds = {}
        for name, way in (("eight", eight), ("one", one)):
            seconds[f"vectorised {name}"] = self._seconds(lambda way=way: way(targets))  # type: ignore[misc]
            seconds[f"scalar {name}"] = self._seconds(lambda way=way: [way(pose[None]) for pose in targets])  # type: ignore[misc]
        return {MEASURED: seconds}

    def _seconds(self, work: Callable[[], object]) -> float:
        times = []
        for _ in range(self.repeats):
            begun = time.process_time()
            count = 0
            while count == 0 or time.process_time() - begun < 0.02:
                work()
                count += 1
            times.append((time.process_time() - begun) / count)
        return min(times) / self.poses


def nearest(solutions: Floats, reference: Floats) -> Floats:
    """Choose for every pose the solution with the least total turn from a configuration, shape (n_poses, n_joints)."""
    distance = np.abs(solutions - reference).sum(axis=2)
    chosen = np.where(np.isnan(distance), np.inf, distance).argmin(axis=1)
    return solutions[np.arange(len(solutions)), chosen]
