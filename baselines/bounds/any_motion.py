"""Lower bound on any motion through the waypoints, tightened by the fastest motion that the planners know."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from baselines.base import NOTHING_MOVES, held_still
from baselines.bounds.lower_bounds import bound
from baselines.state_to_state.via import ruckig_via
from study.bounds import LowerBound
from study.deadline import Deadline
from study.judge import judge
from study.planning import RATE_LIMITS, Freedom, RunSettings
from study.problem import Demand, Problem


@dataclass(frozen=True)
class AnyMotionBound:
    """Bound `any-motion-bound`: a time that no motion through the waypoints within the limits can undercut.

    A fast motion makes the bound tighter, so `ruckig-via`, which knows the free-path program too, is asked for one
    when a first bound is proved; the bound is valid whatever motion that is. At the time limit it is the best bound
    proved until then.

    Parameters
    ----------
    n_cells : int
        Cells of velocity between the limits at first.
    refinements : int
        How often cells are dropped and halved.
    """

    n_cells: int = 16
    refinements: int = 6
    about: ClassVar[str] = (
        "a proved time that no motion through the waypoints can undercut; there is no motion to drive"
    )
    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS

    def bound(self, problem: Problem, settings: RunSettings) -> LowerBound:
        """Prove a bound within the settings' time limit."""
        if not problem.moving.any():
            return LowerBound(0.0, Freedom.FREE, NOTHING_MOVES)
        deadline, quiet = Deadline.after(settings.time_limit), held_still(problem)

        def seek() -> float:
            motion = ruckig_via(quiet, time_limit=deadline.left() / 2).motion
            return motion.duration if judge(quiet, motion).feasible else np.inf

        proof = bound(quiet, np.inf, self.n_cells, self.refinements, deadline=deadline, seek=seek)
        return LowerBound(
            proof.value,
            Freedom.FREE,
            "a proved lower bound on any motion through the waypoints; there is no motion to drive",
            {"known": proof.known, "cells": float(proof.cells), "rounds": float(proof.rounds)},
        )
