"""Problems of three real arms, with the makers' limits: moves, picks, random tours, and paths of the tool.

Velocities and ranges of positions are the makers'. Franka also publishes accelerations and jerks. Universal Robots and
KUKA publish neither: there the acceleration is ours, and the jerk takes a tenth of a second to build it up.

References
----------
Franka Robotics, "Robot and interface specifications" of the Franka Research 3; Universal Robots, "UR5e technical
details"; KUKA, data sheet "LBR iiwa 7 R800", axis data.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from study.errors import StudyError
from study.problem import EndCondition, Floats, JointLimits, Problem
from study.robots import Robot, robot_named

TOLERANCE, DAMPING, ITERATIONS = 1e-10, 1e-4, 100


@dataclass(frozen=True)
class Arm:
    """Limits of an arm, and a posture in the middle of its work.

    Attributes
    ----------
    robot : str
        A name in `study.robots.robot_names()`.
    velocity, acceleration, jerk : tuples of float, rad/s, rad/s^2, rad/s^3
    home : tuple of float, rad
    """

    robot: str
    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]
    home: tuple[float, ...]

    def limits(self, jerk: bool) -> JointLimits:
        """Limits of rates, and the range of positions."""
        low, high = robot_named(self.robot).range
        velocity, acceleration = np.array(self.velocity), np.array(self.acceleration)
        return JointLimits(velocity, acceleration, np.array(self.jerk if jerk else np.inf), low, high)


ARMS = {
    "fr3": Arm(
        "fr3", (2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26), (10.0,) * 7, (5000.0,) * 7,
        (0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854),
    ),
    "ur5e": Arm("ur5e", (np.pi,) * 6, (5.0,) * 6, (50.0,) * 6, (0.3, -1.3, 1.9, -2.1708, -1.5708, 0.3)),
    "iiwa7": Arm(
        "iiwa7", tuple(np.radians([98, 98, 100, 130, 140, 180, 180]).tolist()), (10.0,) * 7, (100.0,) * 7,
        (0.0, 0.6, 0.0, -1.3, 0.0, 1.2416, 0.0),
    ),
}  # fmt: skip


def arm_problems(seed: int) -> Iterator[Problem]:
    """Draw every task of every arm with jerk limits, and some, named with `-va`, without: 33 problems."""
    for name, arm in ARMS.items():
        for number, (task, draw) in enumerate(TASKS.items()):
            rng = np.random.default_rng([seed, number, len(name)])
            problem = Problem(f"{name}-{task}", draw(rng, arm), arm.limits(jerk=True), end=EndCondition.SMOOTH)
            yield problem
            if task in WITHOUT_JERK:
                yield replace(problem, name=f"{name}-{task}-va", limits=arm.limits(jerk=False), end=EndCondition.REST)


def tour(rng: np.random.Generator, arm: Arm, n_waypoints: int) -> Floats:
    """Random configurations within 1.6 rad of home in every joint, and within 98 % of the range."""
    low, high = robot_named(arm.robot).range
    middle, half, home = (low + high) / 2, 0.49 * (high - low), np.array(arm.home)
    box = np.maximum(home - 1.6, middle - half), np.minimum(home + 1.6, middle + half)
    return rng.uniform(*box, (n_waypoints, len(home)))


def pick(rng: np.random.Generator, arm: Arm) -> Floats:
    """Home, above a part, at it, above it, above the place, at it, above it, with the tool downwards; 7 waypoints."""
    part, place = (
        rng.uniform([-0.12, -0.25, -0.2], [0.08, -0.1, -0.1]),
        rng.uniform([-0.12, 0.1, -0.2], [0.08, 0.25, -0.1]),
    )
    up = np.array([0.0, 0.0, 0.1])
    points = np.array([np.zeros(3), part + up, part, part + up, place + up, place, place + up])
    q = followed(arm, points)
    q[3], q[6] = q[1], q[4]
    return q


def seam(rng: np.random.Generator, arm: Arm) -> Floats:
    """Weld a straight seam with a weave across, 20 waypoints."""
    u, length, weave = np.linspace(0, 1, 20)[:, None], rng.uniform(0.2, 0.35), rng.uniform(0.003, 0.01)
    angle = rng.uniform(0, 2 * np.pi)
    along, across = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0])
    return followed(arm, length * (u - 0.5) * along + weave * np.sin(4 * np.pi * u) * across - [0, 0, 0.1])


def helix(rng: np.random.Generator, arm: Arm) -> Floats:
    """Two turns of a helix, 50 waypoints."""
    u, radius, rise = np.linspace(0, 1, 50), rng.uniform(0.05, 0.1), rng.uniform(0.05, 0.15)
    phase = 4 * np.pi * u + rng.uniform(0, 2 * np.pi)
    return followed(arm, np.stack([radius * np.cos(phase), radius * np.sin(phase), rise * (u - 0.5) - 0.1], axis=1))


def dense(rng: np.random.Generator, arm: Arm, n_waypoints: int = 200) -> Floats:
    """Trace a smooth closed curve of the tool, densely."""
    u, size = 2 * np.pi * np.linspace(0, 1, n_waypoints), rng.uniform(0.08, 0.15, 3)
    shift = rng.uniform(0, 2 * np.pi, 3)
    return followed(arm, size * np.sin(np.stack([u, 2 * u, u], axis=1) + shift) * [1, 1, 0.4] - [0, 0, 0.1])


TASKS: dict[str, Callable[[np.random.Generator, Arm], Floats]] = {
    "move2": lambda rng, arm: tour(rng, arm, 2),
    "pick5": pick,
    "rand10": lambda rng, arm: tour(rng, arm, 10),
    "rand20": lambda rng, arm: tour(rng, arm, 20),
    "seam20": seam,
    "helix50": helix,
    "dense200": dense,
}
"""Tasks by name; a number in a name counts waypoints, but for `pick5`, whose seven waypoints are five places."""


WITHOUT_JERK = ("pick5", "rand10", "helix50", "dense200")


def followed(arm: Arm, shifts: Floats) -> Floats:
    """Configurations that move the tool from its place at home by shifts, its orientation kept.

    Parameters
    ----------
    arm : Arm
    shifts : array of shape (n, 3), m

    Raises
    ------
    StudyError
        If a place cannot be reached.
    """
    robot, q, points = robot_named(arm.robot), np.array(arm.home), []
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
