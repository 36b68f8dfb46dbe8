"""The sparrow-search paper's task: waypoints on a helix, taken into joint space."""

from __future__ import annotations

import numpy as np

from study.problem import Floats
from study.robots import inverse
from study.robots.chain import Robot

BRANCH = (1, 1, -1)
"""The unique domain in which the paper's Table 3 lies; its text names (1, -1, 1)."""

ORIENTATION = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""The tool's fixed orientation, read from Table 3: q2 + q3 + q4 = -pi, q5 = -q1, q6 = pi."""


def helix_points(n_points: int = 20) -> Floats:
    """Sample the helix: shape (n_points, 3), m.

    Centre (-200, 100) mm, radius 60 mm, 18 degrees between points; the height grows by 10 mm per radian, although the
    text calls 10 mm the pitch.

    References
    ----------
    ur5-tadf-ssa, Table 2.
    """
    phase = np.radians(18.0) * np.arange(n_points)
    return np.stack([-200.0 + 60.0 * np.cos(phase), 100.0 + 60.0 * np.sin(phase), 10.0 * phase], axis=1) / 1000.0


def helix_configurations(robot: Robot, n_points: int = 20) -> Floats:
    """Take the helix into joint space: shape (n_points, 6), rad.

    The printed positions are those of frame 5: the paper leaves the last offset d6 out, so it is added to the poses
    here.

    References
    ----------
    ur5-tadf-ssa, Tables 1 to 3.
    """
    poses = np.zeros((n_points, 4, 4))
    poses[:, :3, :3] = ORIENTATION
    poses[:, :3, 3] = helix_points(n_points) + robot.d[5] * ORIENTATION[:, 2]
    poses[:, 3, 3] = 1.0
    return inverse(robot, poses, BRANCH)
