"""Joint limits from the files that robots already have: MoveIt's `joint_limits.yaml`, franka_description's, and URDF.

References
----------
MoveIt 2, joint_limits.yaml as read by `moveit_robot_model_loader`: has_... switches and max_... values for each joint;
Pilz industrial motion planner: max_deceleration; ros2_control, joint_limits: soft limits. franka_description,
joint_limits.yaml: limit with lower, upper, velocity.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError
from study.files import named
from study.io.documents import parsed
from study.io.one_joint import RATES, OneJoint, tightened
from study.io.table import number
from study.io.urdf import Mimic, read_urdf

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
    "soft_lower": ("has_soft_limits", "soft_lower_limit"),
    "soft_upper": ("has_soft_limits", "soft_upper_limit"),
}
"""Limits in MoveIt's words: the switch and the value."""

PLAIN = (*RATES, "lower", "upper")
"""Limits in the words of franka_description, below `limit`; with nothing below it, they are read too."""

KNOWN = {name for pair in SWITCHES.values() for name in pair} | {*PLAIN, "name", "effort"}
KNOWN |= {"angle_wraparound", "has_effort_limits", "max_effort", "k_position", "k_velocity"}
SCALING = {f"default_{rate}_scaling_factor": (rate, f"min_{rate}") for rate in RATES[:2]}
FLAT = re.compile(r"(?:.*\.)?(?:joint_limits\.(?P<joint>.+)\.(?P<key>\w+)|(?P<factor>default_\w+_factor))")
"""Parameters of ROS 2 written in one word, levels separated by dots."""


@dataclass(frozen=True)
class LimitFile:
    """Limits of joints by name, masters of joints that follow others, and what was taken or left out.

    Attributes
    ----------
    joints : dict of str to OneJoint
    followers : dict of str to str
        Joint that follows: the joint that it follows, which has both joints' limits.
    notes : tuple of str
    """

    joints: dict[str, OneJoint]
    followers: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def read_limits(*paths: str | Path) -> LimitFile:
    """Read limits of joints by name; what a later file says wins.

    Parameters
    ----------
    *paths : str or Path
        `.urdf`, `.xml` or `.xacro`: a robot description; else MoveIt's `joint_limits.yaml` or franka_description's, at
        whatever depth the joints stand, or the same as JSON.

    Raises
    ------
    StudyError
        If a file cannot be read, holds no limits, or a limit is not a number or makes no sense.
    """
    joints, mimics, notes = dict[str, OneJoint](), dict[str, Mimic](), list[str]()
    files = [named(path) for path in paths]
    for path in files:
        said = _from_urdf(path, mimics, notes) if path.suffix.lower() in XML else _from_document(path, notes)
        joints |= {name: joint.over(joints.get(name, OneJoint())) for name, joint in said.items()}
    followers = {}
    for name, mimic in mimics.items():
        master, multiplier, offset = mimic.joint, mimic.multiplier, mimic.offset
        for _ in mimics:  # a joint may follow one that follows
            if master in mimics:
                above = mimics[master]
                master, multiplier, offset = (
                    above.joint,
                    multiplier * above.multiplier,
                    multiplier * above.offset + offset,
                )
        if master not in joints or master in mimics:
            notes.append(f"joint {name!r} mimics {mimic.joint!r}, which leads no joint here, and is taken by itself")
            continue
        before, followers[name] = joints[master], master
        joints[master] = after = tightened(before, joints[name], multiplier, offset)
        if after.lower is not None and after.upper is not None and after.lower >= after.upper:
            raise StudyError(
                f"joint {name!r} follows {master!r}, but their ranges in {_named(files)} leave no room for both"
            )
        notes.append(
            f"joint {name!r} follows {master!r}" + (" and tightens its limits" if joints[master] != before else "")
        )
    return LimitFile({name: joint for name, joint in joints.items() if name not in followers}, followers, tuple(notes))


def _named(paths: Sequence[Path]) -> str:
    return ", ".join(path.name for path in paths)


XML = (".urdf", ".xml", ".xacro")


def _from_document(path: Path, notes: list[str]) -> dict[str, OneJoint]:
    where, content, joints = f"file {path.name!r}", parsed(path), dict[str, OneJoint]()
    for outer, entries in _tables(content):
        read = {str(name): _entry(entry, f"{where}, joint {str(name)!r}", notes) for name, entry in entries.items()}
        for key in outer:
            if key in SCALING:
                read = _scaled(read, key, number(outer[key], f"{where}, {key!r}"), where, notes)
            elif key != "joint_limits" and not any(_tables(outer[key])):
                notes.append(_unused(str(key), where, SCALING))
        joints |= read
    if not joints:
        keys = f"; its keys are {', '.join(map(str, list(content)[:8]))}" if isinstance(content, Mapping) else ""
        raise StudyError(
            f"{where} holds no limits: expected MoveIt's 'joint_limits' with one entry for each joint{keys}"
        )
    return joints


