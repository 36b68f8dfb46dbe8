"""Limits of the whole arm in a user's file: torques, and the tool's speed and acceleration, with the arm they are about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field, Tag

from study.arm import ArmLimits
from study.cases.own_demands import NotNegative, forms
from study.cases.paper_file import Positive
from study.datafiles import Strict
from study.errors import StudyError, listed, plural
from study.mechanism import Mechanism
from study.problem import Floats
from study.robots import robot_names
from study.robots.masses import HeavyArm, heavy_arm

if TYPE_CHECKING:
    from study.cases.own_file import OwnCase

Place = Annotated[list[float], Field(min_length=3, max_length=3)]

Torque = Annotated[
    Annotated[Literal["effort"], Tag("name")]
    | Annotated[Positive, Tag("one for all")]
    | Annotated[list[Positive | None], Tag("one for each")],
    forms(text="name", one="one for all", many="one for each"),
]

PerJointOrAll = Annotated[
    Annotated[NotNegative, Tag("one for all")] | Annotated[list[NotNegative], Tag("one for each")],
    forms(one="one for all", many="one for each"),
]


class OwnTool(Strict):
    """Point whose speed is limited: `at` in the frame of a link, by default the last one's."""

    frame: str = Field(default="", description="Link of the URDF.")
    at: Place = Field(default=[0.0, 0.0, 0.0], description="In that frame, m.")


ToolOrName = Annotated[
    Annotated[str, Tag("name")] | Annotated[OwnTool, Tag("shape")], forms(one="name", text="name", fields="shape")
]


class OwnPayload(Strict):
    """A point mass that the arm carries."""

    mass: NotNegative = Field(description="kg.")
    at: Place = Field(default=[0.0, 0.0, 0.0], description="In the tool's frame, m.")


PayloadOrMass = Annotated[
    Annotated[NotNegative, Tag("number")] | Annotated[OwnPayload, Tag("kinds")], forms(one="number", fields="kinds")
]


class OwnFriction(Strict):
    """Friction of the joints: by speed, and whatever the speed."""

    viscous: PerJointOrAll = Field(default=0.0, description="N m s/rad, or N s/m.")
    coulomb: PerJointOrAll = Field(default=0.0, description="N m or N.")


FrictionOrName = Annotated[
    Annotated[Literal["model"], Tag("name")] | Annotated[OwnFriction, Tag("kinds")],
    forms(one="name", text="name", fields="kinds"),
]


def arm_of(file: OwnCase, robot: str | None, joints: Sequence[str], where: str) -> ArmLimits | None:
    """Limits of the arm that a file states; None where it states none.

    Parameters
    ----------
    file : OwnCase
    robot : str, optional
        Name of an arm, or the path of its file.
    joints : sequence of str
    where : str
        How a message begins.

    Raises
    ------
    StudyError
        If there is no arm, it has no masses and torques are limited, or a field does nothing.
    """
    limits = file.limits
    rates = [name for name in ("torque", "tool_speed", "tool_acceleration") if getattr(limits, name) is not None]
    heavy = [name for name in ("payload", "gravity", "friction") if getattr(file, name) is not None]
    if heavy and limits.torque is None:
        raise StudyError(
            f"{where}: {listed(heavy)} change nothing without limits of torque; add 'torque' under 'limits'"
        )
    if file.tool is not None and not rates:
        raise StudyError(f"{where}: 'tool' changes nothing without 'tool_speed' or 'tool_acceleration' under 'limits'")
    if not rates:
        return None
    if robot is None:
        raise StudyError(f"{where}: {listed(rates)} under 'limits' need an arm; name one under 'robot'")
    try:
        tool = OwnTool(frame=file.tool) if isinstance(file.tool, str) else file.tool or OwnTool()
        arm = heavy_arm(robot, joints, tool.frame)
        return ArmLimits(
            _mechanism(file, arm, tool, limits.torque is not None),
            _torque(limits.torque, arm),
            np.inf if limits.tool_speed is None else limits.tool_speed,
            np.inf if limits.tool_acceleration is None else limits.tool_acceleration,
        )
    except StudyError as error:
        raise StudyError(f"{where}: {error}") from None


def _mechanism(file: OwnCase, arm: HeavyArm, tool: OwnTool, heavy: bool) -> Mechanism:
    mechanism, n = arm.mechanism, arm.mechanism.n_joints
    shift = np.eye(4)
    shift[:3, 3] = tool.at
    mechanism = replace(mechanism, tool=mechanism.tool @ shift)
    if heavy and not mechanism.heavy:
        known = [name for name in robot_names() if heavy_arm(name).mechanism.heavy]
        raise StudyError(
            "torque limits need masses, and the arm's file states none; a URDF with inertias has them, and of the study's "
            f"arms {listed(known)}"
        )
    if file.gravity is not None:
        mechanism = replace(mechanism, gravity=np.array(file.gravity))
    if file.friction != "model":
        own = file.friction or OwnFriction()
        mechanism = replace(
            mechanism, viscous=_each(own.viscous, n, "viscous"), coulomb=_each(own.coulomb, n, "coulomb")
        )
    if file.payload is None:
        return mechanism
    payload = file.payload if isinstance(file.payload, OwnPayload) else OwnPayload(mass=file.payload)
    return mechanism.carrying(payload.mass, payload.at)


def _each(values: float | Sequence[float], n_joints: int, name: str) -> Floats:
    if np.ndim(values) and np.size(values) != n_joints:
        raise StudyError(f"friction.{name} has {plural(np.size(values), 'number')} for {plural(n_joints, 'joint')}")
    return np.broadcast_to(np.asarray(values, dtype=float), (n_joints,))


def _torque(given: str | float | Sequence[float | None] | None, arm: HeavyArm) -> Floats:
    n = arm.mechanism.n_joints
    if given == "effort":
        if np.isinf(arm.effort).all():
            raise StudyError("'torque: effort' takes the torques that the arm's file states, and it states none")
        return arm.effort
    values = given if isinstance(given, list) else [given] * n
    if len(values) != n:
        raise StudyError(
            f"limits.torque has {plural(len(values), 'number')} for {plural(n, 'joint')}; give one for all or one for each"
        )
    return np.array([np.inf if value is None else float(value) for value in values])  # type: ignore[arg-type]
