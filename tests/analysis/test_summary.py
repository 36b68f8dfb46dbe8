from dataclasses import replace

import numpy as np
import pytest

from study.analysis.methods import CURVE, FREE_PATH, case_rows, published_rows, summarise
from study.curves import curve_named
from study.judge import judge
from study.planning import Status
from study.store.results import Cell, Result


@pytest.fixture
def result(tiny_case):
    """Build a result from segment durations; None for a failure."""

    def build(label, durations, seed=0, message="", **changes):
        settings = replace(tiny_case.settings, seed=seed)
        cell = Cell("tiny", label.partition(":")[0], label, settings)
        motion = (
            None
            if durations is None
            else curve_named("poly353").motion(tiny_case.problem.waypoints, np.array(durations))
        )
        verdict = None if motion is None else judge(tiny_case.problem, motion)
        status = Status.FAILED if motion is None else Status.FINISHED
        made = Result(cell, status, message, motion, verdict, None, 100, 5, np.empty((0, 2)), {}, 0.5)
        return replace(made, **changes)

    return build


def find(rows, label):
    return next(row for row in rows if row.label == label)


def test_medians_gaps_and_representatives_are_over_feasible_runs(tiny_case, result):
    runs = [result("pso", [k, k, k], seed) for seed, k in enumerate((3.0, 2.6, 4.0, 0.1))]
    rows = case_rows(tiny_case, [*runs, result("ruckig-stops", [2.6, 2.6, 2.6], evaluations=0)])
    row = find(rows, "pso")
    assert (row.runs, row.feasible_runs, row.best, row.median, row.duration) == (4, 3, pytest.approx(7.8), 9.0, 9.0)
    assert row.representative is runs[0]
    assert row.worst_ratio == max(run.verdict.worst_ratio for run in runs[:3])
    assert row.reason.startswith("1 of 4 runs: ")
    best = find(rows, "published: split").median  # 2.5 s for each of three segments
    assert row.gap == pytest.approx(9.0 / best - 1.0)
    assert find(rows, "published: split").gap == 0.0
    assert (row.kind, row.path) == ("search", CURVE)
    assert (find(rows, "ruckig-stops").kind, find(rows, "ruckig-stops").path) == ("deterministic", FREE_PATH)


def test_infeasible_rows_stand_below_with_their_reason_and_are_never_hidden(tiny_case, result):
    rows = case_rows(
        tiny_case,
        [
            result("pso", [0.1, 0.1, 0.1]),
            result("smwoa", None, message="no motion"),
            result("golds-pso", [4.0, 4.0, 4.0]),
        ],
    )
    comparable = [row for row in rows if row.joint is None]
    feasible = [row.feasible for row in comparable]
    assert feasible == sorted(feasible, reverse=True)
    durations = [row.median for row in comparable if row.feasible]
    assert durations == sorted(durations)
    assert "of its limit" in find(rows, "pso").reason
    assert find(rows, "pso").gap is None
    assert find(rows, "pso").duration == pytest.approx(0.3)
    assert find(rows, "smwoa").reason == "no motion"
    assert find(rows, "smwoa").duration is None


def test_the_least_infeasible_run_represents_an_infeasible_row(tiny_case, result):
    runs = [result("pso", [0.1, 0.1, 0.1], 0), result("pso", None, 1), result("pso", [0.4, 0.4, 0.4], 2)]
    row = find(case_rows(tiny_case, runs), "pso")
    assert row.representative is runs[2]
    assert row.worst_ratio == runs[0].verdict.worst_ratio


def test_published_rows_are_judged_joint_by_joint_and_put_together(tiny_case):
    rows = {row.label: row for row in published_rows(tiny_case)}
    assert set(rows) == {
        f"published: {name}" for name in ("slow", "fast", "silent", "split", "split, joint 1", "split, joint 2")
    }
    assert rows["published: slow"].feasible
    assert rows["published: slow"].claimed == 9.0
    assert not rows["published: fast"].feasible
    assert "of its limit" in rows["published: fast"].reason
    assert rows["published: silent"].duration is None
    assert rows["published: silent"].reason.startswith("the paper prints no segment durations (Section 2)")
    assert rows["published: split"].representative.durations.tolist() == [2.5, 2.5, 2.5]
    assert rows["published: split, joint 2"].joint == 1
    assert rows["published: split, joint 2"].duration == pytest.approx(4.5)


def test_single_joints_stand_last_and_take_no_part_in_gaps(tiny_case, result):
    rows = case_rows(tiny_case, [result("pso", [4.0, 4.0, 4.0])])
    assert [row.joint is not None for row in rows] == sorted(row.joint is not None for row in rows)
    assert all(row.gap is None for row in rows if row.joint is not None)


def test_every_case_gets_rows_in_the_order_given(tiny_case, spline_case, result):
    rows = summarise({"tiny-spline": spline_case, "tiny": tiny_case}, [result("pso", [3.0, 3.0, 3.0])])
    assert list(dict.fromkeys(row.case for row in rows)) == ["tiny"]
    assert find(rows, "pso").runs == 1


def test_results_of_a_planner_that_is_gone_are_still_shown(tiny_case, result):
    row = find(case_rows(tiny_case, [result("gone-planner", [3.0, 3.0, 3.0])]), "gone-planner")
    assert (row.kind, row.path, row.feasible) == ("search", "", True)
