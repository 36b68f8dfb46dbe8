"""Limits of torque and of the tool: what the judge proves of them, and how motions are slowed down to them."""

from dataclasses import replace

import numpy as np
import pytest

from study import JointLimits, Problem, StudyError, Trajectory, judge
from study.arm import ArmLimits
from study.arm_findings import ROUNDS, enclosed
from study.cautions import unbounded_joints
from study.curves import CURVES
from study.demands import ARM, Demand, refusal
from study.parametric import ParametricTrajectory
from study.planning import Plan, Status
from study.problem import State
from study.slowing import fitted, slow_down, told
from study.tolerances import ENCLOSED
from study.trajectory import Motion
from tests.helpers.arms import G, lift, pendulum, random_arm, two_links

POINTS = np.array([[0.0, 0.1], [0.5, 0.5], [0.2, 0.9], [0.9, 0.4]])
LIMITS = JointLimits([2.5, 2.2], [9.0, 9.0])


def walk(**arm):
    return Problem("walk", POINTS, LIMITS, arm=ArmLimits(two_links(), **arm))


def curve(duration=0.8, family="cubic-spline"):
    return CURVES[family].motion(POINTS, np.full(3, duration))


def rise(duration=1.0, height=1.0):
    """Rest to rest over a height: 3s^2 - 2s^3; accelerations +-6 h/T^2 at the ends."""
    return Trajectory(
        [0.0, duration],
        (height * np.array([0, 0, 3.0, -2.0]) / duration ** np.arange(4))[None, :, None],
        [0.0, duration],
    )


def test_a_lift_is_judged_by_its_closed_form():
    problem = Problem("lift", [[0.0], [1.0]], JointLimits([9.0], [90.0]), arm=ArmLimits(lift(5.0), [5.0 * (G + 6.0)]))
    verdict = judge(problem, rise())
    assert verdict.feasible
    assert verdict.arm_shares[:, 0] == pytest.approx([1.0, 1.0], rel=1e-6)
    assert verdict.arm_times[0] == 0.0
    tight = replace(problem, arm=ArmLimits(lift(5.0), [5.0 * (G + 5.9)]))
    broken = judge(tight, rise())
    assert [reason.split(" reaches")[0] for reason in broken.reasons] == ["torque of joint 1"]
    assert broken.violation == pytest.approx((G + 6.0) / (G + 5.9) - 1, rel=1e-3)
    assert slow_down(tight.arm, rise()) == pytest.approx(np.sqrt(6.0 / 5.9), rel=1e-4)


def test_the_tool_of_a_pendulum_is_judged_by_its_closed_form():
    arm, motion = pendulum(2.0, 0.5), rise()
    found = enclosed(ArmLimits(arm, tool_speed=1.0, tool_acceleration=10.0), motion)
    t = np.linspace(0, 1, 100_001)
    speed, rate = 6 * t - 6 * t**2, 6 - 12 * t
    exact = [0.5 * 1.5 / 1.0, 0.5 * np.hypot(rate, speed**2).max() / 10.0]
    assert (found.lowest[1:] <= np.array(exact) * (1 + 1e-9)).all()
    assert (found.highest[1:] >= exact).all()
    np.testing.assert_allclose(found.highest[1:], exact, rtol=2 * ENCLOSED)
    assert found.lowest[0] == found.highest[0] == 0.0


@pytest.mark.parametrize("family", ["cubic-spline", "bspline-parametric", "poly353"])
def test_bounds_hold_between_samples_and_are_narrow(family):
    family = family if family in CURVES else "cubic-spline"
    motion, rng = curve(family=family), np.random.default_rng(0)
    for arm in (two_links(), random_arm(rng, 2)):
        arm = replace(arm, coulomb=np.zeros(2))
        instants = np.linspace(0, motion.duration, 4001)
        rates = [motion(instants, order) for order in range(3)]
        limits = ArmLimits(arm, [30.0, 9.0], 0.9, 4.0)
        tool = [np.linalg.norm(rate, axis=1).max() for rate in arm.tool_rates(*rates)]
        sampled = np.array([*np.abs(arm.torque(*rates)).max(axis=0) / [30.0, 9.0], tool[0] / 0.9, tool[1] / 4.0])
        found = enclosed(limits, motion)
        assert (found.highest >= sampled * (1 - 1e-12)).all()
        assert (found.highest <= found.lowest * (1 + ENCLOSED) + 1e-12).all()
        np.testing.assert_allclose(found.lowest, sampled, rtol=1e-3)


def test_a_motion_given_by_time_and_place_is_enclosed_like_the_same_one_in_time():
    motion = curve()
    unit = motion.coefficients * np.diff(motion.knots)[:, None, None] ** np.arange(4)[:, None]
    time = np.column_stack([motion.knots[:-1], np.diff(motion.knots), np.zeros((3, 2))])
    same = ParametricTrajectory(time, unit)
    limits = ArmLimits(two_links(), [30.0, 9.0], 0.9, 4.0)
    np.testing.assert_allclose(enclosed(limits, same).highest, enclosed(limits, motion).highest, rtol=1e-9)
    uneven = ParametricTrajectory(time + np.array([0, 0, 0.1, 0.05]), unit)
    found, instants = enclosed(limits, uneven), np.linspace(0, uneven.duration, 2001)
    torque = two_links().torque(*(uneven(instants, order) for order in range(3)))
    shares = np.abs(torque).max(axis=0) / [30.0, 9.0]
    assert (found.highest[:2] >= shares).all()
    np.testing.assert_allclose(found.highest[:2], shares, rtol=2e-3)


