import numpy as np
import pytest

from baselines.base import Deterministic, held_still, longest, parts, where_something_moves
from baselines.units import dimensionless
from study.curves import CURVES
from study.errors import StudyError
from study.judge import judge
from study.planning import Plan, RunSettings, Status
from study.problem import EndCondition, JointLimits, Problem

SETTINGS = RunSettings("cubic-spline")


class Told(Deterministic):
    """A planner that keeps what it was asked, or cannot plan."""

    def __init__(self, reason=""):
        self.reason = reason

    @where_something_moves
    def plan(self, problem, settings):
        if self.reason:
            raise StudyError(self.reason)
        self.problem = problem
        return Plan(Status.FINISHED)


def arm(trembling):
    waypoints = np.column_stack([[0.0, 1.0, 0.5], [2.0, 2.0 + trembling, 2.0]])
    return Problem(
        "arm", waypoints, JointLimits([1.0, 2.0], [3.0, 4.0], [5.0, 6.0], upper=[9.0, 9.0]), EndCondition.REST
    )


@pytest.mark.parametrize("trembling", [1e-15, 9e-10])
def test_a_joint_that_moves_less_than_the_floor_is_held_still(trembling):
    planner = Told()
    planner.plan(arm(trembling), SETTINGS)
    assert np.ptp(planner.problem.waypoints, axis=0).tolist() == [1.0, 0.0]


def test_a_joint_that_moves_more_than_the_floor_is_left_as_it_is():
    problem = arm(1e-8)
    assert held_still(problem) is problem


def test_a_motion_of_the_joints_held_still_passes_the_judge_of_the_noisy_problem():
    problem = arm(9e-10)
    motion = CURVES["cubic-spline"].motion(held_still(problem).waypoints, np.full(2, 9.0))
    assert judge(problem, motion).feasible


def test_where_nothing_moves_no_planner_applies():
    still = Problem("still", [[1.0], [1.0 + 1e-12]], JointLimits([1.0]))
    plan = Told().plan(still, SETTINGS)
    assert plan.status is Status.NOT_APPLICABLE
    assert "nothing to move" in plan.message


def test_an_error_becomes_the_reason_of_a_failed_plan():
    plan = Told("no way there").plan(arm(0.0), SETTINGS)
    assert (plan.status, plan.message) == (Status.FAILED, "no way there")


def test_joints_plan_alone_where_the_settings_say_so_and_the_longest_durations_count():
    alone = parts(arm(0.0), RunSettings("cubic-spline", synchronisation="per-joint"))
    assert [part.n_joints for part in alone] == [1, 1]
    assert [part.n_joints for part in parts(arm(0.0), SETTINGS)] == [2]
    assert longest([np.array([1.0, 4.0]), np.array([2.0, 3.0])]).tolist() == [2.0, 4.0]


def test_a_problem_without_dimensions_has_the_same_verdict_in_other_units():
    problem, durations = arm(0.25), np.array([0.8, 1.1])
    scaled, units = dimensionless(problem, 0.7, [4.0, 0.0])
    motion = CURVES["cubic-spline"].motion(scaled.waypoints, durations / 0.7)
    back = units.motion(motion)
    assert back.duration == pytest.approx(durations.sum())
    assert judge(scaled, motion).ratios == pytest.approx(judge(problem, back).ratios)
    assert units.into(back).coefficients == pytest.approx(motion.coefficients)
    assert scaled.limits.upper.tolist() == [2.25, 9.0]
