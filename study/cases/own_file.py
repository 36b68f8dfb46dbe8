"""Models of a user's case file; the JSON Schema for editors is made of them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, Tag

from study.cases.own_arm import FrictionOrName, PayloadOrMass, Place, ToolOrName, Torque
from study.cases.own_demands import (
    DurationOrNumber,
    PathOrName,
    StateOrCondition,
    Tolerance,
    forms,
)
from study.cases.paper_file import FORMAT, Positive, Unit, Version
from study.curves import CURVES
from study.datafiles import Strict

Cells = list[float]


Negative = Annotated[float, Field(lt=0)]


def _listed(single: str, several: str) -> Any:
    return forms(one=single, many=several)


class OwnDirections(Strict):
    """Limits that differ by direction: lower is negative, upper positive; null where there is none."""

    lower: Annotated[
        Annotated[Negative, Tag("one for all")] | Annotated[list[Negative | None], Tag("one for each")],
        _listed("one for all", "one for each"),
    ]
    upper: Annotated[
        Annotated[Positive, Tag("one for all")] | Annotated[list[Positive | None], Tag("one for each")],
        _listed("one for all", "one for each"),
    ]


PerJoint = Annotated[
    Annotated[Positive, Tag("one for all")]
    | Annotated[list[Positive | None], Tag("one for each")]
    | Annotated[OwnDirections, Tag("by direction")],
    forms(one="one for all", many="one for each", fields="by direction"),
]
"""One number for all joints, or one for each; null where a joint has no such limit; `lower` and `upper` by direction."""

Positions = Annotated[
    Annotated[float, Tag("one for all")] | Annotated[list[float | None], Tag("one for each")],
    _listed("one for all", "one for each"),
]
FileNames = Annotated[
    Annotated[str, Tag("file name")] | Annotated[list[str], Tag("list")], _listed("file name", "list")
]
UnitOrUnits = Annotated[
    Annotated[Unit, Tag("one for all")] | Annotated[list[Unit], Tag("one for each")],
    _listed("one for all", "one for each"),
]
Rows = Annotated[Annotated[str, Tag("file name")] | Annotated[list[Cells], Tag("rows")], _listed("file name", "rows")]


class OwnRange(Strict):
    """Lowest and highest position of the joints, in the case's units; null where there is none."""

    lower: Positions
    upper: Positions


class OwnRates(Strict):
    """Limits of the joints, in the case's units and seconds; what is left out does not limit."""

    velocity: PerJoint | None = Field(None, description="Per second.")
    acceleration: PerJoint | None = Field(None, description="Per second squared.")
    jerk: PerJoint | None = Field(None, description="Per second cubed.")
    position: OwnRange | None = None


class OwnSegments(OwnRates):
    """Further limits between two waypoints, counted from 1."""

    first: int = Field(alias="from", description="Waypoint at which the limits begin to hold.")
    last: int = Field(alias="to", description="Waypoint up to which they hold.")


class OwnLimits(OwnRates):
    """Limits of the joints, in the case's units and seconds; what is left out does not limit."""

    files: FileNames = Field(
        default_factory=list,
        alias="from",
        description="MoveIt joint_limits.yaml or URDF, one or several; later ones win, and numbers in this file win over all.",
    )
    torque: Torque | None = Field(
        None, description="N m, or N where a joint slides; or `effort`, what the robot's file states; needs masses."
    )
    tool_speed: Positive | None = Field(None, description="Of the tool, m/s whatever the units; needs a robot.")
    tool_acceleration: Positive | None = Field(None, description="Of the tool, m/s²; needs a robot.")


class Obstacle(Strict):
    """A box that the arm must not touch: two opposite corners in the robot's base frame, m."""

    lower: Annotated[Cells, Field(min_length=3, max_length=3)]
    upper: Annotated[Cells, Field(min_length=3, max_length=3)]


class OwnBounds(Strict):
    """The box of segment durations in which searches look, s."""

    lower: Positive
    upper: Positive


