"""Filter line search: which step lengths the interior-point method accepts.

A pair (infeasibility, barrier function) is dominated by another that is no worse in both. With a fixed barrier
parameter a step is accepted if no pair of the filter dominates its end and if it makes progress from where it began:
where the infeasibility is small and the barrier function falls along the step, by Armijo's rule; else in either of the
two.

References
----------
A. Waechter and L. Biegler, On the implementation of an interior-point filter line-search algorithm, Math. Program. 106,
2006, section 2.3.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from study.problem import Floats

HALVINGS = 8
"""Trial lengths; the shortest is taken even if refused, since another point gives another direction."""

REFUSALS = 12
"""Steps in a row without an acceptable length after which the method counts as stuck."""

ARMIJO = 1e-4
MARGIN = 1e-5


class Measure(NamedTuple):
    """Infeasibility and barrier function of a point.

    Attributes
    ----------
    infeasibility : float
    objective : float
    slacks : array, one entry for every row
    """

    infeasibility: float
    objective: float
    slacks: Floats


class LineSearch:
    """A filter that is emptied whenever the barrier parameter changes.

    Parameters
    ----------
    small : float
        Infeasibility below which the barrier function must fall.
    """

    def __init__(self, small: float) -> None:
        self._small = small
        self._target = np.nan
        self._pairs: list[tuple[float, float]] = []
        self._refusals = 0

    @property
    def alive(self) -> bool:
        """Whether steps still make progress now and then."""
        return self._refusals <= REFUSALS

    def begin(self, target: float, now: Measure, rise: float, slacks: Floats) -> None:
        """Prepare for a step.

        Parameters
        ----------
        target : float
            Barrier parameter.
        now : Measure
            Where the step begins.
        rise : float
            Change of the objective along the whole step.
        slacks : array, one entry for every row
            Change of the slacks along it.
        """
        if target != self._target:
            self._target, self._pairs = target, []
        self._now, self._barrier = now.infeasibility, self._barrier_of(now)
        self._slope = rise - target * float((slacks / now.slacks).sum())
        self._refusals += 1

    def _barrier_of(self, measure: Measure) -> float:
        return measure.objective - self._target * float(np.log(measure.slacks).sum())

    def accepts(self, reached: Measure, length: float) -> bool:
        """Whether a length of the step may be taken; keeps the filter up to date if so."""
        theta, phi = reached.infeasibility, self._barrier_of(reached)
        if not all(theta <= (1 - MARGIN) * a or phi <= b - MARGIN * a for a, b in self._pairs):
            return False
        if self._slope < 0 and -length * self._slope > self._now**1.1 and self._now <= self._small:
            taken = phi <= self._barrier + ARMIJO * length * self._slope
        elif taken := theta <= (1 - MARGIN) * self._now or phi <= self._barrier - MARGIN * self._now:
            self._pairs.append((self._now, self._barrier))
        if taken:
            self._refusals = 0
        return taken
