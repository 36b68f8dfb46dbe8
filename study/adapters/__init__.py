"""The study's problems for other people's optimisers: a counted objective, and the forms that their packages want."""

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
