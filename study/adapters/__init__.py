"""Adapters of the study's problems to optimisation packages: a counted objective and the packages' own forms."""

from study.adapters.objective import DurationObjective, Instance, objective, suite
from study.adapters.packages import ioh_callable, mealpy_problem, pymoo_problem

__all__ = [
    "DurationObjective",
    "Instance",
    "ioh_callable",
    "mealpy_problem",
    "objective",
    "pymoo_problem",
    "suite",
]
