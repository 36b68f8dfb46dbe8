"""Ruckig's community edition as its users chain it: one time-optimal move from stop to stop after the other.

Its way of passing several points in one call asks a remote service and is not used.
"""

from __future__ import annotations

import importlib
from typing import Any, ClassVar

import numpy as np

from baselines.peers.base import Peer, needs, through_phases
from study.planning import RATE_LIMITS
from study.problem import Demand, Floats, Problem
from study.trajectory import Trajectory

needs("ruckig")


class RuckigChain(Peer):
    """Planner `ruckig-chain`: the motion of `ruckig-stops`, straight from the package."""

    about = "the package ruckig from stop to stop, move by move"
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS

    def solve(self, problem: Problem, time_limit: float) -> list[Any]:
        """Chain the moves."""
        ruckig: Any = importlib.import_module("ruckig")
        given, solver = ruckig.InputParameter(problem.n_joints), ruckig.Ruckig(problem.n_joints)
        given.max_velocity, given.max_acceleration, given.max_jerk = (rate.tolist() for rate in problem.limits.rates)
        moves = []
        for start, end in zip(problem.waypoints[:-1].tolist(), problem.waypoints[1:].tolist(), strict=True):
            move = ruckig.Trajectory(problem.n_joints)
            given.current_position, given.target_position = start, end
            solver.calculate(given, move)
            moves.append(move)
        return moves

    def motion(self, problem: Problem, answer: list[Any]) -> Trajectory:
        """Take the phases of all joints, exactly."""
        steps = not np.isfinite(problem.limits.jerk).all()
        parts = [_pieces(move, steps) for move in answer]
        widths, cubics = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        return Trajectory.from_pieces(widths, cubics, np.array([len(width) for width, _ in parts]))


def _pieces(move: Any, steps: bool) -> tuple[Floats, Floats]:
    starts = [np.append(0.0, np.cumsum(profile.t)) for profile in move.profiles[0]]
    knots = np.unique(np.concatenate([*starts, [0.0, move.duration]]))
    knots = knots[np.append(True, np.diff(knots) > 1e-9)]
    knots[-1] = move.duration
    middles = (knots[:-1] + knots[1:]) / 2
    states, halfway = (np.array([move.at_time(t)[:3] for t in times]) for times in (knots[:-1], middles))
    return through_phases(knots, states, halfway, steps)
