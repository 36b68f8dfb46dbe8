"""Arm read from a URDF file, with the same frames as an arm given by Denavit-Hartenberg parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from study.errors import StudyError
from study.io.urdf import Urdf, UrdfJoint, read_urdf, turn
from study.problem import Floats
from study.robots.chain import Robot
from study.robots.meshes import Shape, shapes_of


class Drive(NamedTuple):
    """Position of a joint by that of one of the arm's: multiplier * q[joint] + offset."""

    joint: int
    multiplier: float = 1.0
    offset: float = 0.0


class Carrier(NamedTuple):
    """Frame beside the arm's own, such as a finger's: the frame before it, and the joints from there on."""

    before: int
    joints: tuple[UrdfJoint, ...]


@dataclass(frozen=True, eq=False)
class UrdfRobot(Robot):
    """A serial arm whose joints stand where a URDF file says; its link parameters are zero and not used.

    Attributes
    ----------
    steps : tuple of tuple of UrdfJoint
        For every moving joint the joints from the one before it on: fixed ones and such that follow others, and itself last.
    drives : mapping of str to Drive
        Joints that move: those of the arm and all that follow one of these.
    carriers : tuple of Carrier
        Frames of joints that follow, as far as meshes hang on them.
    shapes : tuple of Shape
        Meshes that stand for the links; none where the file names none or not all of them can be shown.
    plain : tuple of Shape
        Those that links are looked for collisions with, where every link that is shown has one.
    missing : str
        Why they cannot be shown, or empty.
    """

    steps: tuple[tuple[UrdfJoint, ...], ...] = ()
    drives: Mapping[str, Drive] = field(default_factory=dict)
    carriers: tuple[Carrier, ...] = ()
    shapes: tuple[Shape, ...] = ()
    plain: tuple[Shape, ...] = ()
    missing: str = ""

    def _steps(self, q: Floats) -> Floats:
        """Transforms from every frame to the next, shape (n, n_joints, 4, 4)."""
        return np.stack([self._moved(joints, q) for joints in self.steps], axis=1)

    def mesh_frames(self, q: Floats) -> Floats:
        """Frames of the arm, then those of the carriers, shape (n, n_joints + 1 + n_carriers, 4, 4), lengths in m."""
        frames = list(np.moveaxis(self.frames(q), 1, 0))
        for before, joints in self.carriers:
            frames.append(frames[before] @ self._moved(joints, q))
        return np.stack(frames, axis=1)

    def _moved(self, joints: Sequence[UrdfJoint], q: Floats) -> Floats:
        """Transform along some joints, shape (n, 4, 4)."""
        result = np.tile(np.eye(4), (len(q), 1, 1))
        for joint in joints:
            result = result @ joint.origin
            if drive := self.drives.get(joint.name):
                result = result @ _motion(joint, drive.multiplier * q[:, drive.joint] + drive.offset)
        return result


def _motion(joint: UrdfJoint, positions: Floats) -> Floats:
    if joint.kind != "prismatic":
        return turn(joint.axis, positions)
    slide = np.tile(np.eye(4), (len(positions), 1, 1))
    slide[:, :3, 3] = positions[:, None] * joint.axis
    return slide


def urdf_robot(path: Path, names: Sequence[str] = ()) -> UrdfRobot:
    """Read an arm from a URDF file.

    Parameters
    ----------
    path : Path
    names : sequence of str, optional
        Joints that move, from the base on; all that turn or slide and follow no other if it is empty or holds strangers.
        Joints that follow one of them move along; others on the way stand at zero.

    Raises
    ------
    StudyError
        If the file cannot be read or the joints do not form one chain.
    """
    urdf = read_urdf(path)
    movers = {joint.name: joint for joint in urdf.moving}
    leading = [name for name, joint in movers.items() if joint.mimic is None or joint.mimic.joint not in movers]
    names = list(names) if names and set(names) <= set(movers) else leading
    if not names:
        raise StudyError(f"file {path.name!r}: no joint of it moves; give the URDF of an arm")
    groups: list[list[UrdfJoint]] = [[]]
    for joint in urdf.chain(names):
        groups[-1].append(joint)
        if joint.name in names:
            groups.append([])
    steps = tuple(tuple(group) for group in groups if group)
    last = [group[-1] for group in steps]
    zeros = np.zeros(len(last))
    drives = {name: _drive(movers, names, name) for name in movers if name in names or movers[name].mimic is not None}
    places, carriers = _carriers(urdf, names, drives)
    shapes, missing = shapes_of(urdf, urdf.meshes, places, path)
    bare = {mesh.link for mesh in urdf.meshes} - {mesh.link for mesh in urdf.collisions}
    plain = () if bare else shapes_of(urdf, urdf.collisions, places, path)[0]
    lowest = [-np.inf if mover.lower is None else mover.lower for mover in last]
    highest = [np.inf if mover.upper is None else mover.upper for mover in last]
    return UrdfRobot(
        name=urdf.name,
        title=f"{urdf.name}, read from {path.name}",
        source=path.name,
        modified=False,
        prismatic=np.array([mover.kind == "prismatic" for mover in last]),
        a=zeros,
        alpha=zeros,
        d=zeros,
        theta=zeros,
        range=np.array([lowest, highest]),
        steps=steps,
        drives=drives,
        carriers=carriers,
        shapes=shapes,
        plain=plain,
        missing=missing,
    )


def _drive(movers: Mapping[str, UrdfJoint], names: Sequence[str], name: str) -> Drive:
    """Follow a joint's masters to one of the arm's, or to one that stands at zero."""
    multiplier, offset = 1.0, 0.0
    for _ in movers:
        mimic = movers[name].mimic if name in movers and name not in names else None
        if mimic is None:
            break
        name, multiplier, offset = mimic.joint, multiplier * mimic.multiplier, multiplier * mimic.offset + offset
    return Drive(names.index(name), multiplier, offset) if name in names else Drive(0, 0.0, offset)


def _carriers(
    urdf: Urdf, names: Sequence[str], drives: Mapping[str, Drive]
) -> tuple[dict[str, int], tuple[Carrier, ...]]:
    """Frame behind every joint that moves, by the joint's name, and those frames that are not the arm's."""
    places, carriers = {name: k + 1 for k, name in enumerate(names)}, list[Carrier]()
    for mesh in (*urdf.meshes, *urdf.collisions):
        before, held = 0, list[UrdfJoint]()
        for joint in urdf.above(mesh.link):
            held.append(joint)
            if joint.name in drives and joint.name not in places:
                carriers.append(Carrier(before, tuple(held)))
                places[joint.name] = len(names) + len(carriers)
            if joint.name in places:
                before, held = places[joint.name], []
    return places, tuple(carriers)
