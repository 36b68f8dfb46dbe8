"""The free-path planner: optimal where optima are known, feasible for every mixture of limits, never above the NLP."""

from functools import cache

import numpy as np
import pytest

from baselines.closed_forms import three_limit_time, two_limit_time
from baselines.free_path.phases import FEWEST, USUAL, usual_pieces
from baselines.free_path.planner import FreePathPlanner
from baselines.free_path.question import of
from study import EndCondition, JointLimits, Problem, StudyError, judge
from study.bench.planner_parts import smooth
from study.deadline import Deadline
from study.planning import RunSettings, Status
from tests.helpers.reference_problems import EACH_LIMIT, INF, small, woodworking

SETTINGS = RunSettings("cubic-spline", time_limit=60.0)


def planned(problem, pieces=8):
    plan = FreePathPlanner(pieces).plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED, plan.message
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    return plan.motion


def line(distance, *limits):
    return Problem("line", [[0.0], [distance]], JointLimits(*([limit] for limit in limits)), end=EndCondition.SMOOTH)


@pytest.mark.parametrize("distance", [0.001, 0.02, 0.5, 3.0, 10.0])
def test_the_minimum_time_from_rest_to_rest_is_met(distance):
    exact = float(three_limit_time(distance, 1.5, 5.0, 50.0))
    assert planned(line(distance, 1.5, 5.0, 50.0)).duration == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("distance", [0.001, 0.2, 10.0])
def test_so_is_the_minimum_time_without_a_jerk_limit(distance):
    exact = float(two_limit_time(distance, 1.5, 5.0))
    assert planned(line(distance, 1.5, 5.0, INF)).duration == pytest.approx(exact, rel=1e-6)


def test_a_velocity_limit_alone_gives_the_straight_line():
    motion = planned(woodworking(acceleration=INF))
    steps = np.abs(np.diff(woodworking().waypoints, axis=0)) / woodworking().limits.velocity
    assert motion.duration == pytest.approx(steps.max(axis=1).sum(), rel=1e-6)


@pytest.mark.parametrize("end", list(EndCondition))
@pytest.mark.parametrize("limits", EACH_LIMIT.values(), ids=EACH_LIMIT)
def test_each_limit_in_turn_is_reached_and_kept(limits, end):
    problem = small(limits, end)
    verdict = judge(problem, planned(problem))
    assert verdict.worst_ratio == pytest.approx(1.0, abs=1e-5)
    assert verdict.waypoint_error.max() < 1e-12


def test_looser_ends_are_faster():
    smooth, rest, free = (
        planned(small(EACH_LIMIT["all"], end)).duration
        for end in (EndCondition.SMOOTH, EndCondition.REST, EndCondition.FREE)
    )
    assert smooth > rest > free


@cache
def mixed():
    """Joints of every kind: jerk-limited, acceleration-limited, velocity-limited, without limits, and one that stands."""
    points = np.random.default_rng(11).uniform(-1, 1, (6, 5))
    points[:, 4] = 0.7
    limits = JointLimits([1.0, 1.2, 2.0, INF, 1.0], [3.0, 4.0, INF, INF, 2.0], [20.0, INF, INF, INF, 9.0])
    return Problem("mixed", points, limits)


def test_joints_of_all_kinds_share_one_problem():
    motion = planned(mixed())
    assert judge(mixed(), motion).worst_ratio == pytest.approx(1.0, abs=1e-6)
    assert np.ptp(motion(np.linspace(0, motion.duration, 50))[:, 4]) == 0.0


@pytest.mark.parametrize("noise", [1e-6, 1e-5, 1e-4, 1e-3])
def test_a_joint_that_hardly_moves_costs_nothing(noise):
    rng = np.random.default_rng(3)
    points = np.cumsum(rng.uniform(-0.5, 0.5, (8, 3)), axis=0)
    limits = JointLimits([1.5] * 3, [5.0] * 3, [50.0] * 3)
    points[:, 1] = 0.4
    still = planned(Problem("still", points, limits)).duration
    points[:, 1] += noise * rng.uniform(-1, 1, 8)
    assert planned(Problem("noise", points, limits)).duration == pytest.approx(still, rel=2e-4)


