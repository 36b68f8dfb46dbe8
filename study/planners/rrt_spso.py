"""Pathfinding and timing pipeline of the PUMA560 paper, from boxes to a timed motion, with collision checks.

A tree finds a path of the tool among boxes; four of its nodes become waypoints by inverse kinematics; chaotic PSO times
the 3-5-3 curve through them. The paper checks the tree's segments only. Here the tool along the final curve, and
the whole arm along it, are checked as well.

The paper prints neither obstacles nor the placement of its cube, so both are ours: a cube of 0.35 m in front of and
below the shoulder stands for the 1000-unit world, the tool points down, the elbow is up, and links are capsules of
3 cm radius.

References
----------
PUMA560 paper, Sections 3.1, 3.4 and 4.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from study.errors import StudyError
from study.pathfinding.rrt import RRT, four_waypoints, length, shortcut
from study.pathfinding.world import World, arm_clearance, random_world
from study.planners.puma import CHAOTIC_SPSO
from study.planning import RunSettings
from study.problem import EndCondition, Floats, JointLimits, Problem
from study.robots import Robot, inverse, robot_named
from study.trajectory import Motion

ROBOT = "puma560"
METHODS = ("rrt", "rrt with shortcuts", "rrt-connect with shortcuts")


@dataclass(frozen=True, eq=False)
class Scene:
    """Placement of the 1000-unit world in the arm's workspace; all of it ours.

    Attributes
    ----------
    corner : array of shape (3,), m
        Position of the world's origin in the arm's base frame.
    scale : float, m per unit
    radius : float, m
        Of the capsules around the links.
    samples : int
        Instants at which the final motion is checked.
    """

    corner: Floats = field(default_factory=lambda: np.array([0.25, -0.175, -0.5]))
    scale: float = 0.35e-3
    radius: float = 0.03
    samples: int = 400

    def to_arm(self, points: Floats) -> Floats:
        """Map world points of shape (..., 3) into the base frame, m."""
        return self.corner + points * self.scale

    def to_world(self, points: Floats) -> Floats:
        """Map points of the base frame into the world."""
        return (points - self.corner) / self.scale


@dataclass(frozen=True, eq=False)
class Attempt:
    """Result of one run of the pipeline.

    Attributes
    ----------
    path : array of shape (n_nodes, 3)
        The tool's collision-free path, in world units.
    path_length : float
        In world units.
    problem : Problem
        The four waypoints in joint space.
    motion : Motion
    tool_clearance : float, m
        Smallest distance of the tool point to an obstacle along the final motion; 0 in collision.
    waypoint_clearance : float, m
        Smallest distance of the whole arm to an obstacle at the four waypoints; negative in collision.
    arm_clearance : float, m
        The same along the final motion.
    """

    path: Floats
    path_length: float
    problem: Problem
    motion: Motion
    tool_clearance: float
    waypoint_clearance: float
    arm_clearance: float


def attempt(method: str, seed: int, settings: RunSettings, scene: Scene | None = None) -> Attempt:
    """Find a path in a random world, time the motion through four of its nodes, and check the motion.

    Parameters
    ----------
    method : str
        One of `METHODS`.
    seed : int
        Of the world, the tree and the search.
    settings : RunSettings
        Budget and form of the search.
    scene : Scene, optional

    Raises
    ------
    StudyError
        If the method is unknown, no path is found, or a waypoint cannot be reached.
    """
    if method not in METHODS:
        raise StudyError(f"no pathfinding method {method!r}; known: {', '.join(METHODS)}")
    scene = scene or Scene()
    robot = robot_named(ROBOT)
    world = random_world(np.random.default_rng([seed, 0]))
    path = _path(method, world, np.random.default_rng([seed, 1]))
    problem = _problem(robot, scene.to_arm(four_waypoints(path)))
    plan = CHAOTIC_SPSO.plan(problem, settings)
    if plan.motion is None:
        raise StudyError(f"chaotic PSO found no motion for seed {seed}: {plan.message}")
    times = np.linspace(0.0, plan.motion.duration, scene.samples)
    links = scene.to_world(robot.frames(plan.motion(times))[:, :, :3, 3])
    still = scene.to_world(robot.frames(problem.waypoints)[:, :, :3, 3])
    radius = scene.radius / scene.scale
    tool = links[:, -1]
    return Attempt(
        path=path,
        path_length=length(path),
        problem=problem,
        motion=plan.motion,
        tool_clearance=float(world.clearance(tool[:-1], tool[1:]).min() * scene.scale),
        waypoint_clearance=float(arm_clearance(world, still, radius).min() * scene.scale),
        arm_clearance=float(arm_clearance(world, links, radius).min() * scene.scale),
    )


def _path(method: str, world: World, rng: np.random.Generator) -> Floats:
    tree = RRT()
    grow = tree.connect if method.startswith("rrt-connect") else tree.path
    path = grow(world, world.lower, world.upper, rng)
    return path if method == "rrt" else _refined(shortcut(world, path, rng), tree.step)


def _refined(path: Floats, step: float) -> Floats:
    """Put nodes back on the long segments of a shortened path, so that four waypoints can be taken from it."""
    pieces = [path[:1]]
    for start, stop in pairwise(path):
        count = max(1, int(np.ceil(np.linalg.norm(stop - start) / step)))
        pieces.append(start + np.linspace(0.0, 1.0, count + 1)[1:, None] * (stop - start))
    return np.concatenate(pieces)


def _problem(robot: Robot, points: Floats) -> Problem:
    poses = np.broadcast_to(np.eye(4), (len(points), 4, 4)).copy()
    poses[:, :3, :3] = np.diag([1.0, -1.0, -1.0])  # tool axis down
    poses[:, :3, 3] = points
    waypoints = _nearest_branches(robot, inverse(robot, poses))
    limits = JointLimits(np.full(robot.n_joints, np.pi))
    return Problem("rrt-spso", waypoints, limits, EndCondition.SMOOTH, (0.1, 4.0))


def _nearest_branches(robot: Robot, solutions: Floats) -> Floats:
    """One solution per pose: first with the elbow up, then always the nearest, by the sparrow paper's Eq. (1)."""
    first = solutions[0][~np.isnan(solutions[0]).any(axis=1)]
    elbows = robot.frames(first)[:, 2, 2, 3].round(9)
    chosen = [first[np.lexsort((np.abs(first).sum(axis=1), -elbows))[0]]]
    for branches in solutions[1:]:
        turned = branches + 2 * np.pi * np.round((chosen[-1] - branches) / (2 * np.pi))
        distance = np.abs(turned - chosen[-1]).sum(axis=1)
        chosen.append(turned[np.nanargmin(distance)])
    return np.array(chosen)
