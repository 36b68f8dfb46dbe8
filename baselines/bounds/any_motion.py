"""Lower bound on any motion through the waypoints, tightened by the fastest motion that the planners know."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from baselines.base import where_something_moves
from baselines.bounds.lower_bounds import bound
from baselines.state_to_state.via import ruckig_via
from study.deadline import Deadline
from study.judge import judge
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Demand, Problem


@dataclass(frozen=True)
class AnyMotionBound:
    """Planner `any-motion-bound`: a time that no motion through the waypoints within the limits can undercut.

    A fast motion makes the bound tighter, so `ruckig-via`, which knows the free-path program too, is asked for one first; the
    bound is valid whatever motion that is. At the time limit it is the best bound proved until then.

    Parameters
    ----------
    n_cells : int
        Cells of velocity between the limits at first.
    refinements : int
        How often cells are dropped and halved.
    """

    n_cells: int = 64
    refinements: int = 3
    about: ClassVar[str] = "no planner but a proof: a time that no motion through the waypoints can undercut"
    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS
    stochastic: ClassVar[bool] = False

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Prove a bound; it stands in the details as `lower_bound`, s."""
        deadline = Deadline.after(settings.time_limit)
        motion = ruckig_via(problem, time_limit=settings.time_limit).motion
        known = motion.duration if judge(problem, motion).feasible else np.inf
        proof = bound(problem, known, self.n_cells, self.refinements, deadline=deadline)
        return Plan(
            Status.FINISHED,
            iterations=proof.rounds,
            message="a proved lower bound on any motion through the waypoints; there is no motion to drive",
            details={"lower_bound": proof.value, "known": known, "cells": float(proof.cells)},
        )