def test_a_range_of_positions_is_held_and_touched():
    points = np.array([[0.0, 0.0], [0.9, 0.5], [0.95, -0.5], [0.0, 0.0]])
    free = Problem("free", points, JointLimits([2.0] * 2, [5.0] * 2, [40.0] * 2))
    tight = Problem("tight", points, JointLimits([2.0] * 2, [5.0] * 2, [40.0] * 2, lower=[-2, -2], upper=[0.96, 2]))
    before, after = planned(free), planned(tight)
    assert before.extrema(0).highest[0] > 0.97
    assert after.extrema(0).highest[0] == pytest.approx(0.96, abs=1e-4)
    assert before.duration < after.duration < 1.05 * before.duration


def test_scaled_limits_scale_the_time_and_permuted_joints_change_nothing():
    problem = small(EACH_LIMIT["all"])
    order = [2, 0, 1]
    limits = JointLimits(*(rate[order] for rate in problem.limits.rates)).scaled(100.0)
    other = Problem("other", problem.waypoints[:, order] + 5.0, limits, problem.end)
    assert planned(other).duration == pytest.approx(100 * planned(problem).duration, rel=1e-4)


def test_out_of_time_is_said():
    problem = small(EACH_LIMIT["all"], n_waypoints=12)
    plan = FreePathPlanner().plan(problem, RunSettings("cubic-spline", time_limit=1e-4))
    assert plan.status in (Status.TIMED_OUT, Status.FAILED)


def test_nothing_to_move_is_not_applicable():
    still = Problem("still", [[1.0], [1.0]], JointLimits([1.0]), allow_dwell=True)
    assert FreePathPlanner().plan(still, SETTINGS).status is Status.NOT_APPLICABLE


def test_too_few_pieces_are_refused():
    with pytest.raises(StudyError, match="at least 3, got 2"):
        FreePathPlanner(2)


def dense(n_waypoints, limits):
    """A smooth path of three joints, as so many points."""
    s = np.linspace(0, 1, n_waypoints)[:, None]
    points = np.concatenate([np.sin(5 * s), s * np.cos(4 * s), np.exp(s) * np.sin(3 * s + 1)], axis=1)
    return Problem("dense", points, limits, end=EndCondition.SMOOTH)


@pytest.mark.parametrize("jerk", [50.0, INF])
def test_a_smooth_path_costs_the_same_in_however_many_points(jerk):
    limits = JointLimits([1.5] * 3, [5.0] * 3, [jerk] * 3)
    few, many = (planned(dense(n, limits), pieces=None).duration for n in (50, 400))
    assert few <= many * (1 + 1e-6)
    assert many <= 1.01 * few


def test_close_order_takes_few_pieces_and_a_wild_walk_many():
    limits = JointLimits([1.5] * 3, [5.0] * 3, [50.0] * 3)
    wild = Problem("wild", np.random.default_rng(1).uniform(-1, 1, (120, 3)), limits)
    assert usual_pieces(of(dense(120, limits)))[0] == FEWEST
    assert usual_pieces(of(wild)) == usual_pieces(of(small(EACH_LIMIT["all"]))) == (USUAL, None)


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e-4, 1e-3])
def test_a_joint_that_trembles_costs_nothing(size):
    """Equal pieces, as `free-path-nlp` has them, cost three parts in a thousand here once the joint counts as moving."""
    steps, rng = np.arange(8), np.random.default_rng(5)
    waves = np.column_stack([np.sin(0.9 * steps), np.cos(0.7 * steps) + 0.2 * steps, np.full(8, 0.3)])
    limits = JointLimits([2.0] * 3, [6.0] * 3, [40.0] * 3)
    noisy = waves + np.outer(rng.uniform(-size, size, 8), [0.0, 0.0, 1.0])
    quiet, trembling = (FreePathPlanner().plan(Problem("seam", p, limits), SETTINGS).motion for p in (waves, noisy))
    assert trembling.duration <= 1.0002 * quiet.duration


def test_a_late_motion_of_a_dense_path_is_near_its_optimum_and_not_the_stops(monkeypatch):
    problem = smooth(120, 0)
    best = FreePathPlanner().plan(problem, RunSettings("cubic-spline")).motion.duration
    monkeypatch.setattr(Deadline, "passed", lambda deadline: True)
    late = FreePathPlanner().plan(problem, RunSettings("cubic-spline"))
    assert late.status is Status.TIMED_OUT
    assert judge(problem, late.motion).feasible
    assert late.motion.duration < 2.5 * best
