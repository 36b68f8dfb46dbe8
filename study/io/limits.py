"""Joint limits from the files that robots already have: MoveIt's `joint_limits.yaml`, franka_description's, and URDF.

References
----------
MoveIt 2, joint_limits.yaml as read by `moveit_robot_model_loader`: has_... switches and max_... values for each joint;
Pilz industrial motion planner: max_deceleration. franka_description, joint_limits.yaml: limit with lower, upper, velocity.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError
from study.io.documents import parsed
from study.io.table import number
from study.io.urdf import Urdf, UrdfJoint, read_urdf

SWITCHES = {
    "velocity": ("has_velocity_limits", "max_velocity"),
    "acceleration": ("has_acceleration_limits", "max_acceleration"),
    "jerk": ("has_jerk_limits", "max_jerk"),
    "lower": ("has_position_limits", "min_position"),
    "upper": ("has_position_limits", "max_position"),
    "min_velocity": ("has_velocity_limits", "min_velocity"),
    "min_acceleration": ("has_acceleration_limits", "min_acceleration"),
    "min_jerk": ("has_jerk_limits", "min_jerk"),
    "deceleration": ("has_deceleration_limits", "max_deceleration"),
}
"""Limits in MoveIt's words: the switch and the value."""

PLAIN = {"velocity": "velocity", "acceleration": "acceleration", "jerk": "jerk", "lower": "lower", "upper": "upper"}
"""Limits in the words of franka_description, below `limit`."""

KNOWN = {name for pair in SWITCHES.values() for name in pair} | {"angle_wraparound", "has_effort_limits", "max_effort"}
SCALING = {
    "default_velocity_scaling_factor": ("velocity", "min_velocity"),
    "default_acceleration_scaling_factor": ("acceleration", "min_acceleration"),
}


@dataclass(frozen=True)
class OneJoint:
    """Limits of one joint, rad or m and s; None where the file says nothing.

    Attributes
    ----------
    velocity, acceleration, jerk, lower, upper : float, optional
    min_velocity, min_acceleration, min_jerk : float, optional
        Lowest rates, negative, where they are not the highest ones mirrored.
    sliding : bool, optional
        Whether the joint slides, where the file knows.
    endless : bool, optional
        Whether the joint turns without end, where the file knows.
    """

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    lower: float | None = None
    upper: float | None = None
    min_velocity: float | None = None
    min_acceleration: float | None = None
    min_jerk: float | None = None
    sliding: bool | None = None
    endless: bool | None = None

    def over(self, other: OneJoint) -> OneJoint:
        """Lay these limits over another file's: what is said here wins."""
        said = {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) is not None}
        for name in ("velocity", "acceleration", "jerk"):  # a rate said anew is said in both directions
            if name in said:
                said.setdefault(f"min_{name}", None)
        return replace(other, **said)


@dataclass(frozen=True)
class LimitFile:
    """Limits of joints by name, masters of joints that follow others, and what was taken or left out.

    Attributes
    ----------
    joints : dict of str to OneJoint
    followers : dict of str to str
        Joint that follows: the joint that it follows.
    notes : tuple of str
    """

    joints: dict[str, OneJoint]
    followers: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def read_limits(path: Path) -> LimitFile:
    """Read limits of joints by name.

    Parameters
    ----------
    path : Path
        `.urdf`, `.xml` or `.xacro`: a robot description; else MoveIt's `joint_limits.yaml` or franka_description's, at
        whatever depth the joints stand, or the same as JSON.

    Raises
    ------
    StudyError
        If the file cannot be read, holds no limits, or a limit is not a number.
    """
    if path.suffix.lower() in (".urdf", ".xml", ".xacro"):
        return _from_urdf(read_urdf(path), f"file {path.name!r}")
    where, notes = f"file {path.name!r}", list[str]()
    content = parsed(path)
    outer, joints = _joints(content)
    if not joints:
        raise StudyError(f"{where} holds no limits: expected MoveIt's 'joint_limits' with one entry for each joint")
    read = {str(name): _entry(entry, f"{where}, joint {str(name)!r}", notes) for name, entry in joints.items()}
    for key, names in SCALING.items():
        if key in outer:
            factor = number(outer[key], f"{where}, {key!r}")
            if not 0 < factor <= 1:
                raise StudyError(f"{where}: {key!r} must be above 0 and at most 1, got {factor:g}")
            read = {name: _scaled(joint, names, factor) for name, joint in read.items()}
            if factor != 1:
                notes.append(f"{where}: limits of {names[0]} are multiplied by {key!r}, {factor:g}")
    return LimitFile(read, notes=tuple(notes))


