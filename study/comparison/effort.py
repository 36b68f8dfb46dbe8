"""Effort of the comparison: quick by default, the papers' budgets and 30 repetitions in full."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from study.runs.lineup import FULL_SEEDS, QUICK_EVALUATIONS, TIME_LIMIT, Budget
from study.runs.selections import SLOW_SOLVERS, SOLVERS

QUICK_CASES = ("woodworking", "ur5-helix")


@dataclass(frozen=True)
class Effort:
    """Repetitions and budgets of all parts.

    Attributes
    ----------
    seeds : int
        Paired repetitions of every planner on every case.
    evaluations : int, optional
        Budget of every planner; None takes that of the case's own paper.
    time_limit : float, s
        Wall time after which a planner is interrupted.
    trial_seeds : int
        Repetitions on trajectory problems in the audit and the ablations.
    trial_evaluations : int
        Budget of those.
    function_seeds : int
        Repetitions on benchmark functions.
    dimensions, generations, population : int
        Size of the benchmark runs; the population is that of the trajectory trials too.
    functions, dosed : tuple of str
        Functions seen at the origin, shifted and rotated; those that take the dose and diagonal tests too.
    audit_cases : collection of str, optional
        Cases of the audit; None takes all.
    printed : bool
        Whether the as-printed readings are audited too.
    solvers : tuple of str
        Compared on wall time and duration only: solvers, and L-BFGS-B with restarts.
    formulations : tuple of str
        Of the trajectory audit.
    """

    seeds: int = 5
    evaluations: int | None = QUICK_EVALUATIONS
    time_limit: float = TIME_LIMIT
    trial_seeds: int = 10
    trial_evaluations: int = 1000
    function_seeds: int = 5
    dimensions: int = 10
    generations: int = 200
    population: int = 30
    functions: tuple[str, ...] = ("sphere", "rastrigin", "ackley")
    dosed: tuple[str, ...] = ("sphere",)
    audit_cases: Collection[str] | None = QUICK_CASES
    printed: bool = False
    solvers: tuple[str, ...] = SOLVERS
    formulations: tuple[str, ...] = ("penalty",)

    @property
    def budget(self) -> Budget:
        """Budget of the planners' runs."""
        return Budget(self.seeds, self.evaluations, self.time_limit)

    def audited(self, cases: Collection[str]) -> list[str]:
        """Cases of the audit and the ablations, out of those that are there; the first two if none is named."""
        names = [name for name in cases if self.audit_cases is None or name in self.audit_cases]
        return names or list(cases)[:2]


QUICK = Effort()
FULL = Effort(
    seeds=FULL_SEEDS,
    evaluations=None,
    trial_seeds=FULL_SEEDS,
    trial_evaluations=3000,
    function_seeds=FULL_SEEDS,
    dimensions=30,
    generations=500,
    functions=("sphere", "schwefel-12", "rastrigin", "ackley", "griewank"),
    dosed=("sphere", "rastrigin"),
    audit_cases=None,
    printed=True,
    solvers=(*SOLVERS, *SLOW_SOLVERS),
    formulations=("penalty", "scaled"),
)
