"""Everything that a problem may ask of a motion, by name, so that a planner can say what it knows."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum


class Demand(StrEnum):
    """A demand on a motion; members read as a noun phrase in "the planner does not know ..."."""

    VELOCITY = "limits of velocity"
    ACCELERATION = "limits of acceleration"
    JERK = "limits of jerk"
    POSITION_RANGE = "a range of positions"
    DIRECTIONAL_LIMITS = "limits that differ by direction"
    SEGMENT_LIMITS = "limits of single segments"
    MOVING_ENDS = "a given velocity or acceleration at an end"
    DIFFERENT_ENDS = "different conditions at the two ends"
    STOPS = "stops at waypoints"
    DWELLS = "dwells at waypoints"
    TOLERANCE = "a tolerance at waypoints"
    STRAIGHT_PATH = "a straight path between waypoints"
    TUBE = "a tube around the straight path"
    TORQUE = "limits of torque"
    TOOL_SPEED = "a limit of the tool's speed"
    TOOL_ACCELERATION = "a limit of the tool's acceleration"
    DURATION = "a given duration"
    CYCLE = "whole control cycles"


ARM = frozenset({Demand.TORQUE, Demand.TOOL_SPEED, Demand.TOOL_ACCELERATION})
"""Demands on the whole arm: where a slower run is allowed, a planner need not know them, its motion is slowed down."""

PLAIN = frozenset({Demand.VELOCITY, Demand.ACCELERATION, Demand.JERK, Demand.POSITION_RANGE})
"""Demands that a planner may try without knowing them: its motion may keep them by chance, and the judge sees to it."""


def refusal(demands: Iterable[Demand], knows: frozenset[Demand]) -> str:
    """Sentence with which a planner declines a problem; empty where it knows every demand that it must know.

    Parameters
    ----------
    demands : iterable of Demand
        Of the problem.
    knows : frozenset of Demand
        Of the planner.
    """
    unknown = sorted(set(demands) - knows - PLAIN, key=list(Demand).index)
    if not unknown:
        return ""
    return f"the planner does not know {' or '.join(unknown)}, which the problem asks for"