class OwnCase(Strict):
    """A problem of one's own: waypoints and limits, and what else is known of the robot."""

    version: Version = FORMAT
    name: str = Field("", description="Name in tables; the file's name by default.")
    title: str = Field("", description="One line for people.")
    units: UnitOrUnits | None = Field(
        None,
        description="Of all numbers in this file and in CSV files: rad, deg, m or mm; one for all joints or a list.",
    )
    joints: list[str] | None = Field(None, description="Names of the joints, in the order of the waypoints' columns.")
    waypoints: Rows = Field(
        description="Rows of joint positions, or the name of a CSV, YAML or JSON file or of a ROS 2 JointTrajectory."
    )
    limits: OwnLimits
    end: Literal["free", "rest", "smooth"] | None = Field(
        None,
        description="free: may start and end in motion; rest: zero velocity at both ends; smooth: zero acceleration too. "
        "By default smooth where a jerk is limited, else rest.",
    )
    start: StateOrCondition | None = Field(
        None,
        description="Of the first instant alone: free, rest, smooth, or `velocity` and `acceleration` of every joint.",
    )
    finish: StateOrCondition | None = Field(None, description="Of the last instant alone, in the same forms.")
    stops: list[int] = Field(default_factory=list, description="Inner waypoints, counted from 1, where the arm stops.")
    dwells: dict[int, Positive] = Field(
        default_factory=dict,
        description="Inner waypoints, counted from 1: seconds for which the arm stands still there.",
    )
    segments: list[OwnSegments] = Field(
        default_factory=list,
        description="Further limits between two waypoints: `from`, `to` and fields as in `limits`.",
    )
    tolerance: Tolerance | None = Field(
        None,
        description="Distance at which waypoints may be passed, in the case's units: one number, one for each waypoint, or one "
        "row for each waypoint with a number for each joint.",
    )
    path: PathOrName | None = Field(
        None,
        description="free, straight, `straight: R` with corners cut within R of a waypoint, or `tube: R`, at most R from the "
        "straight lines.",
    )
    duration: DurationOrNumber | None = Field(
        None, description="Of the motion, s: a number, or `exactly` and `at_least`; the motion is slowed down to it."
    )
    cycle: Positive | None = Field(None, description="Control cycle, s: the motion lasts a whole number of them.")
    speed: Annotated[float, Field(gt=0, le=1)] | None = Field(
        None, description="Share of the full speed: 0.5 takes twice as long, whatever limits."
    )
    unwrap: bool = Field(
        True, description="Whether joints that turn without end take the short way round from waypoint to waypoint."
    )
    robot: str | None = Field(
        None,
        description="For 3D, torques and the tool: a URDF file, a file with a DH table, or one of the study's arms.",
    )
    tool: ToolOrName | None = Field(
        None, description="Whose speed is limited: a link of the URDF, or `frame` and `at`; the last frame by default."
    )
    payload: PayloadOrMass | None = Field(
        None, description="Carried by the tool, kg; or `mass` and `at`, a place in m."
    )
    gravity: Place | None = Field(
        None, description="Free fall in the robot's base frame, m/s²; down along z by default."
    )
    friction: FrictionOrName | None = Field(
        None,
        description="`viscous` and `coulomb` of the joints, or `model` for what the robot's file states; none by default.",
    )
    obstacles: list[Obstacle] = Field(default_factory=list)
    arm_radius: Annotated[float, Field(ge=0)] = Field(0.05, description="Of the capsules that stand for the links, m.")
    self_collision: bool = Field(False, description="Whether the links must not touch each other; needs a robot.")
    duration_bounds: OwnBounds | None = None
    curve: Literal[tuple(CURVES)] | None = Field(  # type: ignore[valid-type]
        None, description="Curve family of the planners that choose segment durations."
    )
    notes: list[str] = Field(default_factory=list, description="Sentences that stand with the case in the report.")


def schema() -> dict[str, Any]:
    """JSON Schema of a case file of one's own."""
    content = OwnCase.model_json_schema(by_alias=True)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A time-optimal-study case",
        **{key: value for key, value in content.items() if key != "title"},
    }
