"""Measures over a suite: by hand, and no failure is dropped."""

import math
from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

from study.errors import StudyError
from study.suites import measures
from study.suites.measures import Field, best_in, scores, shifted_mean
from study.suites.profiles import data_profiles, performance_profiles
from study.suites.runs import FINENESS, Run, added, improvements, read_runs, write_runs

GOOD = Run(
    "s:a", 3, 2, False, "quick", "free path", 0, 0, "FINISHED", True, 1.0, 1.0, 0.05, 0.0, ""
)  # fmt: skip
SLOW = replace(GOOD, planner="slow", duration=1.5, wall_time=5.0, kind="fixed path")
BROKEN = replace(SLOW, problem="s:b", feasible=False, stretch=1.2, reason="too fast")


@pytest.fixture
def field():
    runs = (GOOD, replace(GOOD, problem="s:b", duration=2.0), SLOW, BROKEN)
    return Field(runs, best_in(runs))


def test_the_shifted_mean_caps_failures_and_is_exact_for_equal_gaps():
    assert shifted_mean([0.3, 0.3]) == pytest.approx(0.3)
    assert shifted_mean([0.0, math.inf]) == pytest.approx(math.sqrt(0.01 * 10.01) - 0.01)
    assert shifted_mean([0.0]) == pytest.approx(0.0)


def test_a_failure_counts_in_every_number(field):
    first, last = scores(field)
    assert (first.method, first.feasible, first.runs, first.near) == ("quick", 2, 2, 1.0)
    assert first.within == (1.0, 1.0, 1.0)
    assert (last.method, last.feasible, last.runs, last.near) == ("slow", 1, 2, 0.0)
    assert last.failures == {"breaks limits": 1}
    assert (first.excess, last.excess) == (0.0, pytest.approx(BROKEN.stretch - 1.0))
    assert last.gap_any == pytest.approx(math.sqrt(0.51 * 10.01) - 0.01)
    assert last.gap_own == pytest.approx(math.sqrt(0.01 * 10.01) - 0.01)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"status": "NOT_APPLICABLE", "duration": math.inf}, "does not apply"),
        ({"status": "TIMED_OUT", "duration": math.inf}, "out of time"),
        ({"status": "FAILED", "duration": math.inf}, "no motion"),
        ({"stretch": 1.0}, "misses another demand"),
    ],
)
def test_endings_are_told_apart(field, changes, said):
    runs = (*field.runs[:3], replace(BROKEN, **changes))
    assert scores(Field(runs, field.best))[1].failures == {said: 1}


def test_a_problem_that_nobody_solved_counts_too():
    lost = replace(BROKEN, problem="s:c")
    (score,) = scores(Field((lost,), best_in([lost])))
    assert (score.feasible, score.gap_any) == (0, pytest.approx(measures.FAILED))


def test_profiles_end_at_the_share_that_succeeded(field):
    lines = {line.method: line for line in performance_profiles(field)}
    assert (lines["quick"].x.tolist(), lines["quick"].share.tolist()) == ([1.0], [1.0])
    assert lines["slow"].share.tolist() == [0.5]
    near = {line.method: line for line in data_profiles(field)}
    assert near["slow"].x.size == 0
    assert near["quick"].x.tolist() == [0.05]


def test_the_table_of_problems_has_infinity_where_a_method_failed(field):
    methods, problems, values = measures.table_of_problems(field)
    assert (methods, problems) == (["quick", "slow"], ["s:a", "s:b"])
    np.testing.assert_array_equal(values, [[1.0, 1.5], [2.0, np.inf]])


def test_improvements_keep_the_end_and_reach_every_mark_at_most_5_percent_late():
    rng = np.random.default_rng(3)
    evaluations = 50.0 * np.arange(1, 201)
    values = 2.0 * (1.0 + np.minimum.accumulate(rng.random(200) * 100 / evaluations))
    curve = improvements(np.column_stack([evaluations, values]), float(values[-1]))
    assert len(curve) < 60
    assert curve[-1, 1] == 0.0
    for mark in (0.5, 0.1, 0.01):
        exact = evaluations[np.argmax(values <= values[-1] * (1 + mark))]
        kept = curve[np.argmax(curve[:, 1] <= mark), 0]
        assert exact <= kept <= exact * FINENESS


def test_a_history_without_motions_leaves_no_curve_and_a_single_record_one_point():
    assert improvements(np.array([[50.0, np.inf], [100.0, np.inf]]), 1.0).shape == (0, 2)
    assert improvements(np.empty((0, 2)), 1.0).shape == (0, 2)
    assert improvements(np.array([[50.0, np.inf], [100.0, 3.0]]), 3.0).tolist() == [[100.0, 0.0]]


def test_files_of_before_the_curves_are_read(tmp_path, field):
    path = tmp_path / "runs.parquet"
    write_runs(path, field.runs)
    pq.write_table(pq.read_table(path).drop_columns(["spent", "curve_evaluations", "curve_above"]), path)
    assert read_runs(path) == list(field.runs)
    pq.write_table(pq.read_table(path).drop_columns(["seed"]), path)
    with pytest.raises(StudyError, match="no column 'seed'"):
        read_runs(path)


def test_new_runs_are_added_to_the_committed_ones_and_take_the_place_of_the_same(field):
    first, *others = field.runs
    again = replace(first, wall_time=first.wall_time + 1.0)
    both = added([again], field.runs)
    assert len(both) == len(field.runs)
    assert again in both
    assert first not in both
    assert set(others) <= set(both)


def test_runs_come_back_from_their_file(tmp_path, field):
    path = tmp_path / "runs.parquet"
    searched = replace(GOOD, evaluations=1000, spent=1000, curve_evaluations=(50, 400), curve_above=(0.25, 0.0))
    write_runs(path, [*field.runs, searched])
    assert read_runs(path) == [*field.runs, searched]
    assert searched.curve.tolist() == [[50.0, 1.25], [400.0, 1.0]]
    with pytest.raises(StudyError, match="no committed runs"):
        read_runs(tmp_path / "none.parquet")
