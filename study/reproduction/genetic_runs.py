"""NSGA-II on the PUMA560 case, by pymoo: the comparison row of the RRT paper's Table 6."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, ClassVar

import numpy as np

from study.cases.library import load_case
from study.curves import curve_named
from study.formulation import stretch
from study.problem import Floats
from study.reproduction.jobs import Record, RecordJob

PACKAGE = "pymoo"


def installed() -> bool:
    """Whether pymoo is there; it comes with the optional extra `peers`."""
    return find_spec(PACKAGE) is not None


@dataclass(frozen=True)
class GeneticJob(RecordJob):
    """NSGA-II for one joint's segment durations.

    The paper does not name the objectives. Ours: total time and largest jerk, with the velocity limit as constraint; the
    fastest feasible member of the last front is taken.

    Attributes
    ----------
    case : str
    joint : int
    population, generations, seeds : int
    """

    case: str
    joint: int
    population: int
    generations: int
    seeds: int
    kind: ClassVar[str] = "genetic"
    weight: ClassVar[float] = 3.0

    @property
    def subject(self) -> str:
        """Name of the case."""
        return self.case

    def inputs(self) -> object:
        """Return the case's problem and curve, and whether there is anything to run."""
        case = load_case(self.case)
        return [case.problem, case.curve, installed()]

    def run(self) -> Record:
        """Durations of every seed; empty without pymoo."""
        if not installed():
            return {"durations": []}
        return {"durations": [self._front(seed).tolist() for seed in range(self.seeds)]}

    def _front(self, seed: int) -> Floats:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.problem import Problem as Objectives
        from pymoo.optimize import minimize

        case = load_case(self.case)
        problem, curve = case.problem.joint(self.joint), curve_named(case.curve)
        lower, upper = problem.duration_bounds

        class _Durations(Objectives):  # type: ignore[misc]
            def _evaluate(self, x: Floats, out: dict[str, Any], *args: object, **kwargs: object) -> None:
                jerk = curve.peaks(problem.waypoints, x, (3,)).max(axis=(1, 2))
                out["F"] = np.column_stack([x.sum(axis=1), jerk])
                out["G"] = (stretch(problem, curve, x) - 1.0)[:, None]

        objectives = _Durations(n_var=problem.n_segments, n_obj=2, n_ieq_constr=1, xl=lower, xu=upper)
        result = minimize(objectives, NSGA2(pop_size=self.population), ("n_gen", self.generations), seed=seed)
        return np.asarray(result.X[result.F[:, 0].argmin()])
