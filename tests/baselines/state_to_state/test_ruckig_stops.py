"""Ruckig from stop to stop: closed forms, each limit in turn, exactness."""

from dataclasses import replace

import numpy as np
import pytest

from baselines.closed_forms import rest_to_rest_time, three_limit_time, two_limit_time
from baselines.state_to_state.moves import Mover, at_rest
from baselines.state_to_state.moves import State as Passage
from baselines.state_to_state.stops import RuckigStops, ruckig_stops
from study import EndCondition, JointLimits, Problem, StudyError, judge
from study.planning import RunSettings, Status
from study.problem import State
from study.rules import Timing
from tests.helpers.reference_problems import EACH_LIMIT, INF, A, V, small, woodworking

SETTINGS = RunSettings("cubic-spline")


def test_two_limits_by_hand():
    assert two_limit_time(1.0, 10.0, 4.0) == pytest.approx(1.0)  # bang-bang: 2 sqrt(d / A)
    assert two_limit_time(-3.0, 1.0, 2.0) == pytest.approx(3.5)  # trapezoid: d / V + V / A
    assert two_limit_time(3.0, 1.0, INF) == 3.0
    assert two_limit_time(0.0, 1.0, 2.0) == 0.0


def test_three_limits_by_hand():
    assert three_limit_time(2.0, 10.0, 10.0, 1.0) == pytest.approx(4.0)  # four phases: 4 cbrt(d / 2 J)
    assert three_limit_time(6.0, 10.0, 1.0, 1.0) == pytest.approx(6.0)  # top speed 2: 2 (v / A + A / J)
    assert three_limit_time(6.0, 1.0, 2.0, 1.0) == pytest.approx(8.0)  # a = sqrt(V J): d / V + V / a + a / J
    assert three_limit_time(6.0, 2.0, 1.0, 1.0) == pytest.approx(6.0)
    assert three_limit_time(8.0, 2.0, 1.0, 1.0) == pytest.approx(7.0)
    assert three_limit_time(0.0, 2.0, 1.0, 1.0) == 0.0


