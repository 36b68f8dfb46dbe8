"""Numbers of a case that look as if they stood in another unit than the case says."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from study.cases.case import Case
from study.cases.paper_file import SI
from study.errors import listed
from study.problem import Floats

LARGE = {"rad": (6 * np.pi, 50.0, "deg"), "m": (50.0, 50.0, "mm")}
"""Waypoints and velocity limits, in the unit and in the unit per second, beyond which another unit is likelier."""

SMALL = {"deg": (2 * np.pi, "rad"), "mm": (5.0, "m")}
"""Velocity limits below which another unit is likelier."""


def odd_magnitudes(case: Case) -> Iterator[str]:
    """Ask of numbers that are odd in the unit that the case states whether another one is meant, one sentence each."""
    units = np.array(case.typed or case.units)
    factors = np.array([SI[unit][1] for unit in units])
    places = np.abs(case.problem.waypoints).max(axis=0) / factors
    speeds = case.problem.limits.rates[0] / factors
    bounded = np.isfinite(speeds)
    for unit, (far, fast, other) in LARGE.items():
        yield from _asked(case, "waypoints", places, (units == unit) & (places > far), unit, other)
        odd = (units == unit) & bounded & (speeds > fast)
        yield from _asked(case, "velocity limits", speeds, odd, f"{unit}/s", f"{other}/s")
    for unit, (slow, other) in SMALL.items():
        odd = (units == unit) & bounded & (speeds < slow) & case.problem.moving
        yield from _asked(case, "velocity limits", speeds, odd, f"{unit}/s", f"{other}/s")


def _asked(case: Case, what: str, values: Floats, odd: NDArray[np.bool_], unit: str, other: str) -> Iterator[str]:
    if odd.any():
        names = [name for name, there in zip(case.problem.joint_names, odd, strict=True) if there]
        yield f"{what} of {listed(names)} reach {values[odd].max():.4g} {unit}; are they meant in {other}?"
