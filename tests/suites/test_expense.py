"""What a whole line-up costs: by hand."""

from dataclasses import replace

import pytest

from study.analysis.formatting import wall
from study.cases.suites import PAPERS, suite_named
from study.suites import expense as module
from study.suites.expense import expense
from study.suites.lineups import Lineup
from study.suites.measures import Field
from study.suites.runs import Run

RUN = Run("hard:x", 4, 2, False, "pso", "curve", 1000, 0, "FINISHED", True, 1.0, 1.0, 2.0, 0.0, "")


def test_cells_cost_their_own_medians_and_the_usual_rate_elsewhere(monkeypatch):
    hard = suite_named("hard")
    first, *others = hard.cases.values()
    monkeypatch.setattr(
        module, "usual_lineup", lambda suite: Lineup("", "", {"toppra": 9.0, "casadi-nlp": 9.0}, {"pso": 20.0})
    )
    searched = replace(RUN, problem=first.name, segments=first.problem.n_segments)
    path = replace(searched, planner="toppra", evaluations=0, wall_time=0.5)
    larger = [
        replace(searched, evaluations=10_000, seed=seed, wall_time=time) for seed, time in enumerate((3.0, 4.0, 9.0))
    ]
    said = expense(hard, Field((searched, path), {}))
    n = len(hard.cases)
    rate = 2.0 / first.problem.n_segments
    mean = sum([2.0, *(min(20.0, rate * case.problem.n_segments) for case in others)]) / n
    assert f"has {32 * n:,} cells, 2 of them committed" in said
    assert f"{10 * n} cells of 1,000 evaluations {mean:.3g} s each" in said
    told = expense(hard, Field((searched, path, *larger), {}))
    rate = sorted([2.0 / 1000, *(each.wall_time / 10_000 for each in larger)])
    usual = 10_000 * (rate[1] + rate[2]) / 2 / first.problem.n_segments
    mean = sum([4.0, *(min(20.0, usual * case.problem.n_segments) for case in others)]) / n
    assert f"{10 * n} cells of 10,000 evaluations {wall(mean)} each" in told
    assert f"{n} cells of planners without a committed run are not in it" in said


@pytest.mark.parametrize(("name", "runs"), [(PAPERS, (RUN,)), ("hard", ())])
def test_nothing_is_said_of_the_papers_or_without_runs(name, runs):
    assert expense(suite_named(name), Field(runs, {})) == ""
