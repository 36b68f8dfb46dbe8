"""Tasks of the audit and the ablations: benchmark functions and trajectory problems, each seen in several ways.

A search that only uses its objective and its box gives the same results in every view of a problem; one that uses the
origin of the coordinates, or the diagonal of the box, does not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from study.choices import Choice
from study.curves import curve_named
from study.errors import unknown
from study.formulation import objective_of
from study.problem import Floats, Problem
from study.search.state import Box
from study.testfunctions import Benchmark, benchmarks_of
from study.testfunctions.benchmark import random_rotation, rotated, shifted


class TrajectoryView(Choice):
    """Way to write durations: as they are, t in [lo, hi]; reflected, lo + hi - t; or from the middle of the box."""

    AS_IT_IS = "as they are"
    REFLECTED = "reflected"
    CENTRED = "centred"


class FunctionView(Choice):
    """Place of a function's optimum, and direction of its axes."""

    ORIGIN = "origin"
    TINY = "dose 1e-4"
    SMALL = "dose 1e-2"
    SHIFTED = "shifted"
    ROTATED = "rotated"
    DIAGONAL = "on the diagonal"
    OFF_DIAGONAL = "off the diagonal"


DOSES = {FunctionView.TINY: 1e-4, FunctionView.SMALL: 1e-2, FunctionView.SHIFTED: 0.3}
"""Largest shift of a coordinate as a share of the half range; 0 is `origin`, and 0.3 is the shifted form itself."""

DISTANCE = 0.3
"""Of the optimum from the centre in every coordinate of the diagonal test, as a share of the half range."""


@dataclass(frozen=True, eq=False)
class Task:
    """A formula to be minimised in a box, with the value that counts as zero error."""

    formula: Callable[[Floats], Floats]
    box: Box
    minimum: float = 0.0

    def objective(self, points: Floats) -> Floats:
        """Value candidates row by row: sums over an array in another memory order differ in the last digit."""
        return self.formula(np.ascontiguousarray(points))


@cache
def centred_functions() -> dict[str, Benchmark]:
    """The papers' noiseless benchmark functions whose minimiser is the origin, by name."""
    papers = ("woodworking-golds-pso", "ur5-smwoa", "puma560-chaotic-spso")
    known = {function.name: function for paper in papers for function in benchmarks_of(paper)}
    return {
        name: function
        for name, function in known.items()
        if function.minimiser is not None and not function.minimiser.any() and not function.noise
    }


def resized(function: Benchmark, dimensions: int) -> Benchmark:
    """Take a function with equal sides in another number of dimensions."""
    lower, upper = (np.full(dimensions, edge[0]) for edge in (function.lower, function.upper))
    return replace(function, lower=lower, upper=upper, minimiser=np.zeros(dimensions))


def function_task(name: str, dimensions: int, view: str, seed: int) -> Task:
    """Build a view of a benchmark function; every seed has its own shift, rotation and corner.

    Parameters
    ----------
    name : str
        One of `centred_functions`.
    dimensions : int
    view : str
        A `FunctionView`.
    seed : int

    Raises
    ------
    StudyError
        If there is no such function or view.
    """
    known = centred_functions()
    if name not in known:
        raise unknown("function for the audit", name, known)
    function = resized(known[name], dimensions)
    rng = np.random.default_rng([seed, 20_221_211])  # its own stream: the search's is seeded by the seed alone
    seen = _seen(function, FunctionView(view), rng)
    return Task(seen.formula, Box(seen.lower, seen.upper), seen.minimum or 0.0)


def _seen(function: Benchmark, view: FunctionView, rng: np.random.Generator) -> Benchmark:
    n, half = function.n_dimensions, 0.5 * (function.upper - function.lower)
    signs = rng.choice([-1.0, 1.0], size=n)
    if view in DOSES:
        return shifted(function, DOSES[view] * half * signs * rng.uniform(0.25, 1.0, n))
    if view is FunctionView.ROTATED:
        shift = DOSES[FunctionView.SHIFTED] * half * signs * rng.uniform(0.25, 1.0, n)
        return rotated(shifted(function, shift), random_rotation(n, rng))
    if view is FunctionView.DIAGONAL:
        return shifted(function, DISTANCE * half * signs[0])
    if view is FunctionView.OFF_DIAGONAL:
        signs[:2] = 1.0, -1.0  # never by chance on the diagonal itself
        return shifted(function, DISTANCE * half * signs)
    return function


def trajectory_task(problem: Problem, curve: str, formulation: str, view: str) -> Task:
    """Build a view of a segment-time problem, all joints together.

    Parameters
    ----------
    problem : Problem
    curve : str
    formulation : str
    view : str
        A `TrajectoryView`.

    Raises
    ------
    StudyError
        If there is no such view, curve or formulation.
    """
    view, value = TrajectoryView(view), objective_of(formulation, problem, curve_named(curve))
    lo, hi = problem.duration_bounds
    ones = np.ones(problem.n_segments)
    middle = 0.5 * (lo + hi)

    def formula(points: Floats) -> Floats:
        if view is TrajectoryView.REFLECTED:
            points = lo + hi - points
        elif view is TrajectoryView.CENTRED:
            points = points + middle
        return value(np.clip(points, lo, hi))  # the sums above round

    offset = middle if view is TrajectoryView.CENTRED else 0.0
    return Task(formula, Box((lo - offset) * ones, (hi - offset) * ones))
