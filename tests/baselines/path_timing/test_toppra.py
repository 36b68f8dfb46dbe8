"""TOPP-RA: limits kept exactly, closed forms on a straight path, what it does not apply to."""

import numpy as np
import pytest
from toppra import SplineInterpolator, algorithm, constraint

from baselines.closed_forms import two_limit_time
from baselines.path_timing.path import centripetal_path, chord_path, compose, grid
from baselines.path_timing.toppra import GRID, Toppra, retime
from study import JointLimits, Problem, judge
from study.curves import CURVES
from study.planning import RunSettings, Status
from study.trajectory import Trajectory
from tests.helpers.reference_problems import EACH_LIMIT, INF, small, woodworking

SETTINGS = RunSettings("cubic-spline")


def test_the_path_is_the_clamped_spline_by_chords():
    problem = woodworking()
    path = chord_path(problem.waypoints, problem.limits)
    chords = np.linalg.norm(np.diff(problem.waypoints, axis=0) / problem.limits.velocity, axis=1)
    assert np.diff(path.knots) == pytest.approx(chords)
    spline = CURVES["cubic-spline"].motion(problem.waypoints, chords)
    s = np.linspace(0, path.knots[-1], 37)
    for order, factor in enumerate((1, 1, 2, 6)):
        assert factor * path.at(s)[:, order] == pytest.approx(spline(s, order), abs=1e-9)


def test_the_knots_are_gridpoints():
    path = chord_path(woodworking().waypoints, woodworking().limits)
    points = grid(path, 7)
    assert len(points) == 22
    assert points[::7].tolist() == path.knots.tolist()


def test_composition_is_exact():
    problem = woodworking()
    path = chord_path(problem.waypoints, problem.limits)
    points = grid(path, 3)
    speeds = np.random.default_rng(0).uniform(0.5, 1.5, len(points))
    durations, coefficients = compose(path, points, speeds)
    motion = Trajectory.from_pieces(durations, coefficients, 3)
    assert motion.degree == 6
    for order in (0, 1):
        assert np.abs(motion.jumps(order)).max() < 1e-12
    t = np.linspace(0, motion.duration, 200)
    piece = np.clip(np.searchsorted(motion.knots, t, side="right") - 1, 0, len(durations) - 1)
    ramp = np.diff(speeds) / durations
    since = t - motion.knots[piece]
    s = points[piece] + speeds[piece] * since + ramp[piece] * since**2 / 2
    assert motion(t) == pytest.approx(path.at(s)[:, 0], abs=1e-12)


@pytest.mark.parametrize("name", ["velocity binds", "acceleration binds", "no velocity limit", "all"])
def test_limits_are_kept_exactly_and_used(name):
    velocity, acceleration, _ = EACH_LIMIT[name]
    problem = small((velocity, acceleration, INF))
    plan = Toppra().plan(problem, SETTINGS)
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    assert verdict.worst_ratio > 0.995
    assert verdict.waypoint_error.max() < 1e-12
    assert 1.0 <= plan.details["stretch"] <= 1.003


def test_on_a_straight_path_it_is_the_trapezoid():
    problem = Problem("line", [[0.0, 0.0], [1.0, 2.0]], JointLimits([1.0, 1.5], [2.0, 2.0]))
    expected = two_limit_time([1.0, 2.0], [1.0, 1.5], [2.0, 2.0]).max()
    assert retime(problem, 400).motion.duration == pytest.approx(expected, rel=2e-3)
    assert retime(problem, 400).motion.duration >= expected * (1 - 1e-6)


def test_a_finer_grid_converges():
    coarse, middle, fine = (retime(woodworking(), n).motion.duration for n in (25, 100, 400))
    assert coarse > middle > fine
    assert middle - fine < 2e-3 * fine


def test_it_is_never_slower_than_the_same_spline_driven_at_constant_path_speed():
    problem = woodworking()
    path = chord_path(problem.waypoints, problem.limits)
    motion = CURVES["cubic-spline"].motion(problem.waypoints, np.diff(path.knots))
    ratios = judge(problem, motion).ratios.max(axis=1)
    assert retime(problem, 200).motion.duration < motion.duration * max(ratios[0], np.sqrt(ratios[1]))


def test_woodworking():
    plan = Toppra().plan(woodworking(), SETTINGS)
    assert plan.motion.duration == pytest.approx(3.4746, abs=2e-4)


def test_a_jerk_limit_makes_it_infeasible_with_a_reason():
    problem = woodworking(jerk=[50.0] * 4)
    plan = Toppra().plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED
    verdict = judge(problem, plan.motion)
    assert not verdict.feasible
    assert any("acceleration" in reason and "jumps" in reason for reason in verdict.reasons)
    slow = plan.motion.scaled(100.0)
    assert any("jumps" in reason for reason in judge(problem, slow).reasons)


