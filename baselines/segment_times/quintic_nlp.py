"""Quintic segments through the waypoints, as fast as IPOPT can make them: a freer curve than the papers', with the same limits.

It starts from the optima of the narrower curves and keeps the fastest of all of them, so it is never slower than the 3-5-3 or
the cubic spline optimum where those are among its motions.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from baselines.segment_times.exchange import Exchange, Optimum
from baselines.segment_times.model import Scales
from baselines.segment_times.nlp import optimise
from baselines.segment_times.polynomial_curves import limited_orders
from baselines.segment_times.quintic_curve import FIRST_POINTS, Quintic
from study.curves import CURVES, curve_named
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Demand, EndCondition, Problem
from study.trajectory import Motion


@dataclass(frozen=True)
class QuinticNlp:
    """The planner `quintic-nlp`.

    Velocity and acceleration are continuous and free at inner waypoints. At the ends they follow the problem's end condition:
    zero where it demands rest or a smooth end, else free within the limits. The settings' curve does not matter.
    """

    about: ClassVar[str] = (
        "quintic segments with free velocities and accelerations at the waypoints, optimised by IPOPT"
    )
    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS
    stochastic: ClassVar[bool] = False

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Optimise durations, and velocities and accelerations at the waypoints, of all joints together."""
        began = time.perf_counter()
        narrower = [
            curve_named(name).motion(problem.waypoints, _optimal(problem, name, settings))
            for name in _starting(problem)
        ]
        family = Quintic(problem.n_waypoints, problem.n_joints, limited_orders(problem))
        scales = Scales.of(problem, np.diff(narrower[0].waypoint_times))
        exchange = Exchange(family, problem, scales, began + settings.time_limit, settings.time_limit)
        for order, slots in exchange.slots.items():
            slots.preset(FIRST_POINTS[order])
        found = [_run(exchange, family, motion) for motion in narrower]
        own = [family.motion(problem, one.x, scales) for one in found if np.isfinite(one.total)]
        allowed = [motion for motion, name in zip(narrower, _starting(problem), strict=True) if _within(problem, name)]
        candidates = [feasible(problem, motion) for motion in own + allowed]
        return _plan(found, candidates, len(own), time.perf_counter() - began)


def _run(exchange: Exchange, family: Quintic, motion: Motion) -> Optimum:
    """Start from a motion, and where that fails again from the same motion driven more slowly."""
    for factor in (1.0, 1.3):
        start = family.lift_motion(motion.scaled(factor), exchange.problem, exchange.scales)
        optimum = exchange.run_from(start)
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


def _optimal(problem: Problem, name: str, settings: RunSettings) -> np.ndarray:
    durations = optimise(problem, name, seed=settings.seed, time_limit=settings.time_limit / 4).durations
    return durations if np.isfinite(durations).all() else np.ones(problem.n_segments)


def feasible(problem: Problem, motion: Motion) -> Motion:
    """Slow a motion down until every rate keeps its limit, and every segment its shortest duration."""
    peaks = np.array([motion.extrema(order).peak for order in (1, 2, 3)]) / problem.limits.rates
    needed = (peaks.max(axis=1) ** (1 / np.arange(1, 4))).max()
    shortest = problem.duration_bounds[0] / np.diff(motion.waypoint_times).min()
    return motion.scaled(max(1.0, needed, shortest))


def _plan(found: list[Optimum], candidates: list[Motion], own: int, seconds: float) -> Plan:
    iterations = sum(one.iterations for one in found)
    reasons = "; ".join(dict.fromkeys(one.message for one in found if one.message))
    if not candidates:
        return Plan(Status.FAILED, iterations=iterations, message=reasons or "no start led to a motion")
    best = min(range(len(candidates)), key=lambda k: candidates[k].duration)
    converged = any(one.converged for one in found) and best < own
    return Plan(
        Status.FINISHED if converged else Status.NOT_CONVERGED,
        motion=candidates[best],
        durations=np.diff(candidates[best].waypoint_times),
        iterations=iterations,
        message="" if converged else reasons or "no faster than a narrower curve's optimum, which is returned",
        details={
            "exchange_rounds": float(sum(one.rounds for one in found)),
            "constraint_points": float(max(one.points for one in found)),
            "solve_seconds": seconds,
        },
    )


QUINTIC_NLP = QuinticNlp()
