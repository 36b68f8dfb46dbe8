"""Quintic segments through the waypoints, as fast as IPOPT can make them: a freer curve than the papers', same limits.

The program starts from the optima of the narrower curves, and the fastest motion of all is kept, so no answer is slower
than the 3-5-3 or the cubic spline optimum where those are among the quintic motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from baselines.base import Deterministic, where_something_moves
from baselines.segment_times.exchange import Exchange, Optimum
from baselines.segment_times.nlp import optimise
from baselines.segment_times.polynomial_curves import limited_orders, trajectory_of
from baselines.segment_times.quintic_curve import FIRST_POINTS, Quintic
from baselines.units import dimensionless, largest_steps
from study.curves import CURVES
from study.deadline import Deadline
from study.judge import judge
from study.planning import Plan, RunSettings, Status
from study.problem import EndCondition, Problem
from study.trajectory import Motion, Trajectory


@dataclass(frozen=True)
class QuinticNlp(Deterministic):
    """Planner `quintic-nlp`.

    Velocity and acceleration are continuous and free at inner waypoints. At the ends they follow the problem's end
    condition: zero where it demands rest or a smooth end, else free within the limits. The settings' curve does not
    matter.
    """

    about: ClassVar[str] = (
        "quintic segments with free velocities and accelerations at the waypoints, optimised by IPOPT"
    )

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Optimise durations, and velocities and accelerations at the waypoints, of all joints together."""
        deadline, names = Deadline.after(settings.time_limit), _starting(problem)
        narrower = [_optimal(problem, name, settings) for name in names]
        scaled, units = dimensionless(problem, narrower[0].duration / problem.n_segments, largest_steps(problem))
        family = Quintic(problem.n_waypoints, problem.n_joints, limited_orders(problem))
        exchange = Exchange(family, scaled, deadline, settings.time_limit)
        for order, slots in exchange.slots.items():
            slots.preset(FIRST_POINTS[order])
        optima = [_run(exchange, family, units.into(motion)) for motion in narrower]
        own = [units.motion(family.motion(scaled, o.x)) for o in optima if np.isfinite(o.total)]
        allowed = [motion for motion, name in zip(narrower, names, strict=True) if _within(problem, name)]
        candidates = [feasible(problem, motion) for motion in own + allowed]
        return _plan(optima, candidates, len(own))


def _run(exchange: Exchange, family: Quintic, motion: Motion) -> Optimum:
    """Start from a motion, and where that fails again from the same motion driven more slowly."""
    for factor in (1.0, 1.3):
        optimum = exchange.run_from(family.lift_motion(motion.scaled(factor), exchange.problem))
        if optimum.converged:
            break
    return optimum


def _starting(problem: Problem) -> list[str]:
    """Narrower curves whose optima are starts."""
    smooth = problem.end is EndCondition.SMOOTH and problem.n_waypoints > 2
    return ["cubic-spline-smooth" if smooth else "cubic-spline", *(["poly353"] if problem.n_waypoints == 4 else [])]


def _within(problem: Problem, name: str) -> bool:
    """Whether the curve keeps the problem's end condition, and so is one of the quintic motions."""
    rank = [EndCondition.FREE, EndCondition.REST, EndCondition.SMOOTH]
    return rank.index(CURVES[name].end) >= rank.index(problem.end)


def _optimal(problem: Problem, name: str, settings: RunSettings) -> Trajectory:
    durations = optimise(problem, name, seed=settings.seed, time_limit=settings.time_limit / 4).durations
    return trajectory_of(name, problem, durations if np.isfinite(durations).all() else np.ones(problem.n_segments))


def feasible(problem: Problem, motion: Trajectory) -> Trajectory:
    """Slow a motion down until every rate keeps its limit, and every segment its shortest duration."""
    shortest = problem.duration_bounds[0] / np.diff(motion.waypoint_times).min()
    return motion.scaled(max(judge(problem, motion).stretch, shortest))


def _plan(optima: list[Optimum], candidates: list[Trajectory], own: int) -> Plan:
    """Take the fastest candidate; the first `own` of them are quintic motions."""
    iterations = sum(optimum.iterations for optimum in optima)
    reasons = "; ".join(dict.fromkeys(optimum.message for optimum in optima if optimum.message))
    if not candidates:
        return Plan(Status.FAILED, iterations=iterations, message=reasons or "no start led to a motion")
    best = min(range(len(candidates)), key=lambda k: candidates[k].duration)
    converged = any(optimum.converged for optimum in optima) and best < own
    return Plan(
        Status.FINISHED if converged else Status.NOT_CONVERGED,
        motion=candidates[best],
        durations=np.diff(candidates[best].waypoint_times),
        iterations=iterations,
        message="" if converged else reasons or "no faster than a narrower curve's optimum, which is returned",
        details={
            "exchange_rounds": float(sum(optimum.rounds for optimum in optima)),
            "constraint_points": float(max(optimum.points for optimum in optima)),
        },
    )
