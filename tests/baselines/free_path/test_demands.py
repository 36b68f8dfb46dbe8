"""Everything that a problem may demand: kept by the judge's word, and in use where it binds."""

from dataclasses import replace

import numpy as np
import pytest

from baselines.closed_forms import three_limit_time
from baselines.free_path.planner import FreePathPlanner
from study import EndCondition, JointLimits, Problem, judge, plan
from study.api import onward
from study.planning import RunSettings, Status
from study.problem import State, Timing, Tube
from study.registry import planner_named
from study.suites.tasks import arm_problems
from study.testing.stress import FEASIBLE, Attempt, endure
from tests.helpers.reference_problems import INF

SETTINGS = RunSettings("cubic-spline", time_limit=60.0)
POINTS = np.cumsum(np.random.default_rng(2).uniform(-0.5, 0.5, (6, 3)), axis=0)
JERK = JointLimits([1.5] * 3, [5.0] * 3, [50.0] * 3)
ACCELERATION = JointLimits([1.5] * 3, [5.0] * 3)
VELOCITY = JointLimits([1.5] * 3)
MIXED = JointLimits([1.5] * 3, [5.0, 5.0, INF], [50.0, INF, INF])
KINDS = pytest.mark.parametrize("limits", [JERK, ACCELERATION, MIXED], ids=["jerk", "acceleration", "mixed"])


def planned(limits, **demands):
    problem = Problem("walk", POINTS, limits, **demands)
    plan = FreePathPlanner().plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED, plan.message
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    return plan.motion


def test_limits_that_differ_by_direction_are_used_in_both():
    limits = replace(JERK, min_velocity=[-0.7] * 3, min_acceleration=[-2.0] * 3, min_jerk=[-90.0] * 3)
    motion = planned(limits)
    assert motion.extrema(1).lowest.min() == pytest.approx(-0.7, rel=1e-5)
    assert motion.extrema(2).lowest.min() == pytest.approx(-2.0, rel=1e-5)
    assert motion.extrema(2).highest.max() == pytest.approx(5.0, rel=1e-5)


def test_time_reversed_directions_take_the_same_time():
    """Run backwards, velocity changes its sign, acceleration does not, jerk does again."""
    limits = JointLimits([1.5] * 3, [5.0] * 3, [50.0] * 3, min_velocity=[-0.9] * 3, min_acceleration=[-3.0] * 3)
    back = JointLimits([0.9] * 3, [5.0] * 3, [50.0] * 3, min_velocity=[-1.5] * 3, min_acceleration=[-3.0] * 3)
    there = planned(limits).duration
    problem = Problem("back", POINTS[::-1], back)
    assert FreePathPlanner().plan(problem, SETTINGS).motion.duration == pytest.approx(there, rel=1e-4)


def halves(limits, at_the_stop):
    """Duration of the two parts of the walk, planned alone."""
    first = Problem("first", POINTS[:4], limits, start=EndCondition.REST, finish=at_the_stop)
    second = Problem("second", POINTS[3:], limits, start=at_the_stop, finish=EndCondition.REST)
    return sum(FreePathPlanner().plan(half, SETTINGS).motion.duration for half in (first, second))


@KINDS
def test_a_stop_splits_the_problem_in_two(limits):
    """Acceleration need not vanish at a stop, but must not jump there where jerk is limited."""
    whole = planned(limits, end=EndCondition.REST, stops=[3])
    held = np.flatnonzero(np.isfinite(limits.acceleration))
    assert np.abs(whole(whole.waypoint_times[3:4], 1)[0, held]).max() < 1e-9
    loose, tight = halves(limits, EndCondition.REST), halves(limits, EndCondition.SMOOTH)
    assert loose * (1 - 1e-4) <= whole.duration <= tight * (1 + 1e-4)


@KINDS
def test_a_dwell_is_spent_standing(limits):
    motion = planned(limits, dwells={2: 0.4})
    arrived = motion.waypoint_times[2]
    standing = motion(np.linspace(arrived, arrived + 0.4, 9))
    assert np.ptp(standing, axis=0).max() < 1e-12
    assert motion.duration > planned(limits).duration + 0.4


def test_moving_ends_are_met_and_change_the_duration():
    start, finish = State([0.5, -0.3, 0.2], [1.0, 0.0, 0.0]), State([-0.4, 0.1, 0.0])
    motion = planned(JERK, start=start, finish=finish)
    np.testing.assert_allclose(motion(np.zeros(1), 1)[0], start.velocity, atol=1e-9)
    np.testing.assert_allclose(motion(np.zeros(1), 2)[0], start.acceleration, atol=1e-9)
    np.testing.assert_allclose(motion(np.array([motion.duration]), 1)[0], finish.velocity, atol=1e-9)


def test_a_piece_of_a_fastest_motion_is_a_fastest_motion():
    whole = planned(JERK, end=EndCondition.SMOOTH)
    at = whole.waypoint_times[2:3]
    rest = Problem("rest", POINTS[2:], JERK, start=State(whole(at, 1)[0], whole(at, 2)[0]), finish=EndCondition.SMOOTH)
    plan = FreePathPlanner().plan(rest, SETTINGS)
    assert judge(rest, plan.motion).feasible
    assert plan.motion.duration == pytest.approx(whole.duration - at[0], rel=1e-4)


def test_different_ends_lie_between_equal_ones():
    loose, tight = (planned(JERK, end=end).duration for end in (EndCondition.FREE, EndCondition.SMOOTH))
    mixed = planned(JERK, start=EndCondition.SMOOTH, finish=EndCondition.FREE).duration
    assert loose < mixed < tight


