"""The suite of robots: every task for every arm whose file gives limits."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from study.errors import StudyError
from study.problem import Floats
from study.robots.arms import Arm, arm_named, arm_names
from study.suites import tasks
from study.suites.drawn import Drawn

TASKS: dict[str, tuple[tasks.Task, bool, str]] = {
    "move": (tasks.move, True, "point to point"),
    "pick": (tasks.pick, True, "pick and place with via points"),
    "palletise": (tasks.palletise, True, "palletising"),
    "seam": (tasks.seam, True, "weld seam with a weave"),
    "helix": (tasks.helix, True, "helix"),
    "raster": (tasks.raster, False, "raster scan"),
    "tending": (tasks.tending, True, "machine tending"),
    "boxes": (tasks.boxes, False, "path of RRT-Connect between boxes, thinned"),
    "taught": (tasks.taught, True, "taught points with noise"),
    "dense": (tasks.dense, False, "dense path"),
}
"""Name, generator, whether jerk is limited, and the task in words."""

IN_JOINTS = ("move", "tour")
"""Tasks that need no inverse kinematics."""

DRAWS, FARTHEST = 60, 2.8
"""Draws of a task until the arm can do it, and the longest way of a joint between neighbours, rad or m."""


def problems(seed: int, arms: Collection[str] | None = None, wanted: Collection[str] | None = None) -> list[Drawn]:
    """Draw the suite, or the part of some arms and tasks; every problem depends on the seed and its own name alone.

    Raises
    ------
    StudyError
        If an arm cannot do a task in any of 60 draws.
    """
    return [
        _problem(seed, name, task)
        for name in (arm_names() if arms is None else arms)
        for task in _tasks_of(arm_named(name))
        if wanted is None or task in wanted
    ]


def _tasks_of(arm: Arm) -> list[str]:
    """All tasks, or only those in joint space for an arm that cannot keep its tool's orientation in every direction."""
    return list(TASKS) if _keeps_orientation(arm) else ["move", "tour", "tour-va"]


def _keeps_orientation(arm: Arm) -> bool:
    """Whether the tool can be shifted along all three axes without turning, at home."""
    step = 1e-6
    poses = arm.robot.forward(np.vstack([arm.home, arm.home + step * np.eye(len(arm.home))]))
    shifts = (poses[1:, :3, 3] - poses[0, :3, 3]).T / step
    turns = ((poses[1:, :3, :3] - poses[0, :3, :3]) / step).reshape(len(arm.home), 9).T
    still = np.linalg.svd(turns)[2][np.linalg.matrix_rank(turns, tol=1e-3) :]
    return bool(np.linalg.matrix_rank(shifts @ still.T, tol=1e-2) == 3)


def _problem(seed: int, name: str, task: str) -> Drawn:
    draw, jerk, words = TASKS.get(
        task, (tasks.tour, not task.endswith("-va"), "random configurations one after another")
    )
    arm = arm_named(name)
    size = tasks.size_for(arm)
    for attempt in range(DRAWS):
        rng = np.random.default_rng([seed, attempt, *f"{name}:{task}".encode()])
        try:
            waypoints = draw(rng, arm, size)
        except StudyError:
            continue
        if _possible(arm, waypoints):
            break
    else:
        raise StudyError(f"arm {name!r} cannot do task {task!r} in {DRAWS} draws; change its home")
    tags = (
        task.removesuffix("-va"),
        "jerk" if jerk else "no jerk",
        f"{len(arm.home)} joints",
        _size_tag(len(waypoints)),
    )
    units = tuple("m" if sliding else "rad" for sliding in arm.robot.prismatic)
    source = f"study/suites/tasks.py, {draw.__name__}, seed {seed}, draw {attempt}, for the {arm.robot.title}"
    limits = arm.limits(jerk)
    return Drawn(f"{name}-{task}", source, words, tags, name, units, limits, arm.origins, waypoints)


def _possible(arm: Arm, waypoints: Floats) -> bool:
    low, high = arm.range
    with np.errstate(invalid="ignore"):
        room = np.where(np.isfinite(high - low), 0.01 * (high - low), 0.0)
    inside = (waypoints > low + room).all() and (waypoints < high - room).all()
    return bool(inside and np.abs(np.diff(waypoints, axis=0)).max() < FARTHEST)


def _size_tag(n_waypoints: int) -> str:
    return "short" if n_waypoints <= 7 else "medium" if n_waypoints <= 25 else "long"
