"""One B-spline through the waypoints: feasible by its hull, at its limits by the judge, and close to Ruckig's way through the waypoints."""

from dataclasses import replace

import numpy as np
import pytest

from baselines.bounds.lower_bounds import lower_bound
from baselines.free_path.bspline_nlp import (
    BSplineNlp,
    Shape,
    SplineProgram,
    derivative_matrix,
    first_shape,
    knots_of,
)
from baselines.state_to_state.via import ruckig_via
from study import EndCondition, JointLimits, Problem, judge
from study.planning import RunSettings, Status
from study.testing import check_planner
from tests.helpers.reference_problems import EACH_LIMIT, INF, small, woodworking

SETTINGS = RunSettings("cubic-spline")
JERK = EACH_LIMIT["all"]
BINDING = {
    name: limits for name, limits in EACH_LIMIT.items() if np.isfinite(limits[1]).any() or np.isfinite(limits[2]).any()
}


def solved(problem, most=18):
    plan = BSplineNlp(most=most).plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED, plan.message
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    return plan.motion, verdict


def test_the_motion_is_the_spline():
    rng = np.random.default_rng(0)
    control, passed = rng.normal(size=(12, 2)), np.array([0.0, 0.31, 3 / 7, 1.0])
    motion = Shape(control, passed, 2.5).motion()
    assert motion.waypoint_times == pytest.approx(2.5 * passed)
    assert motion(0.0)[0] == pytest.approx(control[0])
    assert motion(2.5)[0] == pytest.approx(control[-1])
    for order in range(5):
        size = motion.extrema(order).peak.max()
        assert np.abs(motion.jumps(order)).max() < 1e-9 * size
    assert len(motion.knots) == 9  # seven spans, one of them cut in two


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_derivative_stays_in_the_hull_of_its_control_points(order):
    control = np.random.default_rng(order).normal(size=(14, 1))
    hull = derivative_matrix(9, order) @ control
    peaks = Shape(control, np.array([0.0, 1.0]), 1.0).motion().extrema(order)
    assert len(hull) == 14 - order
    rounding = 1e-12 * np.abs(hull).max()
    assert hull.min() - rounding <= peaks.lowest[0] < peaks.highest[0] <= hull.max() + rounding


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))])
def test_above_the_lower_bound_and_close_to_ruckig(seed):
    problem = small(JERK, seed=seed, n_waypoints=5)
    motion, verdict = solved(problem, most=24)
    assert verdict.waypoint_error.max() < 1e-8
    assert verdict.worst_ratio == pytest.approx(1.0, abs=1e-9)
    fastest = ruckig_via(problem, pieces=4)[0].duration
    assert motion.duration >= lower_bound(problem)
    assert fastest <= 1.001 * motion.duration
    assert motion.duration <= 1.05 * fastest


@pytest.mark.parametrize("end", list(EndCondition))
@pytest.mark.parametrize("limits", BINDING.values(), ids=BINDING)
def test_each_limit_in_turn_under_every_end_condition(limits, end):
    problem = small(limits, end)
    _, verdict = solved(problem, most=9)
    assert verdict.worst_ratio == pytest.approx(1.0, abs=1e-9)


def test_a_smooth_end_rests_without_acceleration():
    motion, verdict = solved(small(JERK, EndCondition.SMOOTH))
    assert np.abs(verdict.end_velocity).max() < 1e-9
    assert np.abs(verdict.end_acceleration).max() < 1e-8
    at_rest, _ = solved(small(JERK, EndCondition.REST))
    moving, _ = solved(small(JERK, EndCondition.FREE))
    assert moving.duration < at_rest.duration < motion.duration


def test_looser_limits_scale_the_motion():
    problem = small(JERK)
    factor = 1.7
    slower = replace(problem, limits=problem.limits.scaled(factor))
    assert solved(slower)[0].duration == pytest.approx(factor * solved(problem)[0].duration, rel=1e-5)


def test_more_spans_are_not_slower():
    durations = [solved(small(JERK), most)[0].duration for most in (9, 18, 36)]
    assert durations == sorted(durations, reverse=True)


def test_the_hull_gives_away_what_the_stretch_takes_back():
    """One joint, two waypoints, few spans: the control points keep farther from the limit than the curve."""
    problem = Problem("two", [[0.0], [1.0]], JointLimits([1.0], [9.0]))
    shape, _ = SplineProgram(problem, 1).solve(first_shape(problem, 1, 5.0), 5.0)
    assert judge(problem, shape.motion()).least_scale < 0.95
    assert len(knots_of(1)) == 12


def test_a_joint_that_does_not_move_and_no_inner_waypoint():
    problem = Problem("two", [[0.0, 2.0], [1.0, 2.0]], JointLimits([1.0, 1.0], [2.0, 2.0], [9.0, 9.0]))
    motion, verdict = solved(problem)
    assert verdict.peaks[0, 1] == 0
    assert motion.duration >= lower_bound(problem)


def test_the_same_answer_twice():
    first, second = (solved(small(JERK), 9)[0] for _ in range(2))
    assert first.coefficients.tolist() == second.coefficients.tolist()


def test_what_it_does_not_apply_to():
    plan = BSplineNlp().plan(woodworking(acceleration=INF), SETTINGS)
    assert plan.status is Status.NOT_APPLICABLE
    assert "no joint has an acceleration or jerk limit" in plan.message
    still = Problem("still", [[1.0], [1.0]], JointLimits([1.0], [1.0]), allow_dwell=True)
    assert "nothing to move" in BSplineNlp().plan(still, SETTINGS).message


@pytest.mark.slow
def test_it_keeps_the_contract_of_planners():
    check_planner(BSplineNlp(most=9))
