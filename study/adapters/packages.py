"""Problem forms of pymoo, mealpy and IOHexperimenter; each package is imported only when asked for."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from study.adapters.objective import DurationObjective
from study.arrays import of_kind
from study.errors import StudyError
from study.problem import Floats


def pymoo_problem(objective: DurationObjective) -> Any:
    """Wrap an objective as a `pymoo.core.problem.Problem` that evaluates whole populations.

    Raises
    ------
    StudyError
        If pymoo is not installed.
    """
    of_kind(objective, DurationObjective, "objective")
    try:
        from pymoo.core.problem import Problem
    except ModuleNotFoundError:
        raise _missing("pymoo") from None

    class CaseProblem(Problem):  # type: ignore[misc, unused-ignore]
        def __init__(self) -> None:
            super().__init__(n_var=objective.n_dimensions, n_obj=1, xl=objective.lower, xu=objective.upper)

        def _evaluate(self, x: Floats, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
            out["F"] = objective.values(x)[:, None]

    return CaseProblem()


def mealpy_problem(objective: DurationObjective) -> dict[str, Any]:
    """Wrap an objective as the dictionary that mealpy's `solve` takes.

    Raises
    ------
    StudyError
        If mealpy is not installed.
    """
    of_kind(objective, DurationObjective, "objective")
    try:
        from mealpy import FloatVar
    except ModuleNotFoundError:
        raise _missing("mealpy") from None
    return {
        "obj_func": objective,
        "bounds": FloatVar(lb=objective.lower.tolist(), ub=objective.upper.tolist()),
        "minmax": "min",
        "name": objective.name,
        "log_to": None,
    }


def _missing(package: str) -> StudyError:
    return StudyError(f"the adapter for {package} needs it installed; install it with: pip install {package}")


@dataclass
class IohCallable:
    """Objective with the attributes of an IOHexperimenter problem: `meta_data`, `bounds`, `optimum`, `state`, `reset`.

    Attributes
    ----------
    objective : DurationObjective
    best_point : array of shape (n_dimensions,), optional
        Best point evaluated so far.
    """

    objective: DurationObjective
    best_point: Floats | None = field(default=None, init=False)

    @property
    def meta_data(self) -> SimpleNamespace:
        """Name, number of variables, instance and kind of optimisation."""
        wrapped = self.objective
        return SimpleNamespace(
            name=f"{wrapped.case.name}-{wrapped.formulation}",
            n_variables=wrapped.n_dimensions,
            instance=wrapped.instance.number,
            minimization=True,
        )

    @property
    def bounds(self) -> SimpleNamespace:
        """Lower and upper bounds, `lb` and `ub`."""
        return SimpleNamespace(lb=self.objective.lower, ub=self.objective.upper)

    @property
    def optimum(self) -> SimpleNamespace:
        """Best point and value known, `x` and `y`."""
        return SimpleNamespace(x=self.objective.best_point, y=self.objective.best_known)

    @property
    def state(self) -> SimpleNamespace:
        """Evaluations so far and the best of them."""
        best = SimpleNamespace(x=self.best_point, y=self.objective.best)
        return SimpleNamespace(evaluations=self.objective.evaluations, current_best=best)

    def __call__(self, x: Any) -> float | list[float]:
        """Evaluate one point, or a list of them."""
        points = np.asarray(x, dtype=float)
        before = self.objective.best
        values = self.objective(points)
        if self.objective.best < before:
            self.best_point = np.atleast_2d(points)[int(np.argmin(values))].copy()
        return values if isinstance(values, float) else values.tolist()

    def reset(self) -> None:
        """Forget all evaluations."""
        self.objective.reset()
        self.best_point = None


def ioh_callable(objective: DurationObjective) -> IohCallable:
    """Wrap an objective as a callable in the manner of IOHexperimenter."""
    return IohCallable(of_kind(objective, DurationObjective, "objective"))
