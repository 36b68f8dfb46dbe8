"""Minimum-time moves from rest to rest between neighbouring waypoints, as a controller drives them without planning.

References
----------
L. Berscheid, T. Kroeger, Jerk-limited real-time trajectory generation with arbitrary target states, RSS 2021.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from baselines.base import Deterministic, where_something_moves
from baselines.state_to_state.moves import in_own_time, stop_everywhere
from study.planning import RATE_LIMITS, Plan, RunSettings, Status
from study.problem import Demand, Problem
from study.trajectory import Trajectory


def ruckig_stops(problem: Problem) -> Trajectory:
    """Stop at every waypoint, all joints synchronised, each move in minimum time.

    Where a joint has no jerk limit its acceleration may step; where it has no acceleration limit either, its velocity
    may step, also at both ends, and the move takes the distance over the velocity limit.

    Raises
    ------
    StudyError
        If no joint moves, or a joint that moves has no limit at all.
    """
    scaled, units = in_own_time(problem)
    return units.motion(stop_everywhere(scaled))


@dataclass(frozen=True)
class RuckigStops(Deterministic):
    """Planner `ruckig-stops`: rest to rest between neighbouring waypoints."""

    about: ClassVar[str] = "Ruckig from waypoint to waypoint, with a stop at each"
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS | {
        Demand.POSITION_RANGE
    }  # a stop never leaves the waypoints' range

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Move and stop, waypoint by waypoint; the settings do not matter."""
        return Plan(Status.FINISHED, motion=ruckig_stops(problem))
