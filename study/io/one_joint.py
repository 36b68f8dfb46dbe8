"""Limits of one joint as its robot's files state them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

RATES = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True)
class OneJoint:
    """Limits of one joint, rad or m and s; None where the file says nothing.

    Attributes
    ----------
    velocity, acceleration, jerk, lower, upper : float, optional
    min_velocity, min_acceleration, min_jerk : float, optional
        Lowest rates, negative, where they are not the highest ones mirrored.
    sliding : bool, optional
        Whether the joint slides, where the file knows.
    endless : bool, optional
        Whether the joint turns without end, where the file knows.
    """

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    lower: float | None = None
    upper: float | None = None
    min_velocity: float | None = None
    min_acceleration: float | None = None
    min_jerk: float | None = None
    sliding: bool | None = None
    endless: bool | None = None

    def over(self, other: OneJoint) -> OneJoint:
        """Lay these limits over another file's: what is said here wins."""
        said = {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) is not None}
        for name in ("velocity", "acceleration", "jerk"):  # a rate said anew is said in both directions
            if name in said:
                said.setdefault(f"min_{name}", None)
        return replace(other, **said)


def tightened(master: OneJoint, follower: OneJoint, multiplier: float, offset: float) -> OneJoint:
    """Limits of a joint that another one follows: position = multiplier * master + offset."""
    if not multiplier:
        return master
    said: dict[str, float | None] = {}
    for name in (*RATES, "position"):
        shift = offset if name == "position" else 0.0
        ends = sorted((end - shift) / multiplier for end in _span(follower, name))
        low, high = max(ends[0], _span(master, name)[0]), min(ends[1], _span(master, name)[1])
        lowest, highest = ("lower", "upper") if name == "position" else (f"min_{name}", name)
        said[highest] = high if np.isfinite(high) else None
        said[lowest] = low if np.isfinite(low) and (name == "position" or low != -high) else None
    return replace(master, **said)  # type: ignore[arg-type]


def _span(joint: OneJoint, name: str) -> tuple[float, float]:
    """Lowest and highest value of a rate or of the position."""
    lowest, highest = ("lower", "upper") if name == "position" else (f"min_{name}", name)
    low, high = getattr(joint, lowest), getattr(joint, highest)
    if low is None and name != "position" and high is not None:
        low = -high
    return -np.inf if low is None else low, np.inf if high is None else high
