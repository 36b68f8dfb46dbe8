"""Optima on the papers' own problems: certificate against NLP, NLP against every search, and the laws that optima obey."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baselines.bounds.certified import certify, obstacle
from baselines.segment_times.nlp import optimise
from study.cases.library import case_names, load_case
from study.problem import JointLimits, Problem
from study.runs.execute import cell_jobs, stored_results
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.runner import run_jobs
from study.store.store import Store
from tests.helpers.segment_problems import random_problem, shape

ON_353 = [name for name in case_names() if load_case(name).curve == "poly353"]
SEARCHES = ("golds-pso", "gold-sa", "smwoa", "tadf-ssa", "chaotic-spso", "dynamic-adaptive-pso", "cma-es", "scipy-de")


def agree(problem: Problem) -> None:
    certificate, nlp = certify(problem), float(optimise(problem, "poly353").durations.sum())
    assert certificate.finished
    assert certificate.upper <= certificate.lower * (1 + 2e-6)
    assert nlp == pytest.approx(certificate.upper, rel=1e-6)
    assert nlp >= certificate.lower


@pytest.mark.parametrize("name", ON_353)
def test_nlp_and_certificate_agree_on_every_353_case(name: str) -> None:
    agree(load_case(name).problem)


def single_joints() -> list[tuple[str, int]]:
    problems = {name: load_case(name).problem for name in ON_353}
    whole = [(name, j) for name, problem in problems.items() for j in range(problem.n_joints)]
    return [(name, j) for name, j in whole if not obstacle(problems[name].joint(j), "poly353")]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "joint"), single_joints())
def test_nlp_and_certificate_agree_on_every_joint_of_every_353_case(name: str, joint: int) -> None:
    agree(load_case(name).problem.joint(joint))


@pytest.mark.parametrize(
    "name",
    [
        *("woodworking", "ur5-helix-smooth"),
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("puma560", "aubo-i5", "ur5-bspline", "ur5-helix")),
    ],
)
def test_started_from_any_stored_search_the_nlp_never_ends_slower(name: str, tmp_path, threads) -> None:
    case = load_case(name)
    specs = [Spec(search) for search in SEARCHES] + [Spec(search, "scaled", "shared") for search in SEARCHES]
    cells = make_cells([case], specs, Budget(seeds=1, evaluations=400))
    with Store(tmp_path / "results.sqlite") as store:
        run_jobs(cell_jobs(cells, {name: case}), store, workers=1)
        stored = stored_results(store, cells, {name: case})
    feasible = [one for one in stored if one.verdict and one.verdict.feasible and one.durations is not None]
    assert len(feasible) >= len(SEARCHES)
    for one in feasible:
        found = optimise(case.problem, case.curve, count=1, first=one.durations).durations
        assert found.sum() <= one.verdict.duration * (1 + 1e-9), one.cell.label


@pytest.mark.parametrize("order", range(3))
@pytest.mark.parametrize("curve", ["poly353", "cubic-spline", "cubic-spline-smooth", "bspline"])
def test_loosening_a_limit_never_lengthens_on_the_curve(curve: str, order: int) -> None:
    problem = random_problem(11, *shape(curve))
    before = optimise(problem, curve).durations.sum()
    for joint in (0, slice(None)):
        rates = problem.limits.rates.copy()
        rates[order, joint] *= 1.3
        looser = replace(problem, limits=JointLimits(*rates))
        assert optimise(looser, curve).durations.sum() <= before * (1 + 1e-8)


@pytest.mark.parametrize("order", range(3))
def test_loosening_a_limit_never_raises_a_certificate(order: int) -> None:
    problem = random_problem(12, 4, 2)
    rates = problem.limits.rates.copy()
    rates[order] *= np.array([1.0, 1.4])
    assert certify(replace(problem, limits=JointLimits(*rates))).lower <= certify(problem).upper
