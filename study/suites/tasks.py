"""Tasks of real arms: moves, picks, palletising, seams, rasters, ways between boxes, taught points, dense paths.

A task draws waypoints from a generator of random numbers. `size` shrinks lengths for arms of short reach.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from study.pathfinding.rrt import RRT, shortcut
from study.pathfinding.world import boxes_between
from study.problem import EndCondition, Floats, Problem
from study.robots.arms import Arm, arm_named
from study.robots.reach import followed

Task = Callable[[np.random.Generator, Arm, float], Floats]
UP = np.array([0.0, 0.0, 0.1])
SPACE = np.array([-0.15, -0.25, -0.2]), np.array([0.1, 0.25, 0.1])
"""Corners of the worlds of boxes, from the tool's place at home, m."""

USUAL_REACH = 0.55
"""Distance of the tool from the axis of the base at home at which tasks have their usual size, m."""


def size_for(arm: Arm) -> float:
    """Factor for the lengths of the tool's tasks."""
    at_home = arm.robot.forward(arm.home)[0, :2, 3]
    return float(np.clip(np.linalg.norm(at_home) / USUAL_REACH, 0.4, 1.0))


def tour(rng: np.random.Generator, arm: Arm, size: float, n_waypoints: int = 10) -> Floats:
    """Random configurations within 1.6 rad (or 0.4 m) of home in every joint, and within 98 % of the range."""
    low, high = arm.range
    reach = np.where(arm.robot.prismatic, 0.4, 1.6)
    with np.errstate(invalid="ignore"):
        middle, half = (low + high) / 2, 0.49 * (high - low)
    lowest = np.where(np.isfinite(low), np.maximum(arm.home - reach, middle - half), arm.home - reach)
    highest = np.where(np.isfinite(high), np.minimum(arm.home + reach, middle + half), arm.home + reach)
    return rng.uniform(lowest, highest, (n_waypoints, len(arm.home)))


