"""TOPP-RA under limits of torque and of the tool: its package's own constraint, closed forms, and the judge."""

from dataclasses import replace

import numpy as np
import pytest
from toppra import SplineInterpolator, algorithm, constraint

from baselines.path_timing.path import centripetal_path
from baselines.path_timing.toppra import Toppra, retime
from study import JointLimits, Problem, judge
from study.arm import ArmLimits
from study.demands import ARM
from study.planning import RunSettings, Status
from study.robots.masses import heavy_arm
from study.slowing import slow_down
from tests.helpers.arms import G, lift, pendulum, two_links

SETTINGS = RunSettings("cubic-spline")
POINTS = np.array([[0.0, 0.1], [0.5, 0.5], [0.2, 0.9], [0.9, 0.4]])
FAST = JointLimits([9.0, 9.0], [60.0, 60.0])
PUMA = np.array([[0, 0.8, 2.6, 0, 0.5, 0], [0.6, 1.1, 2.2, 0.3, 0.2, 0.4], [1.2, 0.6, 2.8, -0.2, 0.6, 0.1]])


def textbook(q, v, a, masses=(3.0, 2.0), lengths=(0.5, 0.4)):
    """Torques of `two_links` by hand."""
    (m1, m2), (l1, l2), h = masses, lengths, masses[1] * lengths[0] * lengths[1]
    c1, c12, c2, s2 = np.cos(q[0]), np.cos(q[0] + q[1]), np.cos(q[1]), np.sin(q[1])
    m11, m12, m22 = (m1 + m2) * l1**2 + m2 * l2**2 + 2 * h * c2, m2 * l2**2 + h * c2, m2 * l2**2
    first = (
        m11 * a[0] + m12 * a[1] - h * s2 * (2 * v[0] * v[1] + v[1] ** 2) + (m1 + m2) * G * l1 * c1 + m2 * G * l2 * c12
    )
    return np.array([first, m12 * a[0] + m22 * a[1] + h * s2 * v[0] ** 2 + m2 * G * l2 * c12])


def theirs(problem, dynamics, points=600):
    """Time that the package finds with its own torque constraint on the natural spline of the same waypoints."""
    path, arm = centripetal_path(problem.waypoints, problem.limits), problem.arm
    spline = SplineInterpolator(path.knots, problem.waypoints, "natural")
    torque = constraint.SecondOrderConstraint.joint_torque_constraint(
        dynamics, np.column_stack([-arm.torque, arm.torque]), arm.mechanism.coulomb
    )
    rates = [
        kind(np.column_stack([-limit, limit]))
        for kind, limit in zip(
            (constraint.JointVelocityConstraint, constraint.JointAccelerationConstraint),
            problem.limits.rates,
            strict=False,
        )
    ]
    solver = algorithm.TOPPRA([*rates, torque], spline, gridpoints=np.linspace(0, path.knots[-1], points + 1))
    _, speeds, _ = solver.compute_parameterization(0, 0)
    return (2 * np.diff(solver.gridpoints) / (speeds[1:] + speeds[:-1])).sum()


@pytest.mark.parametrize("coulomb", [[0.0, 0.0], [3.0, 0.8]])
def test_it_agrees_with_the_package_s_own_torque_constraint(coulomb):
    problem = Problem("two", POINTS, FAST, arm=ArmLimits(two_links(coulomb=coulomb), [45.0, 12.0]))
    _agrees(problem, textbook)


@pytest.mark.slow
def test_it_agrees_with_the_package_s_own_torque_constraint_on_a_puma():
    arm = heavy_arm("puma560")
    smooth = replace(arm.mechanism, viscous=np.zeros(6), coulomb=np.zeros(6))
    problem = Problem("puma", PUMA, JointLimits([8.0] * 6, [60.0] * 6), arm=ArmLimits(smooth, arm.effort))
    _agrees(problem, lambda q, v, a: smooth.torque(q, v, a)[0])


def _agrees(problem, dynamics):
    ours = retime(problem, 200, centripetal_path)
    assert ours.motion.duration == pytest.approx(theirs(problem, dynamics), rel=0.005)
    verdict = judge(problem, ours.motion)
    assert verdict.feasible
    assert verdict.arm_shares[0].max() > 0.999, "the torque binds"
    assert retime(replace(problem, arm=None), 200, centripetal_path).motion.duration < 0.98 * ours.motion.duration


def test_a_lift_rises_as_fast_as_its_motor_can_pull_and_its_weight_can_brake():
    """Bang-bang with F/m - g up and -F/m - g down, in closed form."""
    force, mass = 80.0, 5.0
    problem = Problem("lift", [[0.0], [1.0]], JointLimits([99.0], [99.0]), arm=ArmLimits(lift(mass), [force]))
    up, down = force / mass - G, force / mass + G
    exact = np.sqrt(2.0 * (up + down) / (up * down))
    plan = Toppra().plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED
    assert judge(problem, plan.motion).feasible
    assert plan.motion.duration == pytest.approx(exact, rel=2e-3)


def test_a_pendulum_s_tool_moves_at_its_limit_in_between():
    problem = Problem(
        "turn", [[0.0], [2.0]], JointLimits([99.0], [8.0]), arm=ArmLimits(pendulum(2, 0.5), tool_speed=0.25)
    )
    plan = Toppra().plan(problem, SETTINGS)
    assert judge(problem, plan.motion).feasible
    assert plan.motion.duration == pytest.approx(2.0 / 0.5 + 0.5 / 8.0, rel=1e-3)


def test_all_limits_of_the_arm_bind_and_beat_slowing_the_whole_motion_down():
    assert Toppra.knows >= ARM
    for limits in ({"torque": [45.0, 12.0]}, {"tool_speed": 0.25}, {"tool_acceleration": 2.0}):
        problem = Problem("walk", POINTS, FAST, arm=ArmLimits(two_links(viscous=[2.0, 0.5]), **limits))
        plan = Toppra(per_segment=50).plan(problem, SETTINGS)
        verdict = judge(problem, plan.motion)
        assert verdict.feasible, verdict.reasons
        assert verdict.arm_shares[0].max() > 0.995
        free = retime(replace(problem, arm=None), 50, centripetal_path).motion
        slowed = free.duration * slow_down(problem.arm, free)
        assert plan.motion.duration < 0.95 * slowed


def test_momentum_carries_an_arm_where_it_cannot_hold_itself():
    arm = ArmLimits(pendulum(2.0, 0.5), [2 * G * 0.5 * 0.9])
    over_level = Problem("over", [[-1.2], [1.2]], JointLimits([9.0], [9.0]), arm=arm)
    assert arm.held(np.zeros((1, 1))).max() > 1.1
    assert judge(over_level, Toppra().plan(over_level, SETTINGS).motion).feasible
