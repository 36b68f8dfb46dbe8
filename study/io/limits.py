"""Joint limits from the files that robots already have: MoveIt's `joint_limits.yaml` and URDF.

References
----------
MoveIt 2, joint_limits.yaml as read by `moveit_robot_model_loader`: has_... switches and max_... values for each joint.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError
from study.io.table import parsed
from study.io.urdf import read_urdf

SWITCHES = {
    "velocity": ("has_velocity_limits", "max_velocity"),
    "acceleration": ("has_acceleration_limits", "max_acceleration"),
    "jerk": ("has_jerk_limits", "max_jerk"),
    "lower": ("has_position_limits", "min_position"),
    "upper": ("has_position_limits", "max_position"),
}


@dataclass(frozen=True)
class OneJoint:
    """Limits of one joint, rad or m and s; None where the file says nothing.

    Attributes
    ----------
    velocity, acceleration, jerk, lower, upper : float, optional
    sliding : bool, optional
        Whether the joint slides, where the file knows.
    """

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    lower: float | None = None
    upper: float | None = None
    sliding: bool | None = None

    def over(self, other: OneJoint) -> OneJoint:
        """Lay these limits over another file's: what is said here wins."""
        said = {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) is not None}
        return replace(other, **said)


def read_limits(path: Path) -> dict[str, OneJoint]:
    """Read limits of joints by name.

    Parameters
    ----------
    path : Path
        `.urdf` or `.xml`: a robot description; else MoveIt's `joint_limits.yaml`, or the same as JSON.

    Raises
    ------
    StudyError
        If the file cannot be read, holds no limits, or a limit is not a number.
    """
    if path.suffix.lower() in (".urdf", ".xml", ".xacro"):
        return {joint.name: _of_urdf(joint) for joint in read_urdf(path).moving}
    where = f"file {path.name!r}"
    content = parsed(path)
    joints = content.get("joint_limits") if isinstance(content, Mapping) else None
    if not isinstance(joints, Mapping) or not joints:
        raise StudyError(f"{where} holds no limits: expected MoveIt's 'joint_limits' with one entry for each joint")
    return {str(name): _of_moveit(entry, f"{where}, joint {name!r}") for name, entry in joints.items()}


def _of_urdf(joint: Any) -> OneJoint:
    return OneJoint(velocity=joint.velocity, lower=joint.lower, upper=joint.upper, sliding=joint.kind == "prismatic")


def _of_moveit(entry: Any, where: str) -> OneJoint:
    if not isinstance(entry, Mapping):
        raise StudyError(f"{where}: expected fields such as 'max_velocity', got {str(entry)[:60]!r}")
    return OneJoint(**dict(_said(entry, where)))  # type: ignore[arg-type]


def _said(entry: Mapping[str, Any], where: str) -> Iterator[tuple[str, float]]:
    for name, (switch, key) in SWITCHES.items():
        if not entry.get(switch, key in entry):
            continue
        try:
            value = float(entry[key])
        except KeyError:
            raise StudyError(f"{where}: {switch!r} is true, but {key!r} is missing; add it") from None
        except (TypeError, ValueError):
            raise StudyError(f"{where}: {key!r} must be a number, got {str(entry[key])[:60]!r}") from None
        if not np.isfinite(value):
            raise StudyError(f"{where}: {key!r} must be finite, got {value:g}; set {switch!r} to false for no limit")
        yield name, value
