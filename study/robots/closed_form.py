"""Closed-form inverse kinematics of the arms in this study, all branches of all poses at once.

Branches are told apart by three signs (k1, k2, k3), the arm's unique domains: k1 for the shoulder (+1 where the first
link points away from the wrist), k2 for the sign of sin(theta5), k3 for the sign of the elbow angle.

References
----------
Zhang, X. et al. (2022): Time optimal trajectory planning based on improved sparrow search algorithm. Frontiers in
Bioengineering and Biotechnology 10, 852408; Eqs. (4) and (5) carry misprints, so everything here is derived anew.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.robots.chain import SINGULAR, Robot, screw_x, screw_z, wrapped

BRANCHES: tuple[tuple[int, int, int], ...] = tuple((a, b, c) for a, b, c in itertools.product((1, -1), repeat=3))
"""The signs (k1, k2, k3) in the order in which the solvers give their branches."""

Branches = Sequence[tuple[int, int, int]]


def ur_inverse(robot: Robot, poses: Floats, wanted: Branches = BRANCHES) -> Floats:
    """Invert an arm with three parallel axes and an offset wrist, as the UR and AUBO arms have.

    Parameters
    ----------
    robot : Robot
    poses : array of shape (n, 4, 4)
    wanted : sequence of sign triples
        The branches to compute.

    Returns
    -------
    array of shape (n, n_branches, 6), rad
        NaN in branches that do not exist.
    """
    lengths, twists = _standard(robot)
    sign4, sign5 = np.sin(twists[3]), np.sin(twists[4])
    n, o, a = (poses[:, :3, column] for column in range(3))
    wrist = poses[:, :3, 3] - robot.d[5] * a
    branches = []
    for k1, k2, k3 in wanted:
        theta1, reach = _shoulder(wrist, robot.d[1:4].sum(), k1)
        forward, sideways = _shoulder_axes(theta1)
        cosine5, sine5 = _dot(sideways, a), _wrist_sine(_dot(sideways, n), _dot(sideways, o), k2)
        cosine6, sine6 = sign4 * _dot(sideways, n) / sine5, -sign4 * _dot(sideways, o) / sine5
        x4 = n * (cosine5 * cosine6)[:, None] - o * (cosine5 * sine6)[:, None] + a * (sign5 * sine5)[:, None]
        sum234 = np.arctan2(x4[:, 2], _dot(forward, x4))
        across = reach - robot.d[4] * sign4 * np.sin(sum234)
        up = wrist[:, 2] - robot.d[0] + robot.d[4] * sign4 * np.cos(sum234)
        theta2, theta3 = _two_links(across, up, lengths[1], lengths[2], k3)
        theta5, theta6 = np.arctan2(sine5, cosine5), np.arctan2(sine6, cosine6)
        branches.append(np.stack([theta1, theta2, theta3, sum234 - theta2 - theta3, theta5, theta6], axis=1))
    return _as_joint_angles(robot, branches)


def puma_inverse(robot: Robot, poses: Floats, wanted: Branches = BRANCHES) -> Floats:
    """Invert an arm with a spherical wrist and an offset shoulder, as the PUMA 560 has.

    Parameters
    ----------
    robot : Robot
        In the standard convention.
    poses : array of shape (n, 4, 4)
    wanted : sequence of sign triples
        The branches to compute.

    Returns
    -------
    array of shape (n, n_branches, 6), rad
        NaN in branches that do not exist.
    """
    sign3, sign4, sign5 = np.sin(robot.alpha[2:5])
    forearm, bend = np.hypot(robot.a[2], robot.d[3]), np.arctan2(-sign3 * robot.d[3], robot.a[2])
    wrist = poses[:, :3, 3] - robot.d[5] * poses[:, :3, 2]
    branches = []
    for k1, k2, k3 in wanted:
        theta1, reach = _shoulder(wrist, robot.d[1:3].sum(), k1)
        theta2, elbow = _two_links(reach, wrist[:, 2] - robot.d[0], robot.a[1], forearm, k3)
        theta3 = elbow - bend
        hand = np.swapaxes(_turned(robot, np.stack([theta1, theta2, theta3], axis=1)), 1, 2) @ poses[:, :3, :3]
        cosine5, sine5 = -sign4 * sign5 * hand[:, 2, 2], _wrist_sine(hand[:, 2, 0], hand[:, 2, 1], k2)
        theta4 = np.arctan2(sign5 * hand[:, 1, 2] / sine5, sign5 * hand[:, 0, 2] / sine5)
        theta6 = np.arctan2(-sign4 * hand[:, 2, 1] / sine5, sign4 * hand[:, 2, 0] / sine5)
        branches.append(np.stack([theta1, theta2, theta3, theta4, np.arctan2(sine5, cosine5), theta6], axis=1))
    return _as_joint_angles(robot, branches)


def woodworking_inverse(robot: Robot, poses: Floats, wanted: Branches = ()) -> Floats:
    """Invert the woodworking arm: two slides, two turns, one branch.

    Only poses of a four-parameter family can be reached; for others the caller's check by forward kinematics fails.

    Parameters
    ----------
    robot : Robot
    poses : array of shape (n, 4, 4)
    wanted : sequence
        Not used: there is one branch.

    Returns
    -------
    array of shape (n, 1, 4), m and rad

    References
    ----------
    woodworking-golds-pso, Eq. (3), with theta4 = atan2(r21, r22): the printed arguments are those of pi/2 - theta4.
    """
    theta3 = np.arctan2(-poses[:, 2, 2], poses[:, 0, 2])
    theta4 = np.arctan2(poses[:, 1, 0], poses[:, 1, 1])
    d1 = poses[:, 2, 3] + robot.d[3] * np.sin(theta3)
    d2 = poses[:, 0, 3] - robot.d[3] * np.cos(theta3)
    return np.stack([d1, d2, theta3, theta4], axis=1)[:, None]


def _standard(robot: Robot) -> tuple[Floats, Floats]:
    """Link lengths and twists that follow each joint, whichever convention the arm is given in."""
    if not robot.modified:
        return robot.a, robot.alpha
    if robot.a[0] or robot.alpha[0]:
        raise StudyError(f"robot {robot.name!r}: the first row must have zero length and twist for the closed form")
    return np.append(robot.a[1:], 0.0), np.append(robot.alpha[1:], 0.0)


def _shoulder(wrist: Floats, offset: float, k1: int) -> tuple[Floats, Floats]:
    """First joint's angle and the wrist's signed distance in front of it."""
    square = wrist[:, 0] ** 2 + wrist[:, 1] ** 2
    room = square - offset**2
    reach = -k1 * np.sqrt(np.where(room > SINGULAR * square, room, np.nan))
    sine, cosine = offset * wrist[:, 0] + reach * wrist[:, 1], reach * wrist[:, 0] - offset * wrist[:, 1]
    return np.arctan2(sine, cosine), reach


def _shoulder_axes(theta1: Floats) -> tuple[Floats, Floats]:
    """Directions in which the arm reaches and about which its parallel axes turn, each of shape (n, 3)."""
    sine, cosine, zero = np.sin(theta1), np.cos(theta1), np.zeros_like(theta1)
    return np.stack([cosine, sine, zero], axis=1), np.stack([sine, -cosine, zero], axis=1)


def _wrist_sine(first: Floats, second: Floats, k2: int) -> Floats:
    """Sine of the fifth angle from the two components that it scales; NaN where the wrist is straight."""
    size = np.hypot(first, second)
    return k2 * np.where(size > SINGULAR, size, np.nan)


def _two_links(across: Floats, up: Floats, first: float, second: float, k3: int) -> tuple[Floats, Floats]:
    """Angles of a planar arm of two links that ends at (across, up)."""
    cosine = (across**2 + up**2 - first**2 - second**2) / (2.0 * first * second)
    elbow = k3 * np.arccos(np.where(np.abs(cosine) < 1.0 - SINGULAR**2, cosine, np.nan))
    side, length = second * np.sin(elbow), first + second * np.cos(elbow)
    return np.arctan2(up, across) - np.arctan2(side, length), elbow


def _turned(robot: Robot, q: Floats) -> Floats:
    """Rotation of the frame behind the first joints, shape (n, 3, 3), without their constant angles."""
    count = q.shape[1]
    steps = screw_z(q, robot.d[:count]) @ screw_x(robot.alpha[:count], robot.a[:count])
    return _product(steps)[:, :3, :3]


def _product(steps: Floats) -> Floats:
    whole = steps[:, 0]
    for joint in range(1, steps.shape[1]):
        whole = whole @ steps[:, joint]
    return whole


def _dot(first: Floats, second: Floats) -> Floats:
    return (first * second).sum(axis=1)


def _as_joint_angles(robot: Robot, branches: list[Floats]) -> Floats:
    angles = np.stack(branches, axis=1)
    angles[np.isnan(angles).any(axis=2)] = np.nan
    return wrapped(angles - robot.theta)
