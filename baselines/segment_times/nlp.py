"""Segment-time NLP: the shortest durations on a curve family by IPOPT, with every limit held between points too.

The limits are semi-infinite: they hold at every instant. The exchange holds them at a few points, solves, lets exact extrema
find where they break, adds those points and solves again; a stretch by about 1 + 1e-9 then makes the answer feasible to the
last digit. The curve families and what each gives away are in `_families` and `_family_bspline`.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from baselines.segment_times.bspline_curve import BSpline, velocity_bound
from baselines.segment_times.exchange import Exchange, Optimum
from baselines.segment_times.model import Family, Scales
from baselines.segment_times.polynomial_curves import CubicSpline, Poly353, limited_orders
from baselines.segment_times.starts import feasible, starts
from study.curves import curve_named
from study.errors import StudyError, unknown
from study.formulation import Scaled, stretch
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status, Synchronisation
from study.problem import Demand, Floats, Problem

AGREEING = 1e-7
"""Relative distance at which two totals are the same optimum."""


@dataclass(frozen=True, eq=False)
class Answer:
    """Best durations found on one problem.

    Attributes
    ----------
    durations : array of shape (n_segments,), s
        Exactly feasible.
    message : str
        Empty where the best start converged, else the solver's reason.
    iterations : int
    details : dict of str to float
    """

    durations: Floats
    message: str
    iterations: int
    details: dict[str, float] = field(default_factory=dict)


def family_of(curve: str, problem: Problem) -> Family:
    """Choose the transcription of a curve family for the shape of a problem.

    Raises
    ------
    StudyError
        If there is none, or the waypoints do not fit the curve.
    """
    n, joints, orders = problem.n_waypoints, problem.n_joints, limited_orders(problem)
    if curve == "poly353":
        if n != 4:
            raise StudyError(f"the 3-5-3 curve needs exactly 4 waypoints, got {n}; use cubic-spline instead")
        return Poly353(joints, orders)
    if curve == "cubic-spline":
        return CubicSpline(n, joints, orders)
    if curve == "cubic-spline-smooth":
        return CubicSpline(n, joints, orders, smooth=True)
    if curve == "bspline":
        return BSpline(n, joints, orders)
    raise unknown("transcription of curve", curve, ("poly353", "cubic-spline", "cubic-spline-smooth", "bspline"))


def optimise(
    problem: Problem,
    curve: str,
    *,
    seed: int = 0,
    count: int = 3,
    time_limit: float = 60.0,
    first: Floats | None = None,
) -> Answer:
    """Find the shortest durations of all joints together.

    Parameters
    ----------
    problem : Problem
    curve : str
        A name in `study.curves.CURVES`.
    seed : int
        Of the starts after the first.
    count : int
        Most starts; two that agree end it.
    time_limit : float, s
        Wall time in all.
    first : array of shape (n_segments,), s, optional
        Durations to start from in place of the usual guess, such as a search's answer.

    Returns
    -------
    Answer
        Durations infinite where no start led to a motion.

    Raises
    ------
    StudyError
        If the curve is unknown or does not fit the waypoints.
    """
    family, began = curve_named(curve), time.perf_counter()
    transcription = family_of(curve, problem)
    guesses = starts(problem, family, count, seed)
    if first is not None:
        guesses[0] = feasible(problem, family, np.asarray(first, dtype=float))
    scales = Scales.of(problem, guesses[0])
    exchange = Exchange(transcription, problem, scales, began + time_limit, time_limit)
    found = _from_each(exchange, guesses)
    answer = _answer(exchange, found, curve, time.perf_counter() - began)
    return _not_above(answer, Scaled(problem, family).durations(np.array(guesses)))


def _from_each(exchange: Exchange, guesses: Iterable[Floats]) -> list[Optimum]:
    """Run every start, a failed one again from twice its durations; two starts that agree are enough."""
    found: list[Optimum] = []
    for guess in guesses:
        optimum = exchange.run(guess)
        found.append(optimum if optimum.converged else exchange.run(2.0 * guess))
        totals = sorted(one.total for one in found if one.converged)
        if len(totals) > 1 and totals[1] <= totals[0] * (1 + AGREEING):
            break
    return found


def _not_above(answer: Answer, reached: Floats) -> Answer:
    """Keep the better of the answer and the starts themselves, so that nothing ends slower than it began."""
    totals = reached.sum(axis=1)
    best = int(totals.argmin())
    if not totals[best] < answer.durations.sum() * (1 - 1e-9):
        return answer
    reason = answer.message or "the solver ended above its own start, which is returned"
    return replace(answer, durations=reached[best], message=reason)


def _answer(exchange: Exchange, found: list[Optimum], curve: str, seconds: float) -> Answer:
    problem = exchange.problem
    best = min(found, key=lambda optimum: (not optimum.converged, optimum.total * (1 + max(optimum.excess, 0.0))))
    iterations = sum(optimum.iterations for optimum in found)
    durations = np.maximum(exchange.family.durations(best.x, exchange.scales), problem.duration_bounds[0])
    usable = np.isfinite(best.excess) and bool((durations > 0).all())
    factor = max(float(stretch(problem, curve_named(curve), durations[None])[0]), 1.0) if usable else np.inf
    agreeing = sum(optimum.converged and optimum.total <= best.total * (1 + AGREEING) for optimum in found)
    details = {
        "exchange_rounds": float(best.rounds),
        "constraint_points": float(best.points),
        "stretch": factor,
        "starts": float(len(found)),
        "starts_agreeing": float(agreeing),
        "solve_seconds": seconds,
    }
    message = "" if best.converged else best.message or f"limits still broken by {best.excess:.2g} between the points"
    return Answer(durations * factor, message, iterations, details)


@dataclass(frozen=True)
class CasadiNlp:
    """The planner `casadi-nlp`.

    Parameters
    ----------
    starts : int
        Most starts of the NLP; the seed moves all but the first, and two that agree end it.
    """

    starts: int = 3
    about: ClassVar[str] = "segment durations by nonlinear programming (CasADi and IPOPT)"
    freedom: ClassVar[Freedom] = Freedom.CURVE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS
    stochastic: ClassVar[bool] = False

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Optimise all joints together, or each alone and then take the longest duration of every segment.

        Raises
        ------
        StudyError
            If the curve is unknown or does not fit the waypoints.
        """
        alone = settings.synchronisation is Synchronisation.PER_JOINT
        parts = [problem.joint(j) for j in range(problem.n_joints)] if alone else [problem]
        share = settings.time_limit / len(parts)
        answers = [
            optimise(part, settings.curve, seed=settings.seed, count=self.starts, time_limit=share) for part in parts
        ]
        durations = np.max([answer.durations for answer in answers], axis=0)
        reasons = "; ".join(dict.fromkeys(answer.message for answer in answers if answer.message))
        iterations = sum(answer.iterations for answer in answers)
        if not np.isfinite(durations).all():
            return Plan(Status.FAILED, iterations=iterations, message=reasons or "no start led to a motion")
        return Plan(
            Status.NOT_CONVERGED if reasons else Status.FINISHED,
            motion=curve_named(settings.curve).motion(problem.waypoints, durations),
            durations=durations,
            iterations=iterations,
            message=reasons,
            details=_together(answers) | _bound(problem, settings),
        )


def _together(answers: list[Answer]) -> dict[str, float]:
    """Sum the counts and seconds of all parts; of the stretch keep the largest, of the agreement the smallest."""
    special = {"stretch": max, "starts_agreeing": min}
    return {
        name: float(special.get(name, sum)(answer.details[name] for answer in answers)) for name in answers[0].details
    }


def _bound(problem: Problem, settings: RunSettings) -> dict[str, float]:
    if settings.curve != "bspline" or settings.synchronisation is not Synchronisation.SHARED:
        return {}
    return {"lower_bound": velocity_bound(problem)}


CASADI_NLP = CasadiNlp()
