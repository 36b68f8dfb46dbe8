"""Models of the files in `data/robots`: the chain of an arm, and its limits with who says so."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from study.datafiles import Strict

ORIGINS = ("maker", "literature", "ours")
"""Sources of a number: the arm's maker, a publication about the arm, or this study where neither says it."""


class Joint(Strict):
    """One row of Denavit-Hartenberg parameters, angles in degrees and lengths in the file's unit."""

    kind: Literal["revolute", "prismatic"]
    a: float
    alpha: float
    d: float
    theta: float
    range: tuple[float, float] | None = None


class Origin(Strict):
    """Exactly one source of a number, with the document or the reason."""

    maker: str | None = None
    literature: str | None = None
    ours: str | None = None

    @model_validator(mode="after")
    def _one_origin(self) -> Self:
        if sum(getattr(self, name) is not None for name in ORIGINS) != 1:
            raise ValueError("give exactly one of 'maker', 'literature' and 'ours'")
        return self

    @property
    def origin(self) -> str:
        """Source of the numbers, with the document or the reason."""
        return next(f"{name}: {getattr(self, name)}" for name in ORIGINS if getattr(self, name) is not None)


class Rates(Origin):
    """A limit of every joint; in degrees or the file's unit of length and seconds, or in rad and m."""

    values: list[Annotated[float, Field(gt=0)]]
    unit: Literal["rad"] | None = None


class Positions(Origin):
    """Range of every joint, where it is not that of the chain, in degrees or the file's unit of length."""

    lower: list[float]
    upper: list[float]


class Limits(Strict):
    """Limits of an arm."""

    velocity: Rates
    acceleration: Rates
    jerk: Rates
    position: Positions | None = None


class Link(Strict):
    """One body, SI units, in the frame of its link; the rotor, friction and torque are as felt at the joint."""

    mass: Annotated[float, Field(ge=0)] = 0.0
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: Annotated[list[float], Field(min_length=3, max_length=6)] = Field(
        default=[0.0, 0.0, 0.0], description="About the centre: xx, yy, zz, and xy, xz, yz where they are not zero."
    )
    rotor: Annotated[float, Field(ge=0)] = 0.0
    viscous: Annotated[float, Field(ge=0)] = 0.0
    coulomb: Annotated[float, Field(ge=0)] = 0.0
    torque: Annotated[float, Field(gt=0)] | None = None

    @property
    def tensor(self) -> list[list[float]]:
        """Inertia about the centre, 3 x 3."""
        xx, yy, zz, xy, xz, yz = [*self.inertia, 0.0, 0.0, 0.0][:6]
        return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]


class Dynamics(Strict):
    """Masses of an arm, one body for each joint, and where they come from."""

    source: str
    links: list[Link]


class RobotFile(Strict):
    """An arm; with `limits` and `home` it takes part in the suite of robots."""

    title: str
    source: str
    convention: Literal["standard", "modified"]
    solver: Literal["ur", "puma", "woodworking"] | None = None
    length_unit: Literal["m", "mm"]
    joints: list[Joint] = Field(min_length=1)
    limits: Limits | None = None
    home: list[float] | None = None
    dynamics: Dynamics | None = None

    @model_validator(mode="after")
    def _as_many_as_joints(self) -> Self:
        rows = {} if self.limits is None else {name: rate.values for name, rate in self.limits if name != "position"}
        if self.limits is not None and self.limits.position is not None:
            rows |= {"lower": self.limits.position.lower, "upper": self.limits.position.upper}
        if (self.limits is None) != (self.home is None):
            raise ValueError("give both 'limits' and 'home', or neither")
        rows |= {} if self.home is None else {"home": self.home}
        rows |= {} if self.dynamics is None else {"dynamics.links": [link.mass for link in self.dynamics.links]}
        for name, row in rows.items():
            if len(row) != len(self.joints):
                raise ValueError(f"{name!r} must have one number for each of {len(self.joints)} joints, got {len(row)}")
        return self

    @property
    def metre(self) -> float:
        """Length of the file's unit, m."""
        return {"m": 1.0, "mm": 1e-3}[self.length_unit]
