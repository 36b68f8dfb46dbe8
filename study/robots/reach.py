"""Numeric inverse kinematics of any chain, from one configuration to its neighbours."""

from __future__ import annotations

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.robots.chain import Robot

TOLERANCE, DAMPING, ITERATIONS = 1e-10, 1e-4, 100


def followed(robot: Robot, home: Floats, shifts: Floats) -> Floats:
    """Configurations that move the tool from its place at home by shifts, its orientation kept.

    Parameters
    ----------
    robot : Robot
    home : array of shape (n_joints,), rad or m
    shifts : array of shape (n, 3), m

    Raises
    ------
    StudyError
        If a place cannot be reached.
    """
    q, points = home, []
    pose = robot.forward(q)[0]
    for shift in shifts:
        target = pose.copy()
        target[:3, 3] += shift
        q = _reached(robot, q, target)
        points.append(q)
    return np.array(points)


def _reached(robot: Robot, q: Floats, target: Floats) -> Floats:
    """Inverse kinematics from a neighbouring configuration on, by damped least squares with a difference Jacobian."""
    step = 1e-6
    for _ in range(ITERATIONS):
        poses = robot.forward(np.vstack([q, q + step * np.eye(len(q))]))
        errors = _error(poses, target)
        if np.abs(errors[0]).max() < TOLERANCE:
            return q
        jacobian = (errors[1:] - errors[0]).T / step
        q = q - jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + DAMPING**2 * np.eye(6), errors[0])
    raise StudyError(f"robot {robot.name!r} cannot reach a place of this task; draw it with another seed")


def _error(poses: Floats, target: Floats) -> Floats:
    """Distance in position and, by the axis of the remaining turn, in orientation, shape (n, 6)."""
    turn = poses[:, :3, :3] @ target[:3, :3].T
    axis = np.stack(
        [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1
    )
    return np.hstack([poses[:, :3, 3] - target[:3, 3], axis / 2])