def _tables(
    content: Any, outer: Mapping[str, Any] | None = None
) -> Iterator[tuple[Mapping[str, Any], Mapping[str, Any]]]:
    """Mappings of joints at any depth, each with the mapping in which it stands."""
    if not isinstance(content, Mapping):
        return
    flat = {key: match for key in content if (match := FLAT.fullmatch(str(key))) and not match["factor"]}
    if flat:
        entries = dict[str, Any]()
        for key, match in flat.items():
            entries.setdefault(match["joint"], {})[match["key"]] = content[key]
        factors = {
            match["factor"]: content[key] for key in content if (match := FLAT.fullmatch(str(key))) and match["factor"]
        }
        yield factors, entries
    joints = content.get("joint_limits")
    if isinstance(joints, list) and all(isinstance(entry, Mapping) and "name" in entry for entry in joints):
        joints = {entry["name"]: entry for entry in joints}
    if isinstance(joints, Mapping) and joints and not any(_is_joint_table(inner) for inner in joints.values()):
        yield content, joints
        content = {key: value for key, value in content.items() if key != "joint_limits"}
    elif _is_joint_table(content):
        yield {} if outer is None else outer, content
        return
    for value in content.values():
        yield from _tables(value, content)


def _is_joint_table(content: Any) -> bool:
    return isinstance(content, Mapping) and bool(content) and all(map(_is_joint, content.values()))


def _is_joint(entry: Any) -> bool:
    if not isinstance(entry, Mapping):
        return False
    return isinstance(entry.get("limit"), Mapping) or any(
        key in KNOWN and not isinstance(entry[key], Mapping) for key in entry
    )


def _entry(entry: Any, where: str, notes: list[str]) -> OneJoint:
    if not isinstance(entry, Mapping):
        raise StudyError(f"{where}: expected fields such as 'max_velocity', got {str(entry)[:60]!r}")
    if isinstance(inner := entry.get("limit"), Mapping):
        entry = {key: value for key, value in entry.items() if key != "limit"} | dict(inner)
    notes += [_unused(str(key), where, KNOWN) for key in entry if key not in KNOWN]
    values = {key: number(entry[key], f"{where}: {key!r}") for key in PLAIN if entry.get(key) is not None}
    values |= dict(_said(entry, where))
    for name in values:
        low = name.startswith("min_")
        if name.removeprefix("min_") in RATES and not (values[name] < 0 if low else values[name] > 0):
            switch, key = SWITCHES[name] if SWITCHES[name][1] in entry else ("", name)
            hint = f"set {switch!r} to false for no limit" if switch else "leave it out for no limit"
            raise StudyError(
                f"{where}: {key!r} must be {'below' if low else 'above'} zero, got {values[name]:g}; {hint}"
            )
    return OneJoint(**_with_softer(values, where, notes))  # type: ignore[arg-type]


def _with_softer(values: dict[str, float], where: str, notes: list[str]) -> dict[str, float]:
    """Put deceleration and soft limits in the place of the limits that they tighten, and no range in that of an empty one."""
    slowing = values.pop("deceleration", None)
    if slowing is not None:
        limit = min(abs(slowing), values.get("acceleration", np.inf))
        if not limit:
            raise StudyError(f"{where}: 'max_deceleration' must not be zero; leave it out for no limit")
        notes.append(
            f"{where}: 'max_deceleration' {abs(slowing):g} is taken for both speeding up and slowing down"
            if limit < values.get("acceleration", np.inf)
            else f"{where}: 'max_deceleration' is not tighter than the acceleration and changes nothing"
        )
        values["acceleration"] = limit
    for end, choose in (("lower", max), ("upper", min)):
        soft = values.pop(f"soft_{end}", None)
        if soft is not None and choose(soft, values.get(end, soft)) == soft != values.get(end):
            notes.append(f"{where}: {end} end of its range is the soft one, {soft:g}")
            values[end] = soft
    low, high = values.get("lower", -np.inf), values.get("upper", np.inf)
    if low > high:
        raise StudyError(f"{where}: its range from {low:g} to {high:g} is empty; exchange its ends")
    if low == high:
        notes.append(f"{where}: a range from {low:g} to {high:g} is taken as not stated")
        del values["lower"], values["upper"]
    return values


def _unused(key: str, where: str, known: Collection[str]) -> str:
    near = get_close_matches(key, known, n=1, cutoff=0.8)
    return f"{where}: unknown key {key!r} is not used" + (f"; did you mean {near[0]!r}?" if near else "")


def _said(entry: Mapping[str, Any], where: str) -> Iterator[tuple[str, float]]:
    for name, (switch, key) in SWITCHES.items():
        on = entry.get(switch, key in entry)
        if not isinstance(on, bool):
            raise StudyError(f"{where}: {switch!r} must be true or false, got {str(on)[:60]!r}")
        if not on or (key not in entry and name.startswith(("min_", "soft_"))):
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


def _scaled(joints: dict[str, OneJoint], key: str, factor: float, where: str, notes: list[str]) -> dict[str, OneJoint]:
    if not 0 < factor <= 1:
        raise StudyError(f"{where}: {key!r} must be above 0 and at most 1, got {factor:g}")
    if factor == 1:
        return joints
    notes.append(f"{where}: limits of {SCALING[key][0]} are multiplied by {key!r}, {factor:g}")
    result = {}
    for name, joint in joints.items():
        rates = {rate: getattr(joint, rate) for rate in SCALING[key]}
        result[name] = replace(joint, **{rate: value * factor for rate, value in rates.items() if value is not None})
    return result


def _from_urdf(path: Path, mimics: dict[str, Mimic], notes: list[str]) -> dict[str, OneJoint]:
    urdf = read_urdf(path)
    notes += urdf.notes
    mimics |= {joint.name: joint.mimic for joint in urdf.moving if joint.mimic is not None}
    return {
        joint.name: OneJoint(
            velocity=joint.velocity,
            lower=joint.lower,
            upper=joint.upper,
            sliding=joint.kind == "prismatic",
            endless=joint.kind == "continuous",
        )
        for joint in urdf.moving
    }
