"""Nonlinear program over segment durations on a curve family, with every limit held between points too.

The limits are semi-infinite: they hold at every instant. The exchange holds them at a few points, solves, lets exact
extrema find where they break, adds those points and solves again; a stretch by about 1 + 1e-9 then makes the answer
feasible to the last digit. The curve families are in `polynomial_curves` and `bspline_curve`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from baselines.base import Deterministic, longest, parts, where_something_moves
from baselines.segment_times.bspline_curve import BSpline, velocity_bound
from baselines.segment_times.exchange import Exchange, Optimum
from baselines.segment_times.model import Family
from baselines.segment_times.polynomial_curves import CubicSpline, Poly353, limited_orders
from baselines.segment_times.starts import feasible, starts
from baselines.units import dimensionless, largest_steps
from study.curves import curve_named
from study.deadline import Deadline
from study.errors import StudyError, unknown
from study.formulation import Scaled, stretch
from study.planning import Freedom, Plan, RunSettings, Status, Synchronisation
from study.problem import Floats, Problem

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
        return Poly353(n, joints, orders)
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
    family, deadline = curve_named(curve), Deadline.after(time_limit)
    transcription = family_of(curve, problem)
    guesses = starts(problem, family, count, seed)
    if first is not None:
        guesses[0] = feasible(problem, family, np.asarray(first, dtype=float))
    scaled, units = dimensionless(problem, guesses[0].mean(), largest_steps(problem))
    exchange = Exchange(transcription, scaled, deadline, time_limit)
    optima = _from_each(exchange, [guess / units.time for guess in guesses])
    answer = _answer(problem, curve, optima, units.time * transcription.durations(_best(optima).x))
    return _not_above(answer, Scaled(problem, family).durations(np.array(guesses)))


def _from_each(exchange: Exchange, guesses: Iterable[Floats]) -> list[Optimum]:
    """Run every start, a failed one again from twice its durations; two starts that agree are enough."""
    optima: list[Optimum] = []
    for guess in guesses:
        optimum = exchange.run(guess)
        optima.append(optimum if optimum.converged else exchange.run(2.0 * guess))
        totals = sorted(optimum.total for optimum in optima if optimum.converged)
        if len(totals) > 1 and totals[1] <= totals[0] * (1 + AGREEING):
            break
    return optima


def _best(optima: list[Optimum]) -> Optimum:
    """Converged before others, then by total time once no limit is broken any more."""
    return min(optima, key=lambda optimum: (not optimum.converged, optimum.total * (1 + max(optimum.excess, 0.0))))


def _not_above(answer: Answer, reached: Floats) -> Answer:
    """Keep the better of the answer and the starts themselves, so that nothing ends slower than it began."""
    totals = reached.sum(axis=1)
    best = int(totals.argmin())
    if not totals[best] < answer.durations.sum() * (1 - 1e-9):
        return answer
    reason = answer.message or "the solver ended above its own start, which is returned"
    return replace(answer, durations=reached[best], message=reason)


def _answer(problem: Problem, curve: str, optima: list[Optimum], durations: Floats) -> Answer:
    """Make the durations of the best optimum exactly feasible, and count what all of them took."""
    best, durations = _best(optima), np.maximum(durations, problem.duration_bounds[0])
    usable = np.isfinite(best.excess) and bool((durations > 0).all())
    factor = max(float(stretch(problem, curve_named(curve), durations[None])[0]), 1.0) if usable else np.inf
    agreeing = sum(optimum.converged and optimum.total <= best.total * (1 + AGREEING) for optimum in optima)
    details = {
        "exchange_rounds": float(best.rounds),
        "constraint_points": float(best.points),
        "stretch": factor,
        "starts": float(len(optima)),
        "starts_agreeing": float(agreeing),
    }
    message = "" if best.converged else best.message or f"limits still broken by {best.excess:.2g} between the points"
    return Answer(durations * factor, message, sum(optimum.iterations for optimum in optima), details)


@dataclass(frozen=True)
class CasadiNlp(Deterministic):
    """Planner `casadi-nlp`.

    Parameters
    ----------
    starts : int
        Most starts of the NLP; the seed moves all but the first, and two that agree end it.
    """

    starts: int = 3
    set_up: ClassVar[float] = 0.0006
    about: ClassVar[str] = "segment durations by nonlinear programming (CasADi and IPOPT)"
    freedom: ClassVar[Freedom] = Freedom.CURVE

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Optimise all joints together, or each alone and then take the longest duration of every segment."""
        problems = parts(problem, settings)
        answers = [
            optimise(
                part,
                settings.curve,
                seed=settings.seed,
                count=self.starts,
                time_limit=settings.time_limit / len(problems),
            )
            for part in problems
        ]
        durations = longest(answer.durations for answer in answers)
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
            details=_together(answers),
            lower_bound=_bound(problem, settings),
        )


def _together(answers: list[Answer]) -> dict[str, float]:
    """Sum the counts and seconds of all parts; of the stretch keep the largest, of the agreement the smallest."""
    special = {"stretch": max, "starts_agreeing": min}
    return {
        name: float(special.get(name, sum)(answer.details[name] for answer in answers)) for name in answers[0].details
    }


def _bound(problem: Problem, settings: RunSettings) -> float | None:
    """Proved lower bound on the total time of the settings' curve, s, where one is at hand."""
    shared = settings.synchronisation is Synchronisation.SHARED
    return velocity_bound(problem) if settings.curve == "bspline" and shared else None
