"""Joints, limits, frames and meshes of a URDF file: chains of revolute, continuous, prismatic and fixed joints.

References
----------
ROS, urdf/XML/joint: origin xyz and rpy, axis, limit lower, upper and velocity; rpy turns about fixed x, then y, then z.
ROS, urdf/XML/link: visual, its origin, geometry/mesh filename and scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from study.errors import StudyError, unknown
from study.io.xml_file import read_xml
from study.problem import Floats

LARGEST = 1e12
"""Size of a place, an angle or a scale, in m or rad, that no arm has."""

MOVING = ("revolute", "continuous", "prismatic")
SEVERAL = ("planar", "floating")
"""Kinds of joints with several degrees of freedom, which no list of positions holds; they stand still here."""


@dataclass(frozen=True)
class Mimic:
    """Rule by which a joint follows another: position = multiplier * position of `joint` + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """One joint as the file states it.

    Attributes
    ----------
    name, kind, parent, child : str
    origin : array of shape (4, 4), m
        From the parent link's frame to the joint's.
    axis : array of shape (3,)
        Of unit length, in the joint's frame.
    velocity, lower, upper : float, optional, rad or m and s
        The range is the soft one of a safety controller where that is narrower.
    mimic : Mimic, optional
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Floats
    axis: Floats
    velocity: float | None
    lower: float | None
    upper: float | None
    mimic: Mimic | None = None


@dataclass(frozen=True, eq=False)
class UrdfMesh:
    """A mesh that a link is shown as.

    Attributes
    ----------
    link : str
    file : str
        As the file states it: a path, or `package://NAME/PATH`.
    origin : array of shape (4, 4), m
        From the link's frame to the mesh's.
    scale : array of shape (3,)
    """

    link: str
    file: str
    origin: Floats
    scale: Floats


@dataclass(frozen=True, eq=False)
class Urdf:
    """A robot description: its name, joints and meshes in the file's order, and notes on how they were taken.

    `collisions` are the meshes that links are looked for collisions with, mostly smaller than what they are shown as.
    """

    name: str
    joints: tuple[UrdfJoint, ...]
    meshes: tuple[UrdfMesh, ...] = ()
    notes: tuple[str, ...] = ()
    collisions: tuple[UrdfMesh, ...] = ()

    @property
    def moving(self) -> tuple[UrdfJoint, ...]:
        """Joints that turn or slide."""
        return tuple(joint for joint in self.joints if joint.kind in MOVING)

    def chain(self, names: Sequence[str]) -> tuple[UrdfJoint, ...]:
        """All joints from the root to the last of the named ones, fixed and unnamed ones among them.

        Raises
        ------
        StudyError
            If a name is unknown, or the named joints do not lie on one chain in the order given.
        """
        by_name = {joint.name: joint for joint in self.joints}
        for name in names:
            if name not in by_name:
                raise unknown(f"joint in URDF {self.name!r}:", name, by_name)
            if by_name[name].kind in SEVERAL:
                raise StudyError(
                    f"URDF {self.name!r}: joint {name!r} is {by_name[name].kind} and has several degrees of freedom; name joints "
                    "that turn or slide"
                )
        path = self.above(by_name[names[-1]].child)
        if [joint.name for joint in path if joint.name in names] != list(names):
            raise StudyError(f"URDF {self.name!r}: joints {', '.join(names)} do not follow each other on one chain")
        return path

    def above(self, link: str) -> tuple[UrdfJoint, ...]:
        """All joints from the root to a link.

        Raises
        ------
        StudyError
            If the links form a loop.
        """
        by_child = {joint.child: joint for joint in self.joints}
        path: list[UrdfJoint] = []
        while link in by_child:
            path.insert(0, by_child[link])
            link = path[0].parent
            if len(path) > len(self.joints):
                raise StudyError(f"URDF {self.name!r}: its links form a loop; only trees can be read")
        return tuple(path)


def read_urdf(path: Path) -> Urdf:
    """Read a URDF file.

    Raises
    ------
    StudyError
        If the file cannot be read, is not URDF, or a joint is incomplete.
    """
    where = f"file {path.name!r}"
    root, notes = read_xml(path), list[str]()
    if root.tag != "robot":
        raise StudyError(f"{where} is not URDF: its outermost element is {root.tag!r}, expected 'robot'")
    joints = tuple(_joint(element, where, notes) for element in root.findall("joint"))
    if not joints:
        raise StudyError(f"{where} has no joints; give the URDF of an arm")
    meshes, collisions = (
        tuple(
            _mesh(link.get("name", ""), part, mesh, where)
            for link in root.findall("link")
            for part in link.findall(kind)
            if (mesh := part.find("geometry/mesh")) is not None
        )
        for kind in ("visual", "collision")
    )
    return Urdf(root.get("name", path.stem), joints, meshes, tuple(notes), collisions)


def _joint(element: ET.Element, where: str, notes: list[str]) -> UrdfJoint:
    name, kind = element.get("name"), element.get("type")
    if name is None or kind is None:
        raise StudyError(f"{where}: a joint needs a name and a type, got {name!r} and {kind!r}")
    here = f"{where}, joint {name!r}"
    links = [link.get("link") if (link := element.find(end)) is not None else None for end in ("parent", "child")]
    if links[0] is None or links[1] is None:
        raise StudyError(f"{here}: it needs a parent link and a child link")
    values = _limits(element, kind, here, notes)
    axis = _triple(element.find("axis"), "xyz", (1, 0, 0), here)
    if kind in MOVING and not np.linalg.norm(axis):
        raise StudyError(f"{here}: its axis has no length")
    axis = axis / (np.linalg.norm(axis) or 1.0)
    return UrdfJoint(
        name, kind, links[0], links[1], place_of(element, here), axis, **values, mimic=_mimic(element, here)
    )


def _limits(element: ET.Element, kind: str, where: str, notes: list[str]) -> dict[str, float | None]:
    """Velocity, lower and upper end; what cannot be meant is no limit, with a note."""
    limit, safety = element.find("limit"), element.find("safety_controller")
    values = {key: number_of(limit, key, where) for key in ("velocity", "lower", "upper")}
    if kind not in MOVING:
        notes += [f"{where} is {kind}, with several degrees of freedom, and stands still"] if kind in SEVERAL else []
        return values
    if (values["velocity"] or 0.0) < 0:
        raise StudyError(f"{where}: 'velocity' must not be negative, got {values['velocity']:g}")
    if values["velocity"] == 0:
        notes.append(f"{where}: velocity 0 is taken as not stated")
        values["velocity"] = None
    if kind == "continuous":
        return values | {"lower": None, "upper": None}
    if limit is not None and (limit.get("lower") is None) != (limit.get("upper") is None):
        values |= {key: values[key] or 0.0 for key in ("lower", "upper")}  # URDF: what is left out is 0
    for key, soft, choose in (("lower", "soft_lower_limit", max), ("upper", "soft_upper_limit", min)):
        end = number_of(safety, soft, where)
        stated = values[key]
        if end is not None and stated is not None and choose(end, stated) != stated:
            notes.append(f"{where}: {key} end of its range is the safety controller's, {end:g}, not {stated:g}")
            values[key] = end
    if values["lower"] is not None and values["upper"] is not None and values["lower"] > values["upper"]:
        raise StudyError(
            f"{where}: its range from {values['lower']:g} to {values['upper']:g} is empty; exchange its ends"
        )
    if values["lower"] is not None and values["lower"] == values["upper"]:
        notes.append(f"{where}: a range from {values['lower']:g} to {values['upper']:g} is taken as not stated")
        values |= {"lower": None, "upper": None}
    return values


def _mimic(element: ET.Element, where: str) -> Mimic | None:
    mimic = element.find("mimic")
    if mimic is None:
        return None
    multiplier, offset = number_of(mimic, "multiplier", where), number_of(mimic, "offset", where)
    return Mimic(mimic.get("joint", ""), 1.0 if multiplier is None else multiplier, offset or 0.0)


def _mesh(link: str, visual: ET.Element, mesh: ET.Element, where: str) -> UrdfMesh:
    here = f"{where}, link {link!r}"
    return UrdfMesh(link, mesh.get("filename", ""), place_of(visual, here), _triple(mesh, "scale", (1, 1, 1), here))


def number_of(element: ET.Element | None, key: str, where: str) -> float | None:
    """Read an attribute that is a number; None where it is missing, or infinite and a limit."""
    text = None if element is None else element.get(key)
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if np.isinf(value) and key in ("velocity", "lower", "upper", "effort"):
        return None  # no limit, as some exporters write it
    if not np.isfinite(value):
        raise StudyError(f"{where}: {key!r} must be a finite number, got {text!r}")
    return value


def _triple(element: ET.Element | None, key: str, usual: tuple[float, float, float], where: str) -> Floats:
    text = None if element is None else element.get(key)
    try:
        values = np.array(usual if text is None else text.split(), dtype=float)
    except ValueError:
        values = np.empty(0)
    if values.shape != (3,) or not (np.abs(values) <= LARGEST).all():
        raise StudyError(f"{where}: {key!r} must be three numbers up to {LARGEST:g}, got {text!r}")
    return values


def place_of(element: ET.Element, where: str) -> Floats:
    """Transform that an element's `origin` states, shape (4, 4), m."""
    origin = element.find("origin")
    offset, angles = _triple(origin, "xyz", (0, 0, 0), where), _triple(origin, "rpy", (0, 0, 0), where)
    x, y, z = (turn(np.eye(3)[k], np.array([angle]))[0] for k, angle in enumerate(angles))
    result = z @ y @ x
    result[:3, 3] = offset
    return result


def turn(axis: Floats, angles: Floats) -> Floats:
    """Turn about an axis of unit length: transforms of shape (n, 4, 4) for angles of shape (n,), by Rodrigues' formula."""
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    result = np.tile(np.eye(4), (len(angles), 1, 1))
    result[:, :3, :3] += np.sin(angles)[:, None, None] * cross + (1 - np.cos(angles))[:, None, None] * (cross @ cross)
    return result