def test_where_it_does_not_apply():
    assert Toppra().plan(woodworking(acceleration=INF), SETTINGS).status is Status.NOT_APPLICABLE
    still = Problem("still", [[1.0], [1.0]], JointLimits([1.0], [1.0]), allow_dwell=True)
    assert Toppra().plan(still, SETTINGS).status is Status.NOT_APPLICABLE


def test_one_joint_alone_may_dwell():
    problem = Problem("dwell", [[0.0], [1.0], [1.0], [0.5]], JointLimits([1.0], [1.0]), allow_dwell=True)
    motion = retime(problem, 200).motion
    assert judge(problem, motion).feasible
    assert motion.waypoint_times[1] == motion.waypoint_times[2]


def smooth_problem(n_waypoints):
    rng = np.random.default_rng(31)
    s = np.linspace(0, 1, n_waypoints)[:, None]
    waves = [rng.normal(size=7) / k * np.sin(np.pi * k * s + rng.uniform(0, 6, 7)) for k in (1, 2, 3)]
    return Problem("smooth", sum(waves), JointLimits(np.full(7, 2.0), np.full(7, 5.0)))


def package_alone(path, limits, points):
    rates = [limits.velocity, limits.acceleration]
    wanted = [
        kind(np.stack([-rate, rate], axis=1))
        for kind, rate in zip(
            (constraint.JointVelocityConstraint, constraint.JointAccelerationConstraint), rates, strict=True
        )
    ]
    return algorithm.TOPPRA(wanted, path, gridpoints=points, parametrizer="ParametrizeConstAccel").compute_trajectory()


@pytest.mark.parametrize("n_waypoints", [200, 1000])
def test_a_smooth_path_of_many_waypoints_is_feasible_and_as_fast_as_by_the_package_alone(n_waypoints):
    problem = smooth_problem(n_waypoints)
    plan = Toppra().plan(problem, SETTINGS)
    assert judge(problem, plan.motion).feasible
    steps = int(plan.details["grid_steps"])
    path = SplineInterpolator(np.linspace(0, 1, n_waypoints), problem.waypoints)
    alone = package_alone(path, problem.limits, np.linspace(0, 1, steps + 1))
    assert plan.motion.duration <= 1.01 * alone.duration


def test_many_waypoints_share_one_grid():
    plan = Toppra().plan(smooth_problem(1000), SETTINGS)
    assert plan.details["grid_steps"] <= 4 * GRID


@pytest.mark.parametrize("seed", range(6))
def test_the_chosen_spline_is_never_slower_than_the_clamped_one(seed):
    waypoints = np.random.default_rng(seed).uniform(-2, 2, (8, 3))
    problem = Problem("scattered", waypoints, JointLimits([1.0, 2.0, 1.5], [3.0, 2.0, 4.0]))
    chosen, clamped = (Toppra(50).plan(problem, RunSettings(name)).motion for name in ("cubic-spline", "bspline"))
    assert judge(problem, chosen).feasible
    assert chosen.duration <= clamped.duration


def test_the_natural_spline_starts_and_ends_at_rest_where_it_is_the_faster():
    waypoints = [[0.0, 0.0], [0.1, 0.0], [1.0, 1.0], [1.1, 1.0], [2.0, -1.0], [2.1, -1.0]]
    problem = Problem("uneven", waypoints, JointLimits([1.0, 1.0], [2.0, 2.0]))
    natural = retime(problem, 50, centripetal_path)
    assert judge(problem, natural.motion).feasible
    assert natural.motion.duration < retime(problem, 50).motion.duration
    assert Toppra(50).plan(problem, SETTINGS).motion.duration <= natural.motion.duration


def test_a_path_inside_the_range_of_positions_goes_before_a_faster_one_outside():
    waypoints = [[0.0, 0.0], [0.1, 0.0], [1.0, 1.0], [1.1, 1.0], [2.0, -1.0], [2.1, -1.0]]
    free = Problem("uneven", waypoints, JointLimits([1.0, 1.0], [2.0, 2.0]))
    low, high = (bound([retime(free, 50).motion.extrema()[k] for k in (0, 2)], axis=0) for bound in (np.min, np.max))
    problem = Problem("range", waypoints, JointLimits([1.0, 1.0], [2.0, 2.0], lower=low, upper=high))
    assert retime(problem, 50, centripetal_path).leaves == (
        not judge(problem, Toppra(50).plan(free, SETTINGS).motion).feasible
    )
    assert judge(problem, Toppra(50).plan(problem, SETTINGS).motion).feasible


def test_without_time_the_first_motion_is_given():
    problem = smooth_problem(50)
    plan = Toppra(worst_stretch=1.0).plan(problem, RunSettings("cubic-spline", time_limit=0.0))
    assert judge(problem, plan.motion).feasible
    assert plan.details["grid_steps"] == GRID // 49 * 49
