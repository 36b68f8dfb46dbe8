"""Arms with masses: from a file with a DH table and its published dynamic model, or from a URDF with inertias.

References
----------
ROS, urdf/XML/link: inertial, its origin, mass and inertia; urdf/XML/joint: limit effort, dynamics damping and friction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from study.errors import StudyError, unknown
from study.io.urdf import Urdf, UrdfJoint, number_of, place_of, read_urdf, turn
from study.io.xml_file import read_xml
from study.mechanism import Mechanism, steiner
from study.problem import Floats
from study.robots import robot_file, robot_named
from study.robots.chain import screw_x, screw_z
from study.robots.file import Link
from study.robots.urdf import UrdfRobot


@dataclass(frozen=True, eq=False)
class HeavyArm:
    """A mechanism, with friction, and the torque limits that its file states.

    Attributes
    ----------
    mechanism : Mechanism
    effort : array of shape (n_joints,), N m or N
        Infinite where none is stated.
    source : str
    """

    mechanism: Mechanism
    effort: Floats
    source: str


def heavy_arm(name: str, joints: Sequence[str] = (), frame: str = "") -> HeavyArm:
    """Arm of a name or a file, with its masses where they are stated, else with none.

    Parameters
    ----------
    name : str
        As for `study.robots.robot_named`.
    joints : sequence of str
        Which joints of a URDF move.
    frame : str
        Link of a URDF whose frame is the tool's; by default the last joint's.

    Raises
    ------
    StudyError
        If there is no such arm or frame, or what the file says of masses makes no sense.
    """
    if name.endswith((".urdf", ".xml", ".xacro")):
        return _from_urdf(Path(name), joints, frame)
    if frame:
        raise StudyError(
            f"robot {name!r} is given by a DH table, which names no frames; leave out 'frame' and give 'at'"
        )
    return _from_table(name)


def _from_table(name: str) -> HeavyArm:
    """Bodies in the frames of the links become bodies in the frames of the joints before them."""
    robot, model = robot_named(name), robot_file(name).dynamics
    n = robot.n_joints
    links = model.links if model else [Link()] * n
    after, along = screw_x(robot.alpha, robot.a), screw_z(robot.theta, robot.d)
    if robot.modified:
        origins, last = after @ along, np.tile(np.eye(4), (n, 1, 1))
    else:
        origins, last = np.concatenate([np.eye(4)[None], after[:-1]]) @ along, after
    turns = last[:, :3, :3]
    inertias = np.array([link.tensor for link in links])
    mechanism = Mechanism(
        origins,
        robot.prismatic.astype(float),
        np.array([link.mass for link in links]),
        (turns @ np.array([link.centre for link in links])[..., None])[..., 0] + last[:, :3, 3],
        turns @ inertias @ np.swapaxes(turns, 1, 2),
        np.array([link.rotor for link in links]),
        np.array([link.viscous for link in links]),
        np.array([link.coulomb for link in links]),
        tool=last[-1],
    )
    effort = np.array([np.inf if link.torque is None else link.torque for link in links])
    return HeavyArm(mechanism, effort, model.source if model else "")


def _from_urdf(path: Path, names: Sequence[str], frame: str) -> HeavyArm:
    robot, urdf, root = robot_named(str(path), tuple(names)), read_urdf(path), read_xml(path)
    if not isinstance(robot, UrdfRobot):
        raise StudyError(f"file {path.name!r} is no URDF")
    moving = [step[-1] for step in robot.steps]
    for joint in (joint for step in robot.steps for joint in step[:-1] if joint.name in robot.drives):
        raise StudyError(
            f"file {path.name!r}: joint {joint.name!r} follows another on the way to the tool; torques and the tool's speed "
            "are not known of such an arm"
        )
    aligned = [_along_z(joint) for joint in moving]
    origins = [_standing(step) @ turned for step, turned in zip(robot.steps, aligned, strict=True)]
    for k in range(1, len(origins)):
        origins[k] = aligned[k - 1].T @ origins[k]
    bodies = _bodies(urdf, root, [joint.child for joint in moving], aligned, path)
    tool = aligned[-1].T
    if frame:
        links = {joint.child for joint in urdf.joints}
        if frame not in links:
            raise unknown(f"frame in URDF {urdf.name!r}:", frame, links)
        beyond = _beyond(urdf, moving[-1], frame, path)
        tool = tool @ _standing(beyond)
    elements = {element.get("name"): element for element in root.findall("joint")}
    stated = {
        part: np.array([_said(elements[joint.name], *key, path) for joint in moving]) for part, key in _KEYS.items()
    }
    effort = np.where(stated["effort"] > 0, stated["effort"], np.inf)
    sliding = np.array([joint.kind == "prismatic" for joint in moving], dtype=float)
    zero = np.zeros(len(moving))
    mechanism = Mechanism(np.array(origins), sliding, *bodies, zero, stated["viscous"], stated["coulomb"], tool=tool)
    return HeavyArm(mechanism, effort, path.name)


_KEYS = {"effort": ("limit", "effort"), "viscous": ("dynamics", "damping"), "coulomb": ("dynamics", "friction")}


def _said(element: ET.Element, tag: str, key: str, path: Path) -> float:
    return number_of(element.find(tag), key, f"file {path.name!r}, joint {element.get('name')!r}") or 0.0


def _along_z(joint: UrdfJoint) -> Floats:
    """Turn that brings z to a joint's axis, shape (4, 4)."""
    z, axis = np.array([0.0, 0.0, 1.0]), joint.axis
    across = np.cross(z, axis)
    if not np.linalg.norm(across) > 1e-12:
        return np.eye(4) if axis[2] > 0 else np.diag([1.0, -1.0, -1.0, 1.0])
    return turn(across / np.linalg.norm(across), np.array([np.arctan2(np.linalg.norm(across), axis[2])]))[0]


