"""Line-ups of suites: who runs, for how long, and what a quick run leaves out."""

import pytest

from study.cases.suites import suite_named
from study.errors import StudyError
from study.registry import unavailable_planners
from study.suites import lineups
from study.suites.lineups import chosen_cases, given_lineup, lineup_named, suite_cells, usual_lineup


def test_the_robots_have_the_deterministic_line_up_with_its_limits():
    suite = suite_named("robots")
    cells = suite_cells(list(suite.cases.values())[:2], usual_lineup(suite), quick=False)
    there = [name for name in lineups.DETERMINISTIC if name not in unavailable_planners()]
    assert [cell.planner for cell in cells] == there * 2
    assert {cell.planner: cell.settings.time_limit for cell in cells} == {n: lineups.DETERMINISTIC[n] for n in there}


def test_a_quick_run_takes_the_marked_problems_and_small_budgets():
    suite = suite_named("scaling")
    quick = chosen_cases(suite, quick=True)
    assert 0 < len(quick) < len(suite.cases)
    assert len(chosen_cases(suite_named("hard"), quick=True)) == len(suite_named("hard").cases)
    lineup = usual_lineup(suite)
    for is_quick, budgets, seeds in ((True, {1000, 10_000}, 3), (False, {1000, 10_000, 100_000}, 10)):
        cells = [c for c in suite_cells(quick[:1], lineup, is_quick) if c.planner in lineup.searches]
        assert {cell.settings.evaluations for cell in cells} == budgets
        assert {cell.settings.seed for cell in cells} == set(range(seeds))
        assert {cell.label.partition(":")[0] for cell in cells} == set(lineup.searches)


def test_planners_that_are_asked_for_take_the_place_of_the_line_up():
    case = chosen_cases(suite_named("hard"), quick=True)[0]
    cells = suite_cells([case], given_lineup(["pso", "toppra"], 7.0), quick=True, seeds=2, evaluations=50)
    assert [(c.planner, c.settings.seed, c.settings.time_limit) for c in cells] == [
        ("toppra", 0, 7.0),
        ("pso", 0, 7.0),
        ("pso", 1, 7.0),
    ]


def test_unknown_line_ups_and_the_papers_are_told():
    with pytest.raises(StudyError, match="line-up"):
        lineup_named("none")
    with pytest.raises(StudyError, match="leave --suite out"):
        usual_lineup(suite_named("papers"))
