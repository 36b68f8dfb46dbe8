"""How near an arm comes to obstacles while it moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.cases.library import Case
from study.pathfinding.world import World, arm_clearance
from study.robots import robot_named
from study.trajectory import Motion

INSTANTS = 2000
"""Evenly spaced instants that are looked at, besides the knots; between them nothing is proved."""


@dataclass(frozen=True)
class Nearest:
    """The smallest distance between arm and obstacles, m, negative where they touch, and when, s."""

    distance: float
    time: float

    @property
    def sentence(self) -> str:
        """For people."""
        if self.distance < 0:
            return f"the arm hits an obstacle at {self.time:.3f} s, {-self.distance:.4g} m deep"
        return f"the arm stays {self.distance:.4g} m away from all obstacles, nearest at {self.time:.3f} s"


def nearest(case: Case, motion: Motion) -> Nearest | None:
    """Look for the instant at which the arm is nearest to an obstacle; None where there is no obstacle or no arm.

    The links are capsules from joint to joint with the case's radius.

    Parameters
    ----------
    case : Case
    motion : Motion
    """
    if case.robot is None or not len(case.obstacles):
        return None
    robot = robot_named(case.robot, tuple(case.problem.joint_names))
    times = np.unique(np.concatenate([np.linspace(0.0, motion.duration, INSTANTS), motion.knots]))
    places = robot.frames(case.robot_configuration(motion(times)))[:, :, :3, 3]
    distances = arm_clearance(world_of(case), places, case.arm_radius)
    k = int(distances.argmin())
    return Nearest(float(distances[k]), float(times[k]))


def world_of(case: Case) -> World:
    """The case's obstacles with room around them."""
    return World(case.obstacles.min(axis=(0, 1)) - 1.0, case.obstacles.max(axis=(0, 1)) + 1.0, case.obstacles)