def _standing(joints: Sequence[UrdfJoint]) -> Floats:
    """Transform along joints that all stand at zero."""
    result = np.eye(4)
    for joint in joints:
        result = result @ joint.origin
    return result


def _beyond(urdf: Urdf, last: UrdfJoint, frame: str, path: Path) -> tuple[UrdfJoint, ...]:
    """Joints from the last moving one to a frame."""
    above = urdf.above(frame)
    names = [joint.name for joint in above]
    if last.name not in names:
        raise StudyError(
            f"file {path.name!r}: frame {frame!r} does not move with the last joint, {last.name!r}; name one that does"
        )
    return above[names.index(last.name) + 1 :]


def _bodies(
    urdf: Urdf, root: ET.Element, carriers: Sequence[str], aligned: Sequence[Floats], path: Path
) -> tuple[Floats, Floats, Floats]:
    """Masses, centres and inertias of all links, put together by the moving joint that carries them."""
    n = len(carriers)
    parts: list[list[tuple[float, Floats, Floats]]] = [[] for _ in range(n)]
    for link in root.findall("link"):
        inertial = link.find("inertial")
        above = urdf.above(link.get("name", ""))
        carried = [k for k, child in enumerate(carriers) if child in [joint.child for joint in above]]
        if inertial is None or not carried:
            continue
        where = f"file {path.name!r}, link {link.get('name')!r}"
        body = max(carried)
        first = [joint.child for joint in above].index(carriers[body]) + 1
        place = aligned[body].T @ _standing(above[first:]) @ place_of(inertial, where)
        tensor = inertial.find("inertia")
        values = [number_of(tensor, key, where) or 0.0 for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")]
        mass = number_of(inertial.find("mass"), "value", where) or 0.0
        if mass < 0:
            raise StudyError(f"{where}: its mass must not be negative, got {mass:g}")
        turned = place[:3, :3] @ _symmetric(values) @ place[:3, :3].T
        parts[body].append((mass, place[:3, 3], turned))
    masses, centres, inertias = np.zeros(n), np.zeros((n, 3)), np.zeros((n, 3, 3))
    for body, pieces in enumerate(parts):
        masses[body] = sum(mass for mass, _, _ in pieces)
        if masses[body]:
            centres[body] = sum(mass * centre for mass, centre, _ in pieces) / masses[body]
        for mass, centre, inertia in pieces:
            inertias[body] += inertia + steiner(mass, centre - centres[body])
    return masses, centres, inertias


def _symmetric(values: Sequence[float]) -> Floats:
    """Tensor of xx, yy, zz, xy, xz and yz."""
    xx, yy, zz, xy, xz, yz = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def without_friction(mechanism: Mechanism) -> Mechanism:
    """The same arm, running smoothly."""
    nothing = np.zeros(mechanism.n_joints)
    return replace(mechanism, viscous=nothing, coulomb=nothing)
