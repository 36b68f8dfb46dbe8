"""The free path under limits of torque and of the tool: they bind, are kept, and cost less than slowing everything down."""

from dataclasses import replace

import numpy as np
import pytest

from baselines.free_path.along_itself import along_itself
from baselines.free_path.arm_limits import ANEW
from baselines.free_path.planner import FIRST, FreePathPlanner
from baselines.path_timing.toppra import Toppra
from study import JointLimits, Problem, judge
from study.arm import ArmLimits
from study.planning import RunSettings, Status
from study.problem import State
from study.slowing import slow_down
from tests.helpers.arms import G, pendulum, two_links

SETTINGS = RunSettings("cubic-spline")
POINTS = np.array([[0.0, 0.1], [0.5, 0.5], [0.2, 0.9]])
LIMITS = JointLimits([1.5, 1.2], [5.0, 4.0], [50.0, 40.0])


def walk(**arm):
    return Problem("walk", POINTS, LIMITS, arm=ArmLimits(two_links(), **arm))


@pytest.mark.parametrize(
    ("limits", "gain"),
    [({"torque": [40.0, 9.5]}, 0.85), ({"tool_speed": 0.25}, 0.8), ({"tool_acceleration": 1.0}, 0.95)],
)
def test_each_limit_binds_and_costs_less_than_slowing_the_whole_motion_down(limits, gain):
    problem = walk(**limits)
    free = FIRST.plan(replace(problem, arm=None), SETTINGS).motion
    assert not judge(problem, free).feasible, "the limit binds"
    plan = FIRST.plan(problem, SETTINGS)
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    assert verdict.arm_shares[0].max() > 0.99
    assert plan.motion.duration < gain * free.duration * slow_down(problem.arm, free)


def test_a_limit_that_does_not_bind_changes_nothing():
    problem = walk(torque=[500.0, 500.0])
    with_arm, without = (
        FreePathPlanner().plan(each, SETTINGS).motion for each in (problem, replace(problem, arm=None))
    )
    assert with_arm.duration == pytest.approx(without.duration, rel=1e-9)


def test_between_moving_ends_the_limits_are_kept_without_a_slower_run():
    problem = replace(walk(torque=[45.0, 11.0], tool_speed=0.9), start=State([0.3, -0.2]))
    plan = FIRST.plan(problem, SETTINGS)
    assert judge(problem, plan.motion).feasible, judge(problem, plan.motion).reasons
    impossible = replace(walk(tool_speed=0.01), start=State([0.3, -0.2]))
    failed = FIRST.plan(impossible, SETTINGS)
    assert failed.status is not Status.FINISHED
    assert failed.motion is None
    assert "of a limit of the arm" in failed.message


def test_where_the_arm_cannot_hold_itself_that_is_the_reason():
    arm = ArmLimits(pendulum(2.0, 0.5), [2 * G * 0.5 * 0.6])
    slow = Problem("over", [[-1.2], [1.2]], JointLimits([0.5], [1.0], [9.0]), arm=arm)
    plan = FIRST.plan(slow, SETTINGS)
    assert plan.motion is None
    assert "slowing down does not help" in plan.message


def test_where_nothing_but_torque_limits_accelerations_the_velocity_does_not_step():
    problem = replace(walk(torque=[60.0, 20.0]), limits=JointLimits([1.5, 1.2]))
    plan = FIRST.plan(problem, SETTINGS)
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    assert verdict.arm_shares[0].max() > 0.9


def test_without_a_limit_of_jerk_its_path_is_driven_anew():
    problem = replace(walk(torque=[40.0, 9.5]), limits=JointLimits([1.5, 1.2], [9.0, 9.0]))
    plan = FIRST.plan(problem, SETTINGS)
    assert judge(problem, plan.motion).feasible
    assert plan.message == ANEW
    assert plan.motion(plan.motion.waypoint_times) == pytest.approx(POINTS, abs=1e-9)
    along = Toppra(per_segment=50).plan(problem, SETTINGS).motion
    assert plan.motion.duration < 1.05 * along.duration
    assert along_itself(replace(problem, stops=[1]), plan.motion) is None, "it knows no stops"
