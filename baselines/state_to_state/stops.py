"""Ruckig from rest to rest between neighbouring waypoints: what a controller does without any planning.

References
----------
L. Berscheid, T. Kroeger, Jerk-limited real-time trajectory generation with arbitrary target states, RSS 2021.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from baselines.state_to_state.moves import at_rest, chain, in_own_time
from study.errors import StudyError
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
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
    problem, unit = in_own_time(problem)
    return chain(problem, [at_rest(row) for row in problem.waypoints]).scaled(unit)


@dataclass(frozen=True)
class RuckigStops:
    """Planner `ruckig-stops`: rest to rest between neighbouring waypoints."""

    about: ClassVar[str] = "Ruckig from waypoint to waypoint, with a stop at each"
    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS | {
        Demand.POSITION_RANGE
    }  # a stop never leaves the waypoints' range
    stochastic: ClassVar[bool] = False

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Move and stop, waypoint by waypoint; the settings do not matter."""
        if not np.ptp(problem.waypoints, axis=0).any():
            return Plan(Status.NOT_APPLICABLE, message="all waypoints are equal, so there is nothing to move")
        try:
            return Plan(Status.FINISHED, motion=ruckig_stops(problem))
        except StudyError as error:
            return Plan(Status.FAILED, message=str(error))
