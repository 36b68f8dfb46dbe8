"""The lower half of the sandwich as a planner: it shows no motion, it proves how short any motion can be at best."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from baselines.bounds.lower_bounds import bound
from baselines.free_path.nlp import free_path
from baselines.state_to_state.via import ruckig_via
from study.deadline import noted
from study.judge import judge
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Demand, Problem
from study.trajectory import Motion


@dataclass(frozen=True)
class AnyMotionBound:
    """Planner `any-motion-bound`: a time that no motion through the waypoints within the limits can undercut.

    A fast motion makes the bound tighter, so Ruckig through the waypoints and the free-path NLP are asked for one first; the
    bound is valid whatever they find. At the time limit it is the best bound proved until then.

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

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Prove a bound; it stands in the details as `lower_bound`, s.

        Raises
        ------
        StudyError
            If Ruckig finds no move from stop to stop.
        """
        if not np.ptp(problem.waypoints, axis=0).any():
            return Plan(Status.NOT_APPLICABLE, message="all waypoints are equal, so there is nothing to move")
        deadline = time.monotonic() + settings.time_limit
        motions: list[Motion] = [ruckig_via(problem, time_limit=settings.time_limit)[0]]
        if not noted((left := deadline - time.monotonic()) <= 0):
            left = max(left, 0.1 * settings.time_limit)
            motions.append(free_path(problem, time_limit=left, deadline=deadline).motion)
        known = min((motion.duration for motion in motions if judge(problem, motion).feasible), default=np.inf)
        found = bound(problem, known, self.n_cells, self.refinements, deadline=deadline)
        return Plan(
            Status.FINISHED,
            iterations=found.rounds,
            message="a proved lower bound on any motion through the waypoints; there is no motion to drive",
            details={"lower_bound": found.value, "known": known, "cells": float(found.cells)},
        )