def test_a_large_jerk_limit_approaches_none():
    d = np.linspace(0.01, 5, 40)
    assert three_limit_time(d, 1.0, 2.0, 1e9) == pytest.approx(two_limit_time(d, 1.0, 2.0), rel=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_ruckig_agrees_with_the_closed_forms(seed):
    rng = np.random.default_rng(seed)
    for _ in range(40):
        velocity, acceleration, jerk = 10 ** rng.uniform(-1, 1, (3, 4))
        limits = JointLimits(
            velocity, np.where(rng.random(4) < 0.7, acceleration, INF), np.where(rng.random(4) < 0.6, 10 * jerk, INF)
        )
        distance = rng.normal(size=4) * 10 ** rng.uniform(-2, 1)
        expected = rest_to_rest_time(distance, limits.rates)
        total, own = Mover(limits).times(at_rest(np.zeros(4)), at_rest(distance))
        assert own == pytest.approx(expected, rel=1e-9)
        assert total == pytest.approx(expected.max(), rel=1e-9)


def test_woodworking_takes_the_known_time():
    motion = ruckig_stops(woodworking())
    assert motion.duration == pytest.approx(4.07559, abs=5e-6)
    verdict = judge(woodworking(), motion)
    assert verdict.feasible
    assert verdict.waypoint_error.max() < 1e-12
    assert motion(motion.waypoint_times, 1) == pytest.approx(np.zeros((4, 4)), abs=1e-12)


@pytest.mark.parametrize("limits", EACH_LIMIT.values(), ids=EACH_LIMIT)
def test_each_limit_in_turn(limits):
    problem = small(limits)
    motion = ruckig_stops(problem)
    verdict = judge(problem, motion)
    assert verdict.feasible, verdict.reasons
    assert verdict.worst_ratio == pytest.approx(1.0)
    assert verdict.waypoint_error.max() < 1e-12
    steps = np.diff(problem.waypoints, axis=0)
    assert motion.duration == pytest.approx(rest_to_rest_time(steps, problem.limits.rates).max(axis=1).sum())


def test_with_velocity_limits_only_it_drives_straight_at_the_limit():
    problem = woodworking(acceleration=INF)
    motion = ruckig_stops(problem)
    assert judge(problem, motion).feasible
    assert motion.duration == pytest.approx((np.abs(np.diff(problem.waypoints, axis=0)) / V).max(axis=1).sum())


@pytest.mark.parametrize("factor", [0.1, 3.0])
def test_scaled_limits_scale_the_time(factor):
    problem = woodworking(jerk=[5.0] * 4)
    slower = Problem("slower", problem.waypoints, problem.limits.scaled(factor))
    assert ruckig_stops(slower).duration == pytest.approx(factor * ruckig_stops(problem).duration)


def test_backwards_it_takes_as_long():
    problem = small(EACH_LIMIT["all"])
    back = Problem("back", problem.waypoints[::-1], problem.limits)
    assert ruckig_stops(back).duration == pytest.approx(ruckig_stops(problem).duration)


def test_a_brake_phase_is_read_too():
    limits = JointLimits([0.8], [1.0], [5.0])
    start, end = (Passage(*np.array(row)[:, None]) for row in ([0.0, 0.79, 0.9], [1.0, 0.3, 0.0]))
    widths, cubics = Mover(limits).pieces(start, end)
    position, velocity, acceleration, jerk = cubics[-1, :, 0]
    t = widths[-1]
    assert cubics[0, :3, 0] == pytest.approx([0.0, 0.79, 0.45])
    assert position + t * (velocity + t * (acceleration + t * jerk)) == pytest.approx(1.0)
    assert velocity + t * (2 * acceleration + 3 * t * jerk) == pytest.approx(0.3)


def test_a_joint_that_dwells_takes_no_time_where_it_dwells():
    problem = Problem("dwell", [[0.0], [0.0], [1.0], [1.0]], JointLimits([1.0], [1.0]), allow_dwell=True)
    motion = ruckig_stops(problem)
    assert motion.waypoint_times.tolist() == [0.0, 0.0, 2.0, 2.0]
    assert judge(problem, motion).feasible


def test_nothing_to_move():
    still = Problem("still", [[1.0], [1.0]], JointLimits([1.0]), allow_dwell=True)
    assert RuckigStops().plan(still, SETTINGS).status is Status.NOT_APPLICABLE
    with pytest.raises(StudyError, match="nothing to move"):
        ruckig_stops(still)


def test_a_move_that_ruckig_refuses_is_a_failure_with_a_reason():
    boundless = Problem("boundless", [[0.0, 0.0], [1.0, 1.0]], JointLimits([1.0, INF]))
    plan = RuckigStops().plan(boundless, SETTINGS)
    assert plan.status is Status.FAILED
    assert "Ruckig finds no move" in plan.message


def test_the_plan():
    plan = RuckigStops().plan(woodworking(V, A), SETTINGS)
    assert plan.status is Status.FINISHED
    assert plan.motion is not None
    assert plan.motion.duration == pytest.approx(4.07559, abs=5e-6)


@pytest.mark.parametrize("limits", EACH_LIMIT.values(), ids=EACH_LIMIT)
def test_the_least_duration_is_that_of_the_motion_to_rounding(limits):
    problem = replace(small(limits), dwells={1: 0.25})
    duration = ruckig_stops(problem).duration
    assert duration * (1 - 1e-5) <= RuckigStops().least(problem) < duration


def test_the_least_duration_counts_no_move_from_a_given_rate_and_no_demanded_duration():
    problem = small(EACH_LIMIT["all"], EndCondition.SMOOTH)
    pushed = replace(problem, start=State(0.1 * np.ones(problem.n_joints), 0 * problem.waypoints[0]))
    assert RuckigStops().least(pushed) < RuckigStops().least(problem)
    assert RuckigStops().least(pushed) < ruckig_stops(pushed).duration
    assert RuckigStops().least(replace(problem, timing=Timing(exactly=99.0))) == 0.0
