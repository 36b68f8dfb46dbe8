"""Models of the files in `data/cases`: every number with its source, ours marked as ours."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from study.datafiles import Strict
from study.problem import Floats

Unit = Literal["rad", "deg", "m", "mm"]
Positive = Annotated[float, Field(gt=0)]

SI: dict[str, tuple[str, float]] = {
    "rad": ("rad", 1.0),
    "deg": ("rad", np.pi / 180.0),
    "m": ("m", 1.0),
    "mm": ("m", 1e-3),
}
"""Unit in a file: unit in the program and the factor between them."""


class Sourced(Strict):
    """Anything that must say where it comes from: a place in the paper, or why it is ours."""

    source: str | None = None
    ours: str | None = None

    @model_validator(mode="after")
    def _one_origin(self) -> Self:
        if (self.source is None) == (self.ours is None):
            raise ValueError("give exactly one of 'source' (the place in the paper) and 'ours' (why we chose it)")
        return self


class Waypoints(Sourced):
    """One row for each waypoint, in the case's units."""

    values: list[list[float]]
    labels: list[str] | None = None


class Rates(Sourced):
    """One positive limit for each joint, in the case's units or its own."""

    values: list[Positive]
    units: list[Unit] | None = None


class Range(Sourced):
    """Lowest and highest position of each joint; judged only if the file says so."""

    lower: list[float]
    upper: list[float]
    units: list[Unit] | None = None
    judged: bool = False


class Torques(Sourced):
    """One limit for each joint, N m or N, or `effort` for those that the robot's file states, of the arm without friction."""

    values: list[Positive] | Literal["effort"]


class Limits(Strict):
    """Limits of the joints; what is left out does not limit."""

    velocity: Rates
    acceleration: Rates | None = None
    jerk: Rates | None = None
    position: Range | None = None
    torque: Torques | None = None


class Bounds(Sourced):
    """The box of segment durations, s."""

    lower: Positive
    upper: Positive


class Settings(Sourced):
    """Search settings of the paper."""

    population: Annotated[int, Field(ge=1)]
    iterations: Annotated[int, Field(ge=1)]
    formulation: Literal["penalty", "scaled"] = "penalty"
    synchronisation: Literal["per-joint", "shared"]


class Printed(Strict):
    """A result that the paper prints; joints are counted from 1 as in the papers."""

    label: str
    total: Positive | None = None
    durations: list[Positive] | None = None
    joint: Annotated[int, Field(ge=1)] | None = None
    source: str


def _readable(version: int) -> int:
    if version != FORMAT:
        raise ValueError(
            f"this program reads case files of version {FORMAT}; install the one that the file was written for"
        )
    return version


FORMAT = 1
Version = Annotated[int, AfterValidator(_readable), Field(description="Version of the form of case files.")]


class CaseFile(Strict):
    """One case as its file states it."""

    version: Version = FORMAT
    name: str
    title: str
    paper: str
    robot: str | None = None
    units: list[Unit]
    waypoints: Waypoints
    fixed_joints: dict[Annotated[int, Field(ge=1)], float] = Field(default_factory=dict)
    limits: Limits
    limits_label: str = "published"
    end: Literal["free", "rest", "smooth"]
    duration_bounds: Bounds
    curve: str
    planner: str
    settings: Settings
    published: list[Printed] = Field(default_factory=list)
    notes: list[str] = Field(default_factory=list)
    default: bool = True
    variant_of: str = ""
    variants: dict[str, Variant] = Field(default_factory=dict)


class Variant(Strict):
    """Changes of a variant to its case, with the reason; a limit set to null is removed."""

    reason: str
    title: str
    robot: str | None = None
    units: list[Unit] | None = None
    waypoints: dict[str, Any] | None = None
    limits: dict[str, Any] | None = None
    limits_label: str | None = None
    end: str | None = None
    duration_bounds: dict[str, Any] | None = None
    curve: str | None = None
    planner: str | None = None
    settings: dict[str, Any] | None = None
    published: list[Any] | None = None
    notes: list[str] = Field(default_factory=list)


def varied(base: CaseFile, name: str) -> dict[str, Any]:
    """Lay a variant over its case; the result must be checked as a case file again."""
    variant = base.variants[name]
    content = base.model_dump(exclude={"variants"}, exclude_none=True)
    changes = variant.model_dump(exclude={"reason", "notes"}, exclude_none=True)
    if variant.limits is not None:
        changes["limits"] = content["limits"] | variant.limits
    notes = [f"Variant of {base.name!r}: {variant.reason}", *variant.notes, *base.notes]
    return content | changes | {"name": name, "variant_of": base.name, "default": False, "notes": notes}


def in_si(values: list[float] | list[list[float]], units: list[Unit], what: str) -> Floats:
    """Convert one number per joint, or rows of them, to rad and m.

    Raises
    ------
    ValueError
        If a row does not have one number for each unit.
    """
    for row, line in enumerate(values if values and isinstance(values[0], list) else [values], start=1):
        if not isinstance(line, list) or len(line) != len(units):
            size = len(line) if isinstance(line, list) else "one number"
            raise ValueError(f"{what}: row {row} must have one number for each of {len(units)} joints, got {size}")
    return np.array(values, dtype=float) * np.array([SI[unit][1] for unit in units])
