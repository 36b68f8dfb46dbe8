"""Pathfinding and timing pipeline of the PUMA560 paper, from boxes to a timed motion, with collision checks.

A tree finds a path of the tool among boxes; four of its nodes become waypoints by inverse kinematics; chaotic PSO times
the 3-5-3 curve through them. The paper checks the tree's segments only. Here the straight chords between the four nodes
that are kept, and the tool along the final curve, are checked as well.

Arm, start, goal and orientation are the paper's: Table 4 with the lengths of Table 1 runs from (100, 100, 10) mm to
(100, -70, 10) mm with the tool's axes along the base's. The obstacles are not printed; ours are random boxes in a block of the
arm's workspace that holds both ends.

References
----------
PUMA560 paper, Sections 3.1, 3.4 and 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from study.errors import StudyError
from study.pathfinding.rrt import RRT, four_waypoints, length, shortcut
from study.pathfinding.world import World, boxes_between
from study.planners.puma import CHAOTIC_SPSO
from study.planning import RunSettings
from study.problem import EndCondition, Floats, JointLimits, Problem
from study.robots import Robot, inverse, robot_named
from study.trajectory import Motion

ROBOT = "puma560-table1"
METHODS = ("rrt", "rrt with shortcuts", "rrt-connect with shortcuts")


START, GOAL = np.array([0.1, 0.1, 0.01]), np.array([0.1, -0.07, 0.01])
"""Ends of the paper's path in the arm's base frame, m: forward kinematics of Table 4."""

SPACE = np.array([0.05, -0.09, -0.05]), np.array([0.125, 0.12, 0.1])
"""Corners of the block in which obstacles stand, m; ours, all of it within the arm's reach."""

OBSTACLES = 10
STEP = 0.01
"""Length of an extension of the tree, m; ours, about a twentieth of the block."""

SAMPLES = 400
"""Instants between which the tool's way along the final motion is checked as straight."""


@dataclass(frozen=True, eq=False)
class Attempt:
    """Result of one run of the pipeline.

    Attributes
    ----------
    path : array of shape (n_nodes, 3), m
        The tool's collision-free path.
    path_length : float, m
    problem : Problem
        The four waypoints in joint space.
    motion : Motion
    chord_clearance : float, m
        Smallest distance of the straight chords between the four waypoints to an obstacle; 0 in collision.
    tool_clearance : float, m
        The same for the tool along the final motion.
    """

    path: Floats
    path_length: float
    problem: Problem
    motion: Motion
    chord_clearance: float
    tool_clearance: float


def attempt(method: str, seed: int, settings: RunSettings) -> Attempt:
    """Find a path in a random world, time the motion through four of its nodes, and check the motion.

    Parameters
    ----------
    method : str
        One of `METHODS`.
    seed : int
        Of the world, the tree and the search.
    settings : RunSettings
        Budget and form of the search.

    Raises
    ------
    StudyError
        If the method is unknown, no path is found, or a waypoint cannot be reached.
    """
    if method not in METHODS:
        raise StudyError(f"no pathfinding method {method!r}; known: {', '.join(METHODS)}")
    robot = robot_named(ROBOT)
    world = boxes_between(np.random.default_rng([seed, 0]), SPACE, (START, GOAL), OBSTACLES)
    path = _path(method, world, np.random.default_rng([seed, 1]))
    nodes = four_waypoints(path)
    problem = _problem(robot, nodes)
    plan = CHAOTIC_SPSO.plan(problem, settings)
    if plan.motion is None:
        raise StudyError(f"chaotic PSO found no motion for seed {seed}: {plan.message}")
    times = np.linspace(0.0, plan.motion.duration, SAMPLES)
    tool = robot.forward(plan.motion(times))[:, :3, 3]
    return Attempt(
        path=path,
        path_length=length(path),
        problem=problem,
        motion=plan.motion,
        chord_clearance=float(world.clearance(nodes[:-1], nodes[1:]).min()),
        tool_clearance=float(world.clearance(tool[:-1], tool[1:]).min()),
    )


def _path(method: str, world: World, rng: np.random.Generator) -> Floats:
    tree = RRT(step=STEP)
    grow = tree.connect if method.startswith("rrt-connect") else tree.path
    path = grow(world, START, GOAL, rng)
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