@pytest.mark.parametrize("limits", [JERK, ACCELERATION], ids=["jerk", "acceleration"])
def test_limits_of_one_segment_bind_there(limits):
    slow = replace(limits, velocity=[0.3] * 3, min_velocity=[-0.3] * 3)
    motion = planned(limits, segment_limits={1: slow})
    part = motion.between(*motion.waypoint_times[1:3])
    assert part.extrema(1).peak.max() == pytest.approx(0.3, rel=1e-5)
    assert motion.extrema(1).peak.max() > 1.0


@pytest.mark.parametrize("limits", [JERK, ACCELERATION, VELOCITY], ids=["jerk", "acceleration", "velocity"])
def test_a_tolerance_is_used_to_its_end(limits):
    motion = planned(limits, tolerance=0.02)
    errors = np.abs(motion(motion.waypoint_times) - POINTS)
    assert errors.max() == pytest.approx(0.02, rel=1e-4)
    assert motion.duration < planned(limits).duration


def test_a_tolerance_at_the_target_shortens_a_straight_move_by_as_much():
    problem = Problem("line", [[0.0], [0.5]], JointLimits([1.5], [5.0], [50.0]), EndCondition.SMOOTH, tolerance=0.01)
    plan = FreePathPlanner().plan(problem, SETTINGS)
    assert plan.motion.duration == pytest.approx(float(three_limit_time(0.48, 1.5, 5.0, 50.0)), rel=1e-5)


@KINDS
def test_a_range_that_ends_at_the_waypoints_is_kept(limits):
    low, high = POINTS.min(axis=0), POINTS.max(axis=0)
    motion = planned(replace(limits, lower=low, upper=high))
    assert motion.duration >= planned(limits).duration * (1 - 1e-6)


@pytest.mark.parametrize("limits", [JERK, ACCELERATION], ids=["jerk", "acceleration"])
@pytest.mark.parametrize("radius", [0.04, [0.04, 0.04, 0.5]], ids=["all joints", "two joints"])
def test_a_tube_costs_time_and_less_than_straight_lines(limits, radius):
    free, inside = planned(limits), planned(limits, path=Tube(radius))
    problem = Problem("walk", POINTS, limits, path=Tube(radius))
    assert "leaves the tube" in judge(problem, free).reasons[0]
    lines = planner_named("straight").plan(problem, SETTINGS).motion
    assert free.duration < inside.duration < lines.duration


def test_a_wide_tube_costs_nothing():
    assert planned(JERK, path=Tube(1.0)).duration == pytest.approx(planned(JERK).duration, rel=1e-6)


def test_a_tube_keeps_stops_dwells_tolerances_and_limits_of_segments():
    slow = {1: JointLimits([0.4] * 3, [3.0] * 3, [30.0] * 3)}
    motion = planned(JERK, path=Tube(0.05), stops=[3], dwells={2: 0.3}, tolerance=0.01, segment_limits=slow)
    assert motion.between(*motion.waypoint_times[1:3]).extrema(1).peak.max() == pytest.approx(0.4, rel=1e-4)


@pytest.mark.parametrize(
    ("timing", "duration"),
    [(Timing(at_least=4.0), 4.0), (Timing(exactly=2.1), 2.1), (Timing(cycle=0.05), 2.05)],
    ids=["with a stop", "without one", "cycles"],
)
def test_a_motion_with_moving_ends_lasts_as_long_as_demanded(timing, duration):
    start = State([0.4, 0.1, -0.2], [1.0, 0.0, 0.0])
    assert planned(JERK, start=start).duration < duration
    assert planned(JERK, start=start, timing=timing).duration == pytest.approx(duration, rel=1e-9)


def test_too_short_a_duration_between_moving_ends_is_a_reason():
    problem = Problem("walk", POINTS, JERK, start=State([0.4, 0.1, -0.2]), timing=Timing(exactly=1.0))
    plan = FreePathPlanner().plan(problem, SETTINGS)
    assert plan.status is Status.FAILED
    assert "longer than the 1 s it must take" in plan.message


@pytest.mark.parametrize("jerk", [np.inf, 10.0])
def test_a_joint_between_equal_waypoints_moves_where_the_start_pushes_it(jerk):
    limits = JointLimits(np.ones(2), 2 * np.ones(2), np.full(2, jerk))
    start = State(velocity=np.array([0.2, 0.1]))
    problem = Problem("pushed", np.array([[0.0, 0.3], [1.0, 0.3], [0.5, 0.3]]), limits, start=start)
    motion = FreePathPlanner().plan(problem, SETTINGS).motion
    assert judge(problem, motion).feasible
    assert motion(np.zeros(1), 1)[0, 1] == pytest.approx(0.1)


def test_a_motion_that_misses_a_limit_by_a_hair_is_planned_again_with_less_room():
    assert endure(Attempt("free-path", 18, 434, 20.0)).kind == FEASIBLE


def test_the_first_phase_alone_keeps_a_range_that_is_narrow_beside_the_other_joints_moves():
    attempt = Attempt("free-path-first", 18, 380, 20.0)  # a joint that moves 0.4 mrad while another one moves 2 krad
    assert endure(attempt).kind == FEASIBLE


@pytest.mark.filterwarnings("error")
def test_a_slack_that_vanishes_says_nothing_on_the_screen():
    problem = next(problem for problem in arm_problems(1) if problem.name == "ur5e-rand20")
    motion = plan(problem, "fast").motion
    at = 0.65 * motion.duration
    following = int(np.searchsorted(motion.waypoint_times, at))
    asked = onward(problem, motion, at, problem.waypoints[following : following + 5])
    assert plan(asked, "fast").feasible
