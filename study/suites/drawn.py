"""A problem as a generator draws it, before it is rounded and filed."""

from __future__ import annotations

from dataclasses import dataclass

from study.problem import Floats, JointLimits


@dataclass(frozen=True, eq=False)
class Drawn:
    """One problem and what is said of it.

    Attributes
    ----------
    name, source, task : str
    tags : tuple of str
    robot : str, optional
    units : tuple of str
        `rad` or `m` for each joint.
    limits : JointLimits
    origins : dict of str to str
        Of each kind of limit, who says so.
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    """

    name: str
    source: str
    task: str
    tags: tuple[str, ...]
    robot: str | None
    units: tuple[str, ...]
    limits: JointLimits
    origins: dict[str, str]
    waypoints: Floats
