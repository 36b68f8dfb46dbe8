"""Objectives of segment durations, penalised or scaled, for a whole population at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from study.curves import Curve
from study.errors import StudyError
from study.planning import Formulation
from study.problem import Floats, JointLimits, Problem


def stretch(problem: Problem, curve: Curve, durations: Floats) -> Floats:
    """Smallest factor on all durations that makes each candidate feasible, where both ends are at rest or free.

    Durations times k divide velocity, acceleration and jerk by k, k^2 and k^3, so
    k = max(v/V, sqrt(a/A), cbrt(j/J)).

    Parameters
    ----------
    problem : Problem
    curve : Curve
    durations : array of shape (n_candidates, n_segments), s

    Returns
    -------
    array of shape (n_candidates,)
        At most 1 for a candidate that is feasible as it stands.
    """
    orders, limits = _limited(problem.limits)
    if not orders:
        return np.zeros(len(durations))
    return curve.demand(curve.peaks(problem.waypoints, durations, orders), limits, orders)


@lru_cache(maxsize=64)
def _limited(limits: JointLimits) -> tuple[tuple[int, ...], Floats]:
    """Orders with a limit, and those limits, shape (n_orders, n_joints); asked in every generation of a search."""
    rates = limits.rates
    orders = tuple(order for order in (1, 2, 3) if np.isfinite(rates[order - 1]).any())
    return orders, rates[[order - 1 for order in orders]]


@dataclass(frozen=True)
class Penalty:
    """Total time, plus a penalty where a limit is broken: the papers' form.

    No paper prints its penalty. Ours adds more than any feasible total in the box, and grows with the stretch that the
    candidate would need, so an infeasible candidate never ranks above a feasible one.
    """

    problem: Problem
    curve: Curve

    def __call__(self, durations: Floats) -> Floats:
        """Objective of every candidate, shape (n_candidates,), s."""
        factor = stretch(self.problem, self.curve, durations)
        worst = self.problem.n_segments * self.problem.duration_bounds[1]
        return self.curve.penalty(durations, factor, worst)

    def durations(self, candidates: Floats) -> Floats:
        """Durations to drive, shape (n_candidates, n_segments), s: the candidates themselves."""
        return candidates


@dataclass(frozen=True)
class Scaled:
    """Total time after stretching every candidate until it is exactly feasible; nothing is ever infeasible.

    Raises
    ------
    StudyError
        If the problem gives a velocity or acceleration at an end, which stretching would change.
    """

    problem: Problem
    curve: Curve

    def __post_init__(self) -> None:
        if not self.problem.scalable:
            raise StudyError(
                f"case {self.problem.name!r}: a motion with a given velocity or acceleration at an end cannot be stretched "
                "in time; use the formulation 'penalty'"
            )

    def _factors(self, durations: Floats) -> Floats:
        shortest = self.problem.duration_bounds[0] / durations.min(axis=1)
        return np.maximum(stretch(self.problem, self.curve, durations), shortest)

    def __call__(self, durations: Floats) -> Floats:
        """Objective of every candidate, shape (n_candidates,), s."""
        return durations.sum(axis=1) * self._factors(durations)

    def durations(self, candidates: Floats) -> Floats:
        """Durations to drive, shape (n_candidates, n_segments), s: the candidates, stretched or shortened."""
        return candidates * self._factors(candidates)[:, None]


Objective = Penalty | Scaled


def objective_of(formulation: Formulation | str, problem: Problem, curve: Curve) -> Objective:
    """Objective of a problem on a curve family.

    Raises
    ------
    StudyError
        If there is no such formulation.
    """
    return (Scaled if Formulation(formulation) is Formulation.SCALED else Penalty)(problem, curve)
