"""Constraints besides limits in a user's file, and the parts of a problem made of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from study.cases.paper_file import Positive
from study.datafiles import Strict
from study.errors import StudyError
from study.problem import EndCondition, Floats, JointLimits, State, StraightPath, Timing, Tube

if TYPE_CHECKING:
    from study.cases.own_file import OwnCase

NotNegative = Annotated[float, Field(ge=0)]
Condition = Literal["free", "rest", "smooth"]


def forms(**names: str) -> Discriminator:
    """Tell the forms of a field apart by its kind, so that a mistake is reported against one form only.

    Parameters
    ----------
    names : str
        Tag of each form: `one` of a number or text, `many` of a list, `fields` of a mapping, `text` of text where it has
        a form of its own.
    """

    def tag(value: Any) -> str | None:
        kind = "many" if isinstance(value, list) else "one" if not isinstance(value, dict | Strict) else "fields"
        kind = "text" if isinstance(value, str) and "text" in names else kind
        return names.get(kind, names["one"])

    return Discriminator(tag)


class OwnState(Strict):
    """Rates at an end, one number for each joint, in the case's units; what is left out is free."""

    velocity: list[float] | None = None
    acceleration: list[float] | None = None


StateOrCondition = Annotated[
    Annotated[Condition, Tag("condition")] | Annotated[OwnState, Tag("rates")], forms(one="condition", fields="rates")
]

Radius = Annotated[
    Annotated[NotNegative, Tag("one for all")] | Annotated[list[NotNegative], Tag("one for each")],
    forms(one="one for all", many="one for each"),
]


class OwnPath(Strict):
    """Shape of the path, in the case's units: one of the two."""

    straight: Radius | None = Field(
        None, description="Straight lines; a corner may be cut where every joint is within this of the waypoint."
    )
    tube: Radius | None = Field(None, description="Every joint stays within this of the straight lines.")

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        if (self.straight is None) == (self.tube is None):
            raise ValueError("give exactly one of 'straight' and 'tube'")
        return self


PathOrName = Annotated[
    Annotated[Literal["free", "straight"], Tag("name")] | Annotated[OwnPath, Tag("shape")],
    forms(one="name", fields="shape"),
]


class OwnDuration(Strict):
    """The duration of the motion, s."""

    exactly: Positive | None = None
    at_least: Positive | None = None


DurationOrNumber = Annotated[
    Annotated[Positive, Tag("number")] | Annotated[OwnDuration, Tag("kinds")], forms(one="number", fields="kinds")
]

Tolerance = Annotated[
    Annotated[NotNegative, Tag("one for all")] | Annotated[list[NotNegative | list[NotNegative]], Tag("one for each")],
    forms(one="one for all", many="one for each"),
]


def demands_of(file: OwnCase, factors: Floats, n_waypoints: int, where: str) -> dict[str, Any]:
    """Parts of a problem that a file's demands come to.

    Parameters
    ----------
    file : OwnCase
    factors : array of shape (n_joints,)
        From the file's units to rad and m.
    n_waypoints : int
    where : str
        How a message begins.

    Returns
    -------
    dict of str to object
        Arguments of `Problem`; waypoints and segments counted from 0.
    """
    try:
        return {
            "start": _state(file.start, factors),
            "finish": _state(file.finish, factors),
            "stops": [number - 1 for number in file.stops],
            "dwells": {number - 1: time for number, time in file.dwells.items()},
            "tolerance": _tolerance(file.tolerance, factors, n_waypoints),
            "path": _path(file.path, factors),
            "timing": _timing(file),
        }
    except StudyError as error:
        raise StudyError(f"{where}: {error}") from None


def scaled_by(values: float | Sequence[float], factors: Floats, what: str) -> Floats:
    """Numbers in the file's units, one for all joints or one for each, in rad and m."""
    if np.ndim(values) and np.shape(values) != factors.shape:
        raise StudyError(f"{what} must have one number for each of {len(factors)} joints, got {len(values)}")  # type: ignore[arg-type]
    return np.asarray(values, dtype=float) * factors


def _state(given: OwnState | str | None, factors: Floats) -> State | EndCondition | None:
    if given is None or isinstance(given, str):
        return EndCondition[given.upper()] if given else None
    pairs = (("velocity", given.velocity), ("acceleration", given.acceleration))
    return State(*(None if rate is None else scaled_by(rate, factors, f"end {name}") for name, rate in pairs))


def _tolerance(given: Any, factors: Floats, n_waypoints: int) -> Floats | None:
    if given is None:
        return None
    rows = given if isinstance(given, list) else [given] * n_waypoints
    return np.array([scaled_by(row, factors, f"tolerance of waypoint {k}") for k, row in enumerate(rows, 1)])


def _path(given: OwnPath | str | None, factors: Floats) -> StraightPath | Tube | None:
    if given is None or given == "free":
        return None
    if isinstance(given, str):
        return StraightPath()
    if given.tube is not None:
        return Tube(scaled_by(given.tube, factors, "path.tube"))
    return StraightPath(scaled_by(given.straight or 0.0, factors, "path.straight"))


def _timing(file: OwnCase) -> Timing | None:
    given = file.duration
    if isinstance(given, OwnDuration):
        return Timing(given.exactly, given.at_least, file.cycle)
    return None if given is None and file.cycle is None else Timing(exactly=given, cycle=file.cycle)


def segments_between(first: int, last: int, n_waypoints: int, where: str) -> range:
    """Segments, counted from 0, between two waypoints counted from 1."""
    if not 1 <= first < last <= n_waypoints:
        raise StudyError(
            f"{where}: 'segments' must run from a waypoint to a later one of the {n_waypoints}, got {first} to {last}"
        )
    return range(first - 1, last - 1)


def tightest(first: JointLimits, second: JointLimits) -> JointLimits:
    """Limits that keep both."""
    velocity, acceleration, jerk = np.minimum(first.highest_rates, second.highest_rates)
    lowest = np.maximum(first.lowest_rates, second.lowest_rates)
    positions = np.maximum(first.lower, second.lower), np.minimum(first.upper, second.upper)
    return JointLimits(velocity, acceleration, jerk, *positions, *lowest)
