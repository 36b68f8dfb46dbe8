"""Semi-infinite exchange: solve with the limits at a few points, add the points where they break, solve again."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from baselines.ipopt import Solution
from baselines.segment_times.critical_points import Slots
from baselines.segment_times.model import Family, model_of
from study.deadline import Deadline
from study.problem import Floats, Problem

EXACT = 1e-9
"""Largest relative excess at which the exchange ends."""

MAX_ROUNDS = 25

WATCHED = 0.9
"""Peaks above this part of their limit get a slot before they break it."""

FIRST = 0.2
"""The same for the motion that a solve starts from."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """Result of an exchange.

    Attributes
    ----------
    x : array
        Variables of the family.
    total : float
        Sum of the durations, infinite where there is no motion.
    excess : float
        Stretch that the peaks held by points still need, less 1; other limits are bounds of the NLP.
    message : str
        Empty, or why the solver stopped.
    rounds, iterations, points : int
    """

    x: Floats
    total: float
    excess: float
    message: str
    rounds: int
    iterations: int
    points: int

    @property
    def converged(self) -> bool:
        """Whether the solver was content and the limits hold between the points too."""
        return not self.message and self.excess <= EXACT


class Exchange:
    """One family on one problem; points found from one start serve the next.

    Parameters
    ----------
    family : Family
    problem : Problem
        Dimensionless.
    deadline : Deadline
        No new solve begins after it.
    time_limit : float, s
        Wall time of one solve.
    """

    def __init__(self, family: Family, problem: Problem, deadline: Deadline, time_limit: float) -> None:
        self.family, self.problem, self.deadline = family, problem, deadline
        self.model = model_of(family, time_limit)
        self.slots = {order: Slots(shape, pooled=family.pooled) for order, shape in family.slot_shapes.items()}

    def offer(self, x: Floats, threshold: float = WATCHED, corrected: bool = True) -> float:
        """Put the peaks that come near their limits into the slots; return the stretch that the highest needs."""
        needed = 0.0
        for order, slot in self.slots.items():
            critical = self.family.critical(self.problem, x, order)
            slot.refresh(critical, threshold, corrected)
            needed = max(needed, float(np.abs(critical.ratios).max()) ** (1 / order))
        return needed

    def run(self, durations: Floats) -> Optimum:
        """Run the exchange from given durations."""
        return self.run_from(self.family.lift(self.problem, durations))

    def run_from(self, x: Floats) -> Optimum:
        """Run the exchange from given variables until no limit breaks and the total stands still."""
        multipliers: dict[str, Floats] = {}
        self.offer(x, threshold=FIRST, corrected=False)
        best = Optimum(x, np.inf, np.inf, "the solver did not run", 0, 0, 0)
        for _ in range(MAX_ROUNDS):
            if self.deadline.passed():
                return replace(best, message="the time limit was reached")
            solution = self._solve(best.x, multipliers)
            multipliers = solution.multipliers
            last, best = best, self._judged(best, solution)
            if best.message or (best.excess <= EXACT and abs(best.total - last.total) <= EXACT * best.total):
                break
        return best

    def _judged(self, last: Optimum, solution: Solution) -> Optimum:
        """Take the solver's answer, find where it breaks the limits and prepare the next round."""
        x = solution.x
        finite = bool(np.isfinite(x).all() and (self.family.durations(x) > 0).all())
        return Optimum(
            x if finite else last.x,
            float(self.family.durations(x).sum()) if finite else np.inf,
            self.offer(x) - 1 if finite else np.inf,
            "" if solution.success and finite else f"IPOPT: {solution.status}",
            last.rounds + 1,
            last.iterations + solution.iterations,
            sum(int(slot.used.sum()) for slot in self.slots.values()),
        )

    def _solve(self, x: Floats, multipliers: dict[str, Floats]) -> Solution:
        """Solve at the present points; a warm start can stall where a cold one does not."""
        solution = self._call(x, multipliers)
        return solution if solution.success or not multipliers else self._call(x, {})

    def _call(self, x: Floats, multipliers: dict[str, Floats]) -> Solution:
        solver = self.model.warm if multipliers else self.model.cold
        lbx, ubx = self.family.variable_bounds(self.problem)
        lbg, ubg = self.family.row_bounds(self.problem, self.slots)
        p = self.family.parameters(self.problem, self.slots)
        p = np.concatenate([p, x]) if self.model.rows.proximal else p
        return solver.solve(x0=x, p=p, lbx=lbx, ubx=ubx, lbg=lbg, ubg=ubg, **multipliers)
