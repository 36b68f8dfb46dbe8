from dataclasses import replace

import numpy as np
import pytest

from study.analysis.case_summary import summarise, summarise_case
from study.analysis.methods import Kind
from study.curves import curve_named
from study.judge import judge
from study.planning import Freedom, Status
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
        made = Result(status, motion, None, 100, 5, message=message, cell=cell, verdict=verdict, wall_time=0.5)
        return replace(made, **changes)

    return build


def find(methods, label):
    return next(method for method in methods if method.label == label)


def test_medians_gaps_and_representatives_are_over_feasible_runs(tiny_case, result):
    runs = [result("pso", [k, k, k], seed) for seed, k in enumerate((3.0, 2.6, 4.0, 0.1))]
    methods = summarise_case(tiny_case, [*runs, result("ruckig-stops", [2.6, 2.6, 2.6], evaluations=0)]).methods
    method = find(methods, "pso")
    assert (method.runs, method.feasible_runs, method.best, method.median, method.duration) == (
        4,
        3,
        pytest.approx(7.8),
        9.0,
        9.0,
    )
    assert method.representative is runs[0]
    assert method.worst_ratio == max(run.verdict.worst_ratio for run in runs[:3])
    assert method.reason.startswith("1 of 4 runs: ")
    best = find(methods, "published: split").median  # 2.5 s for each of three segments
    assert method.gap == pytest.approx(9.0 / best - 1.0)
    assert find(methods, "published: split").gap == 0.0
    assert (method.kind, method.freedom) == (Kind.SEARCH, Freedom.CURVE)
    assert (find(methods, "ruckig-stops").kind, find(methods, "ruckig-stops").freedom) == (
        Kind.DETERMINISTIC,
        Freedom.FREE,
    )


def test_infeasible_rows_stand_below_with_their_reason_and_are_never_hidden(tiny_case, result):
    methods = summarise_case(
        tiny_case,
        [
            result("pso", [0.1, 0.1, 0.1]),
            result("smwoa", None, message="no motion"),
            result("golds-pso", [4.0, 4.0, 4.0]),
        ],
    ).methods
    comparable = [method for method in methods if method.joint is None]
    feasible = [method.feasible for method in comparable]
    assert feasible == sorted(feasible, reverse=True)
    durations = [method.median for method in comparable if method.feasible]
    assert durations == sorted(durations)
    assert "of its limit" in find(methods, "pso").reason
    assert find(methods, "pso").gap is None
    assert find(methods, "pso").duration == pytest.approx(0.3)
    assert find(methods, "smwoa").reason == "no motion"
    assert find(methods, "smwoa").duration is None


def test_the_least_infeasible_run_represents_an_infeasible_row(tiny_case, result):
    runs = [result("pso", [0.1, 0.1, 0.1], 0), result("pso", None, 1), result("pso", [0.4, 0.4, 0.4], 2)]
    method = find(summarise_case(tiny_case, runs).methods, "pso")
    assert method.representative is runs[2]
    assert method.worst_ratio == runs[0].verdict.worst_ratio


def test_published_rows_are_judged_joint_by_joint_and_put_together(tiny_case):
    methods = {method.label: method for method in summarise_case(tiny_case, ()).methods}
    assert set(methods) == {
        f"published: {name}" for name in ("slow", "fast", "silent", "split", "split, joint 1", "split, joint 2")
    }
    assert methods["published: slow"].feasible
    assert (methods["published: slow"].claimed, methods["published: slow"].reason) == (9.0, "")
    assert not methods["published: fast"].feasible
    assert "of its limit" in methods["published: fast"].reason
    assert methods["published: silent"].judged_duration is None
    assert methods["published: silent"].reason.startswith("the paper prints no segment durations (Section 2)")
    assert methods["published: split"].representative.durations.tolist() == [2.5, 2.5, 2.5]
    assert methods["published: split, joint 2"].joint == 1
    assert methods["published: split, joint 2"].duration == pytest.approx(4.5)


def test_single_joints_stand_last_and_take_no_part_in_gaps(tiny_case, result):
    methods = summarise_case(tiny_case, [result("pso", [4.0, 4.0, 4.0])]).methods
    assert [method.joint is not None for method in methods] == sorted(method.joint is not None for method in methods)
    assert all(method.gap is None for method in methods if method.joint is not None)


def test_every_case_gets_rows_in_the_order_given(tiny_case, spline_case, result):
    empty, full = summarise({"tiny-spline": spline_case, "tiny": tiny_case}, [result("pso", [3.0, 3.0, 3.0])])
    assert (empty.case.name, empty.methods, empty.ran) == ("tiny-spline", (), False)
    assert (full.case.name, full.ran) == ("tiny", True)
    assert find(full.methods, "pso").runs == 1


def test_results_of_a_planner_that_is_gone_are_still_shown(tiny_case, result):
    method = find(summarise_case(tiny_case, [result("gone-planner", [3.0, 3.0, 3.0])]).methods, "gone-planner")
    assert (method.kind, method.freedom, method.feasible) == (Kind.SEARCH, Freedom.CURVE, True)
