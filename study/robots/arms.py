"""Arms with limits: what the maker publishes, what a publication gives, and what is ours, each marked."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from study.errors import StudyError, unknown
from study.problem import Floats, JointLimits
from study.robots import Robot, robot_file, robot_named, robot_names


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm, its limits, and a posture in the middle of its work.

    Attributes
    ----------
    robot : Robot
    rates : mapping of str to array of shape (n_joints,), rad or m, and s
        `velocity`, `acceleration` and `jerk`.
    range : array of shape (2, n_joints), rad or m
        Infinite where a joint turns without end.
    home : array of shape (n_joints,), rad or m
    origins : mapping of str to str
        Of `velocity`, `acceleration`, `jerk` and `position`: `maker: ` and the document, `literature: ` and the publication,
        or `ours: ` and why.
    """

    robot: Robot
    rates: dict[str, Floats]
    range: Floats
    home: Floats
    origins: dict[str, str]

    def limits(self, jerk: bool) -> JointLimits:
        """Limits of rates, those of jerk if so wanted, and the range of positions."""
        velocity, acceleration, jerks = (self.rates[name] for name in ("velocity", "acceleration", "jerk"))
        return JointLimits(velocity, acceleration, jerks if jerk else np.array(np.inf), *self.range)


def arm_names() -> list[str]:
    """Names of the robots whose files give limits."""
    return [name for name in robot_names() if robot_file(name).limits is not None]


@cache
def arm_named(name: str) -> Arm:
    """Arm of a name.

    Raises
    ------
    StudyError
        If there is none, or its file gives no limits.
    """
    if name not in robot_names():
        raise unknown("arm", name, arm_names())
    file, robot = robot_file(name), robot_named(name)
    if file.limits is None or file.home is None:
        raise StudyError(f"the file of robot {name!r} gives no limits; add 'limits' and 'home'")
    unit = np.where(robot.prismatic, file.metre, np.pi / 180.0)
    given = {"velocity": file.limits.velocity, "acceleration": file.limits.acceleration, "jerk": file.limits.jerk}
    position = file.limits.position
    span = robot.range if position is None else np.array([position.lower, position.upper]) * unit
    return Arm(
        robot,
        {kind: np.array(rate.values) * (1.0 if rate.unit else unit) for kind, rate in given.items()},
        span,
        np.array(file.home),
        {kind: rate.origin for kind, rate in given.items()}
        | {"position": position.origin if position else f"maker: {robot.source}"},
    )