def test_dry_friction_counts_against_the_direction_of_the_motion():
    arm = lift(1.0, coulomb=[2.0])
    up = enclosed(ArmLimits(arm, [20.0]), rise())
    assert up.highest[0] == pytest.approx((G + 6 + 2) / 20, rel=1e-3)
    down = enclosed(ArmLimits(arm, [20.0]), rise(height=-1.0))
    assert down.highest[0] == pytest.approx((G + 6 - 2) / 20, rel=1e-3)


def test_what_is_not_proved_is_not_feasible(monkeypatch):
    problem = walk(torque=[60.0, 20.0])
    assert judge(problem, curve()).feasible
    monkeypatch.setattr("study.arm_findings.ROUNDS", 1)
    assert ROUNDS > 1
    near = enclosed(problem.arm, curve())
    tight = walk(torque=problem.arm.torque * near.lowest[:2] * 1.0001)
    assert "not proved to keep its limit" in judge(tight, curve()).reasons[0]


def test_a_motion_of_a_strange_kind_is_not_proved():
    class Strange(Motion):
        n_joints = 2

    assert np.isinf(enclosed(walk(tool_speed=1.0).arm, Strange()).highest).all()
    assert enclosed(None, Strange()).highest.tolist() == [0.0] * 4


def test_planners_that_do_not_know_the_arm_are_slowed_down_and_say_so():
    problem = walk(torque=[45.0, 12.0], tool_speed=0.6)
    assert {Demand.TORQUE, Demand.TOOL_SPEED} <= problem.demands
    assert not problem.planner_demands & ARM

    class Deaf:
        knows = frozenset({Demand.VELOCITY})

    assert told(Deaf, problem).arm is None
    plan = fitted(problem, Plan(Status.FINISHED, motion=curve(0.4), durations=np.full(3, 0.4)))
    assert "slowed down by" in plan.message
    verdict = judge(replace(problem, limits=JointLimits([9.0, 9.0])), plan.motion)
    assert max(verdict.arm_shares[1]) <= 1 + 1e-6
    assert max(verdict.arm_shares[0]) >= 0.999, "it could run faster"
    assert plan.details["slowed"] == pytest.approx(plan.durations[0] / 0.4)
    moving = replace(problem, start=State([0.3, -0.2]))
    assert refusal(moving.planner_demands, frozenset({Demand.MOVING_ENDS})).startswith(
        "the planner does not know limits"
    )


def test_what_gravity_asks_for_no_speed_can_mend():
    with pytest.raises(StudyError, match=r"at waypoint 2 gravity alone asks for 1\.2 of the torque limit of joint 1"):
        Problem("p", [[np.pi / 2], [0.0]], JointLimits([1.0]), arm=ArmLimits(pendulum(2.0, 0.5), [2 * G * 0.5 / 1.2]))
    over_level = np.array([[-1.2], [1.2]])
    arm = ArmLimits(pendulum(2.0, 0.5), [2 * G * 0.5 * 0.9])
    problem = Problem("over", over_level, JointLimits([9.0]), arm=arm)
    motion = Trajectory([0.0, 2.0], np.array([[-1.2], [0.0], [1.8], [-0.6]])[None], [0.0, 2.0])
    with pytest.raises(StudyError, match="slowing down does not help"):
        fitted(problem, Plan(Status.FINISHED, motion=motion))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"torque": [1.0]}, "one number for each of 2 joints"),
        ({"torque": [1.0, -1.0]}, "torque limit of joint 2 must be positive"),
        ({"tool_speed": 0.0}, "tool speed must be one positive number"),
        ({"tool_acceleration": [1.0, 2.0]}, "tool acceleration must be one positive number"),
        ({}, "none of torque, tool speed and tool acceleration is limited"),
    ],
)
def test_limits_that_make_no_sense_are_refused(given, said):
    with pytest.raises(StudyError, match=said):
        ArmLimits(two_links(), **given)


def test_torques_of_an_arm_without_masses_and_of_another_arm_are_refused():
    with pytest.raises(StudyError, match="need an arm with masses"):
        ArmLimits(two_links((0.0, 0.0)), [1.0, 1.0])
    with pytest.raises(StudyError, match="the arm has 1 joints, the waypoints have 2"):
        Problem("walk", POINTS, LIMITS, arm=ArmLimits(lift(), [500.0]))


def test_a_share_of_the_speed_slows_the_tool_and_leaves_torques():
    slow = walk(torque=[60.0, 20.0], tool_speed=1.0, tool_acceleration=4.0).at_speed(0.5).arm
    assert (slow.tool_speed, slow.tool_acceleration, slow.torque.tolist()) == (0.5, 1.0, [60.0, 20.0])
    assert walk(tool_speed=1.0).joint(0).arm is None


def test_a_velocity_that_steps_is_an_infinite_torque():
    jump = Trajectory([0.0, 0.5, 1.0], np.array([[[0.0], [0.5]], [[0.25], [1.5]]]), [0.0, 1.0])
    free = Problem("jump", [[0.0], [1.0]], JointLimits([2.0]))
    assert judge(free, jump).feasible
    for arm in (ArmLimits(lift(5.0), [500.0]), ArmLimits(lift(5.0), tool_acceleration=9.0)):
        reasons = " ".join(judge(replace(free, arm=arm), jump).reasons)
        assert "velocity of joint 1 jumps" in reasons
        assert "at the start, not zero" in reasons
        assert not unbounded_joints(replace(free, arm=arm)).any()
    assert judge(replace(free, arm=ArmLimits(lift(5.0), tool_speed=2.0)), jump).feasible
