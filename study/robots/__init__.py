"""Robot arms of the papers and of files: chains, forward and inverse kinematics."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from study.datafiles import checked, data_folder, read_yaml
from study.errors import StudyError, unknown
from study.problem import Floats
from study.robots.chain import Robot, Solver
from study.robots.closed_form import BRANCHES, puma_inverse, ur_inverse, woodworking_inverse
from study.robots.file import RobotFile
from study.robots.urdf import urdf_robot

__all__ = ["BRANCHES", "SOLVERS", "Robot", "inverse", "robot_file", "robot_named", "robot_names"]

SOLVERS: dict[str, Solver] = {"ur": ur_inverse, "puma": puma_inverse, "woodworking": woodworking_inverse}

_CLOSE = 1e-6
"""Largest error of a solution's pose, as fed back through forward kinematics, m or without unit."""


def robot_names() -> list[str]:
    """Names of the arms that the data holds."""
    return [path.stem for path in _files()]


@cache
def robot_named(name: str, joints: tuple[str, ...] = ()) -> Robot:
    """Arm of a name, or read from a file of one's own.

    Parameters
    ----------
    name : str
        One of `robot_names()`, or the path of a URDF file or of a file like those in `data/robots`.
    joints : tuple of str
        Which joints of a URDF move, if it has them all; every moving one otherwise.

    Raises
    ------
    StudyError
        If there is no such arm, or its file is broken.
    """
    if name.endswith((".urdf", ".xml", ".xacro")):
        return urdf_robot(Path(name), joints)
    if Path(name).suffix:
        return _robot(Path(name))
    return _robot(_path(name))


def robot_file(name: str) -> RobotFile:
    """Content of the file of an arm that the data holds, or of one like those.

    Raises
    ------
    StudyError
        If there is no such arm, or its file is broken.
    """
    return _read(Path(name) if Path(name).suffix else _path(name))


def inverse(robot: Robot, poses: ArrayLike, branch: tuple[int, int, int] | None = None) -> Floats:
    """Inverse kinematics: configurations that put the arm's last frame at given poses.

    Parameters
    ----------
    robot : Robot
    poses : array of shape (n, 4, 4)
        Homogeneous transforms into the base frame, lengths in m.
    branch : tuple of three signs (k1, k2, k3), optional
        One unique domain instead of all branches.

    Returns
    -------
    array of shape (n, n_branches, n_joints), or (n, n_joints) for one branch, rad or m
        Among all branches those that do not exist are NaN; their order is `BRANCHES`.

    Raises
    ------
    StudyError
        If the arm has no closed form here, or a pose is singular or cannot be reached.
    """
    targets = np.asarray(poses, dtype=float)
    if targets.ndim != 3 or targets.shape[1:] != (4, 4):
        raise StudyError(f"robot {robot.name!r}: poses must have shape (n, 4, 4), got {targets.shape}")
    if robot.solver is None:
        raise StudyError(f"robot {robot.name!r} has no closed-form inverse here; arms that have one name a solver")
    if branch is not None and branch not in BRANCHES:
        raise StudyError(f"a branch is three signs such as (1, 1, -1), got {branch}")
    solutions = SOLVERS[robot.solver](robot, targets, BRANCHES if branch is None else (branch,))
    solutions[~_reached(robot, solutions, targets)] = np.nan
    missing = np.isnan(solutions).all(axis=(1, 2))
    if missing.any():
        raise StudyError(
            f"robot {robot.name!r}: pose {int(missing.argmax()) + 1} is singular or cannot be reached; move it inside "
            "the workspace or take another branch"
        )
    return solutions[:, 0] if branch is not None else solutions


def _reached(robot: Robot, solutions: Floats, targets: Floats) -> np.ndarray:
    poses, branches, joints = solutions.shape
    reached = robot.forward(np.nan_to_num(solutions).reshape(-1, joints)).reshape(poses, branches, 4, 4)
    close = np.abs(reached - targets[:, None]).max(axis=(2, 3)) < _CLOSE
    return close & ~np.isnan(solutions).any(axis=2)


def _files() -> list[Path]:
    return sorted((data_folder() / "robots").glob("*.yaml"))


def _path(name: str) -> Path:
    files = {path.stem: path for path in _files()}
    if name not in files:
        raise unknown("robot", name, files)
    return files[name]


@cache
def _read(path: Path) -> RobotFile:
    return checked(RobotFile, read_yaml(path), f"file {path.name!r}")


def _robot(path: Path) -> Robot:
    file = _read(path)
    prismatic = np.array([joint.kind == "prismatic" for joint in file.joints])
    ranges = np.array([joint.range or (-np.inf, np.inf) for joint in file.joints])
    return Robot(
        name=path.stem,
        title=file.title,
        source=file.source,
        modified=file.convention == "modified",
        prismatic=prismatic,
        a=np.array([joint.a for joint in file.joints]) * file.metre,
        alpha=np.radians([joint.alpha for joint in file.joints]),
        d=np.array([joint.d for joint in file.joints]) * file.metre,
        theta=np.radians([joint.theta for joint in file.joints]),
        range=ranges.T * np.where(prismatic, file.metre, np.pi / 180.0),
        solver=file.solver,
    )
