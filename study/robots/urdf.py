"""Arm read from a URDF file, with the same frames as an arm given by Denavit-Hartenberg parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from study.errors import StudyError
from study.io.urdf import Urdf, UrdfJoint, read_urdf, turn
from study.problem import Floats
from study.robots.chain import Robot
from study.robots.meshes import Shape, shapes_of


@dataclass(frozen=True, eq=False)
class UrdfRobot(Robot):
    """A serial arm whose joints stand where a URDF file says; its link parameters are zero and not used.

    Attributes
    ----------
    steps : tuple of tuple of UrdfJoint
        For every moving joint the joints from the one before it on: fixed ones, and itself last.
    shapes : tuple of Shape
        Meshes that stand for the links; none where the file names none or not all of them can be shown.
    missing : str
        Why they cannot be shown, or empty.
    """

    steps: tuple[tuple[UrdfJoint, ...], ...] = ()
    shapes: tuple[Shape, ...] = ()
    missing: str = ""

    def _steps(self, q: Floats) -> Floats:
        """Transforms from every frame to the next, shape (n, n_joints, 4, 4)."""
        columns = [_step(joints, q[:, k]) for k, joints in enumerate(self.steps)]
        return np.stack(columns, axis=1)


def _step(joints: Sequence[UrdfJoint], q: Floats) -> Floats:
    *held, mover = joints
    base = np.eye(4)
    for joint in (*held, mover):
        base = base @ joint.origin
    if mover.kind != "prismatic":
        return base @ turn(mover.axis, q)
    slide = np.tile(np.eye(4), (len(q), 1, 1))
    slide[:, :3, 3] = q[:, None] * mover.axis
    return base @ slide


def urdf_robot(path: Path, names: Sequence[str] = ()) -> UrdfRobot:
    """Read an arm from a URDF file.

    Parameters
    ----------
    path : Path
    names : sequence of str, optional
        Joints that move, from the base on; all moving ones if it is empty or holds strangers. Others on the way stand
        at zero.

    Raises
    ------
    StudyError
        If the file cannot be read or the joints do not form one chain.
    """
    urdf = read_urdf(path)
    moving = [joint.name for joint in urdf.moving]
    names = list(names) if names and set(names) <= set(moving) else moving
    if not names:
        raise StudyError(f"file {path.name!r}: no joint of it moves; give the URDF of an arm")
    groups: list[list[UrdfJoint]] = [[]]
    for joint in urdf.chain(names):
        groups[-1].append(joint)
        if joint.name in names:
            groups.append([])
    steps = tuple(tuple(group) for group in groups if group)
    movers = [group[-1] for group in steps]
    zeros = np.zeros(len(movers))
    shapes, missing = _shapes(urdf, names, path)
    lowest = [-np.inf if mover.lower is None else mover.lower for mover in movers]
    highest = [np.inf if mover.upper is None else mover.upper for mover in movers]
    return UrdfRobot(
        name=urdf.name,
        title=f"{urdf.name}, read from {path.name}",
        source=path.name,
        modified=False,
        prismatic=np.array([mover.kind == "prismatic" for mover in movers]),
        a=zeros,
        alpha=zeros,
        d=zeros,
        theta=zeros,
        range=np.array([lowest, highest]),
        steps=steps,
        shapes=shapes,
        missing=missing,
    )


def _shapes(urdf: Urdf, names: Sequence[str], path: Path) -> tuple[tuple[Shape, ...], str]:
    """All meshes, or none and why: an arm with some of its links left out would be taken for another one."""
    try:
        return shapes_of(urdf, names, path), ""
    except StudyError as error:
        return (), str(error)
