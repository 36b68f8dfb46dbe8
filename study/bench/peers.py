"""Other packages' searches, asked for the same number of evaluations of an objective; each an extra."""

from __future__ import annotations

import contextlib
import importlib
import tempfile
import warnings
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from typing import Any

import numpy as np

from study.problem import Floats
from study.search.state import Box

Objective = Callable[[Floats], Floats]
MEALPY = {"pso": "PSO", "de": "DE", "woa": "WOA", "sma": "SMA", "sca": "SCA", "ssa": "SSA"}
PYMOO = {"pso": "PSO", "de": "DE"}
NIAPY = {
    "pso": "ParticleSwarmAlgorithm",
    "de": "DifferentialEvolution",
    "sca": "SineCosineAlgorithm",
    "gsa": "GravitationalSearchAlgorithm",
}


def installed(package: str) -> bool:
    """Whether a peer can be imported; does not import it."""
    return find_spec(package) is not None


def with_mealpy(search: str, value: Callable[[Floats], float], box: Box, population: int, generations: int) -> None:
    """Run mealpy's implementation of a search, which values one candidate at a time."""
    mealpy: Any = importlib.import_module("mealpy")
    module = getattr(mealpy, MEALPY[search])
    problem = {
        "obj_func": value,
        "bounds": mealpy.FloatVar(lb=box.lower.tolist(), ub=box.upper.tolist()),
        "minmax": "min",
        "log_to": None,
    }
    optimiser = getattr(module, f"Original{MEALPY[search]}")(epoch=generations, pop_size=population)
    optimiser.solve(problem, seed=1)


def with_pymoo(search: str, objective: Objective, box: Box, population: int, generations: int) -> None:
    """Run pymoo's implementation of a search, which values a population in one call."""
    problem_module: Any = importlib.import_module("pymoo.core.problem")
    algorithms: Any = importlib.import_module(f"pymoo.algorithms.soo.nonconvex.{search}")
    optimise: Any = importlib.import_module("pymoo.optimize")

    class Task(problem_module.Problem):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(n_var=len(box.lower), n_obj=1, xl=box.lower, xu=box.upper)

        def _evaluate(self, x: Floats, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
            out["F"] = objective(x)[:, None]

    algorithm = getattr(algorithms, PYMOO[search])(pop_size=population)
    optimise.minimize(Task(), algorithm, ("n_gen", generations), seed=1, verbose=False)


def with_niapy(search: str, value: Callable[[Floats], float], box: Box, population: int, generations: int) -> None:
    """Run NiaPy's implementation of a search, which values one candidate at a time."""
    problems: Any = importlib.import_module("niapy.problems")
    task: Any = importlib.import_module("niapy.task")
    basic: Any = importlib.import_module("niapy.algorithms.basic")

    class Question(problems.Problem):  # type: ignore[misc]
        def _evaluate(self, x: Floats) -> float:
            return value(x)

    question = Question(len(box.lower), box.lower, box.upper)
    algorithm = getattr(basic, NIAPY[search])(population_size=population, seed=1)
    algorithm.run(task.Task(problem=question, max_evals=population * generations))


def with_pyswarms(objective: Objective, box: Box, population: int, generations: int) -> None:
    """Run pyswarms' global-best PSO, which values a population in one call."""
    single: Any = importlib.import_module("pyswarms.single")
    options = {"c1": 2.0, "c2": 2.0, "w": 0.7}
    swarm = single.GlobalBestPSO(population, len(box.lower), options, bounds=(box.lower, box.upper))
    swarm.optimize(objective, generations, verbose=False)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep peers' warnings off the screen and their log files out of the user's folder."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        state = np.random.get_state()  # noqa: NPY002
        try:
            yield
        finally:
            np.random.set_state(state)  # noqa: NPY002