def _joints(content: Any) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """The mapping that holds `joint_limits`, at any depth, and the joints in it; franka's file is nothing but joints."""
    if not isinstance(content, Mapping):
        return {}, {}
    joints = content.get("joint_limits")
    if isinstance(joints, Mapping) and joints:
        return content, joints
    if content and all(
        isinstance(entry, Mapping) and isinstance(entry.get("limit"), Mapping) for entry in content.values()
    ):
        return {}, content
    inner = (_joints(value) for value in content.values())
    return next((pair for pair in inner if pair[1]), ({}, {}))


def _entry(entry: Any, where: str, notes: list[str]) -> OneJoint:
    if not isinstance(entry, Mapping):
        raise StudyError(f"{where}: expected fields such as 'max_velocity', got {str(entry)[:60]!r}")
    if isinstance(entry.get("limit"), Mapping):
        limit = entry["limit"]
        unused = [str(key) for key in limit if key not in PLAIN and key != "effort"]
        notes += [f"{where}: not used: {', '.join(map(repr, unused))}"] if unused else []
        said = {
            name: number(limit[key], f"{where}: {key!r}") for name, key in PLAIN.items() if limit.get(key) is not None
        }
        return OneJoint(**said)  # type: ignore[arg-type]
    notes += [_unused(str(key), where) for key in entry if key not in KNOWN]
    values = dict(_said(entry, where))
    slowing = values.pop("deceleration", None)
    if slowing is not None:
        limit = min(abs(slowing), values.get("acceleration", np.inf))
        notes.append(
            f"{where}: 'max_deceleration' {abs(slowing):g} is taken for both speeding up and slowing down"
            if limit < values.get("acceleration", np.inf)
            else f"{where}: 'max_deceleration' is not tighter than the acceleration and changes nothing"
        )
        values["acceleration"] = limit
    return OneJoint(**values)  # type: ignore[arg-type]


def _unused(key: str, where: str) -> str:
    near = get_close_matches(key, KNOWN, n=1, cutoff=0.6)
    return f"{where}: unknown key {key!r} is not used" + (f"; did you mean {near[0]!r}?" if near else "")


def _said(entry: Mapping[str, Any], where: str) -> Iterator[tuple[str, float]]:
    for name, (switch, key) in SWITCHES.items():
        on = entry.get(switch, key in entry)
        if not isinstance(on, bool):
            raise StudyError(f"{where}: {switch!r} must be true or false, got {str(on)[:60]!r}")
        if not on or (key not in entry and name.startswith("min_")):
            continue
        if key not in entry:
            raise StudyError(f"{where}: {switch!r} is true, but {key!r} is missing; add it")
        value = entry[key]
        if isinstance(value, float) and not np.isfinite(value):
            raise StudyError(f"{where}: {key!r} must be finite, got {value:g}; set {switch!r} to false for no limit")
        try:
            yield name, number(value, where)
        except StudyError:
            raise StudyError(f"{where}: {key!r} must be a number, got {str(value)[:60]!r}") from None


def _scaled(joint: OneJoint, names: Sequence[str], factor: float) -> OneJoint:
    rates = {name: getattr(joint, name) for name in names}
    return replace(joint, **{name: value * factor for name, value in rates.items() if value is not None})


def _from_urdf(urdf: Urdf, where: str) -> LimitFile:
    movers = {joint.name: joint for joint in urdf.moving}
    joints = {name: _of_urdf(joint) for name, joint in movers.items() if joint.mimic is None}
    notes, followers = list(urdf.notes), dict[str, str]()
    for name, joint in movers.items():
        if joint.mimic is not None and joint.mimic.joint in joints:
            followers[name] = joint.mimic.joint
            joints[joint.mimic.joint] = _tightened(joints[joint.mimic.joint], joint)
            notes.append(f"{where}: joint {name!r} follows {joint.mimic.joint!r} and tightens its limits")
    return LimitFile(joints, followers, tuple(notes))


def _of_urdf(joint: UrdfJoint) -> OneJoint:
    return OneJoint(
        velocity=joint.velocity,
        lower=joint.lower,
        upper=joint.upper,
        sliding=joint.kind == "prismatic",
        endless=joint.kind == "continuous",
    )


def _tightened(master: OneJoint, follower: UrdfJoint) -> OneJoint:
    """Limits of a joint that another one follows: position = multiplier * master + offset."""
    if follower.mimic is None or not follower.mimic.multiplier:
        return master
    multiplier, offset = follower.mimic.multiplier, follower.mimic.offset
    ends = [None if end is None else (end - offset) / multiplier for end in (follower.lower, follower.upper)]
    low, high = ends if multiplier > 0 else ends[::-1]
    speed = None if follower.velocity is None else follower.velocity / abs(multiplier)
    return replace(
        master,
        velocity=min((v for v in (master.velocity, speed) if v is not None), default=None),
        lower=max((v for v in (master.lower, low) if v is not None), default=None),
        upper=min((v for v in (master.upper, high) if v is not None), default=None),
    )