def move(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """One move from rest to rest between random configurations."""
    return tour(rng, arm, size, 2)


def pick(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """Home, above a part, at it, above it, above the place, at it, above it, the tool's orientation kept; 7 waypoints."""
    part, place = (
        rng.uniform([-0.12, -0.25, -0.2], [0.08, -0.1, -0.1]),
        rng.uniform([-0.12, 0.1, -0.2], [0.08, 0.25, -0.1]),
    )
    points = np.array([np.zeros(3), part + UP, part, part + UP, place + UP, place, place + UP])
    q = _followed(arm, size * points)
    q[3], q[6] = q[1], q[4]
    return q


def palletise(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """Carry four parts from one place to the corners of a layer; 25 waypoints."""
    source = rng.uniform([-0.1, -0.2, -0.15], [0.0, -0.12, -0.1])
    corner, pitch = rng.uniform([-0.12, 0.08, -0.15], [-0.05, 0.12, -0.1]), rng.uniform(0.05, 0.1)
    points = [np.zeros(3)]
    for step in ((0, 0), (0, 1), (1, 0), (1, 1)):
        place = corner + pitch * np.array([*step, 0.0])
        points += [source + UP, source, source + UP, place + UP, place, place + UP]
    return _followed(arm, size * np.array(points))


def seam(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """Weld a straight seam with a weave across, 20 waypoints."""
    u, length, weave = np.linspace(0, 1, 20)[:, None], rng.uniform(0.2, 0.35), rng.uniform(0.003, 0.01)
    angle = rng.uniform(0, 2 * np.pi)
    along, across = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0])
    return _followed(arm, size * (length * (u - 0.5) * along + weave * np.sin(4 * np.pi * u) * across - UP))


def helix(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """Two turns of a helix, 50 waypoints."""
    u, radius, rise = np.linspace(0, 1, 50), rng.uniform(0.05, 0.1), rng.uniform(0.05, 0.15)
    phase = 4 * np.pi * u + rng.uniform(0, 2 * np.pi)
    points = np.stack([radius * np.cos(phase), radius * np.sin(phase), rise * (u - 0.5) - 0.1], axis=1)
    return _followed(arm, size * points)


def raster(rng: np.random.Generator, arm: Arm, size: float, n_lines: int = 6) -> Floats:
    """Scan a rectangle to and fro, four points to a line; 24 waypoints."""
    length, width = rng.uniform(0.15, 0.25), rng.uniform(0.1, 0.15)
    x, points = length * np.linspace(-0.5, 0.5, 4), []
    for line in range(n_lines):
        y = width * (line / (n_lines - 1) - 0.5)
        points += [np.array([along, y, -0.1]) for along in (x if line % 2 == 0 else x[::-1])]
    return _followed(arm, size * np.array(points))


def tending(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """Tend a machine: fetch a part, into the machine and out, lay it down, and home again; 11 waypoints."""
    part = rng.uniform([-0.1, -0.25, -0.15], [0.05, -0.15, -0.1])
    door = rng.uniform([-0.02, 0.1, -0.02], [0.05, 0.2, 0.05])
    inside = door + np.array([rng.uniform(0.06, 0.1), 0.0, -0.03])
    tray = part + np.array([rng.uniform(-0.1, -0.06), 0.0, 0.0])
    points = [np.zeros(3), part + UP, part, part + UP, door, inside, door, tray + UP, tray, tray + UP, np.zeros(3)]
    return _followed(arm, size * np.array(points))


def boxes(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """Way of the tool's point between random boxes by RRT-Connect, shortened, with 5 to 20 points on it."""
    ends = np.array([-0.1, -0.2, -0.15]), np.array([0.05, 0.2, 0.05])
    world = boxes_between(rng, SPACE, ends, 6)
    path = shortcut(world, RRT(step=0.03).connect(world, *ends, rng), rng, 30)
    return _followed(arm, size * _thinned(path, int(rng.integers(5, 21))))


def taught(rng: np.random.Generator, arm: Arm, size: float) -> Floats:
    """Points of a smooth curve as a hand teaches them, each 2 mm off or so; 15 waypoints."""
    return _followed(arm, size * (_curve(rng, 15) + rng.normal(0.0, 0.002, (15, 3))))


def dense(rng: np.random.Generator, arm: Arm, size: float, n_waypoints: int = 100) -> Floats:
    """Trace a smooth closed curve of the tool, densely."""
    return _followed(arm, size * _curve(rng, n_waypoints))


def _curve(rng: np.random.Generator, n_waypoints: int) -> Floats:
    u, extent = 2 * np.pi * np.linspace(0, 1, n_waypoints), rng.uniform(0.08, 0.15, 3)
    shift = rng.uniform(0, 2 * np.pi, 3)
    return extent * np.sin(np.stack([u, 2 * u, u], axis=1) + shift) * [1, 1, 0.4] - UP


def _thinned(path: Floats, n_points: int) -> Floats:
    """Points at equal lengths along a polyline of shape (n_nodes, 3)."""
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    at = np.linspace(0.0, along[-1], n_points)
    return np.stack([np.interp(at, along, column) for column in path.T], axis=1)


def _followed(arm: Arm, shifts: Floats) -> Floats:
    return followed(arm.robot, arm.home, shifts)


BENCH: dict[str, Task] = {
    "move2": move,
    "pick5": pick,
    "rand10": tour,
    "rand20": lambda rng, arm, size: tour(rng, arm, size, 20),
    "seam20": seam,
    "helix50": helix,
    "dense200": lambda rng, arm, size: dense(rng, arm, size, 200),
}
"""Tasks of the bench by name; a number counts waypoints, but for `pick5`, whose seven waypoints are five places."""

BENCH_ARMS = ("fr3", "ur5e", "iiwa7")
WITHOUT_JERK = ("pick5", "rand10", "helix50", "dense200")


def arm_problems(seed: int) -> Iterator[Problem]:
    """Draw the bench's problems: every task of three arms with jerk limits, some, named `-va`, without; 33 problems."""
    for name in BENCH_ARMS:
        arm = arm_named(name)
        for number, (task, draw) in enumerate(BENCH.items()):
            rng = np.random.default_rng([seed, number, len(name)])
            problem = Problem(f"{name}-{task}", draw(rng, arm, 1.0), arm.limits(jerk=True), end=EndCondition.SMOOTH)
            yield problem
            if task in WITHOUT_JERK:
                yield replace(problem, name=f"{name}-{task}-va", limits=arm.limits(jerk=False), end=EndCondition.REST)
