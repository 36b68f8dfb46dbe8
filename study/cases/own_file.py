"""What a file about one's own robot may say; the JSON Schema for editors is made of these models."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from study.cases.paper_file import Positive, Unit
from study.curves import CURVES
from study.datafiles import Strict

Cells = list[float]


def _listed(one: str, several: str) -> Discriminator:
    """Tell the forms of a field apart by whether a list came, so that a mistake is reported against one form only."""
    return Discriminator(lambda value: several if isinstance(value, list) else one)


PerJoint = Annotated[
    Annotated[Positive, Tag("one for all")] | Annotated[list[Positive | None], Tag("one for each")],
    _listed("one for all", "one for each"),
]
"""One number for all joints, or one for each; null where a joint has no such limit."""

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


class OwnLimits(Strict):
    """Limits of the joints, in the case's units and seconds; what is left out does not limit."""

    files: FileNames = Field(
        default_factory=list,
        alias="from",
        description="MoveIt joint_limits.yaml or URDF, one or several; later ones win, and numbers in this file win over all.",
    )
    velocity: PerJoint | None = Field(None, description="Per second.")
    acceleration: PerJoint | None = Field(None, description="Per second squared.")
    jerk: PerJoint | None = Field(None, description="Per second cubed.")
    position: OwnRange | None = None


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
    robot: str | None = Field(
        None, description="For 3D: a URDF file, a file with a DH table, or one of the study's arms."
    )
    obstacles: list[Obstacle] = Field(default_factory=list)
    arm_radius: Annotated[float, Field(ge=0)] = Field(0.05, description="Of the capsules that stand for the links, m.")
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
