"""Effect sizes between methods of a suite: by hand, and from both sides alike."""

import math
from dataclasses import replace

import pytest

from study.suites.effects import against, control_of, effects, effects_by_problem, featured
from study.suites.measures import Field, best_in, scores
from study.suites.runs import Run
from study.suites.tables import effect_grid, effect_matrix

BASE = Run("s:0", 4, 2, False, "pso", "case's curve", 100, 0, "FINISHED", True, 1.1, 1.0, 2.0, 0.0, "")
PROBLEMS = [f"s:{n}" for n in range(10)]


@pytest.fixture(scope="module")
def field():
    """Ten problems, three seeds: `de` is always shorter than `pso`, `cma-es` ties with it, `worse` fails on half the problems."""
    runs = []
    for k, problem in enumerate(PROBLEMS):
        for seed in range(3):
            search = replace(BASE, problem=problem, seed=seed, duration=1.1 + 0.01 * seed + 0.001 * k)
            runs += [
                search,
                replace(search, planner="cma-es"),
                replace(search, planner="de", duration=1.0 + 0.001 * seed),
            ]
            failed = k % 2 == 0
            runs.append(replace(search, planner="worse", feasible=not failed, duration=math.inf if failed else 1.05))
        runs.append(replace(BASE, problem=problem, planner="small", evaluations=10, duration=1.3))
        runs.append(replace(BASE, problem=problem, planner="nlp", evaluations=0, duration=1.0))
    return Field(tuple(runs), best_in(runs))


def test_the_largest_budget_and_planners_of_no_chance_are_featured(field):
    shown = featured(field, scores(field))
    assert [name.partition(",")[0] for name in shown] == ["nlp", "de", "cma-es", "pso", "worse"]
    assert control_of(field, shown) == "pso, 100 evaluations"
    assert control_of(field, ["nlp"]) == "nlp"
    assert control_of(field, []) == ""


def test_sizes_and_tests_are_those_of_the_runs(field):
    shown = featured(field, scores(field))
    own = {each.method.partition(",")[0]: each for each in against(effects(field, shown), "pso, 100 evaluations")}
    assert (own["de"].a12.estimate, own["de"].better, own["de"].worse, own["de"].delta) == (1.0, 10, 0, 1.0)
    assert own["de"].significant
    assert own["de"].p == pytest.approx(10 * 2**-9)  # the smallest of ten pairs, by Holm
    assert (own["cma-es"].a12.estimate, own["cma-es"].p) == (pytest.approx(0.5), 1.0)
    worse = own["worse"]
    assert (worse.a12.estimate, worse.better, worse.worse) == (0.5, 5, 5)
    assert worse.a12.lower < 0.5 < worse.a12.upper


def test_the_other_side_is_the_complement(field):
    (pair,) = effects(field, ["de, 100 evaluations", "pso, 100 evaluations"])
    other = pair.reversed()
    assert (other.method, other.a12.estimate, other.worse, other.p) == ("pso, 100 evaluations", 0.0, 10, pair.p)


def test_methods_that_share_no_problem_are_not_compared(field):
    apart = Field((*field.runs, replace(BASE, problem="s:elsewhere", planner="alone")), field.best)
    assert effects(apart, ["alone, 100 evaluations", "nlp"]) == []


def test_every_problem_has_its_own_sizes_for_the_file(field):
    rows = effects_by_problem(field, ["de, 100 evaluations", "pso, 100 evaluations", "nlp"], "pso, 100 evaluations")
    assert len(rows) == 2 * len(PROBLEMS)
    assert (rows[0]["problem"], rows[0]["a12"], rows[0]["cliffs_delta"]) == ("s:0", 1.0, 1.0)
    assert 0.1 <= rows[0]["rank_sum_p_holm"] <= 1.0


def test_tables_mark_what_the_test_tells_apart(field):
    shown = featured(field, scores(field))[:4]
    pairs = effects(field, shown)
    control = shown[3]
    assert effect_grid(against(pairs, control), control).rows[0][2] == "1.00 [1.00, 1.00]"
    matrix = effect_matrix(pairs, shown)
    assert [row[0].partition(",")[0] for row in matrix.rows] == ["1. nlp", "2. de", "3. cma-es", "4. pso"]
    assert matrix.rows[1][1:] == ["0.17*", "–", "1.00*", "1.00*"]
