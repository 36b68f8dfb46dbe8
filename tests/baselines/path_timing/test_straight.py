"""Straight lines with blends: closed forms, what is granted at a corner, every kind of limit, random problems."""

from dataclasses import replace

import numpy as np
import pytest

from baselines.closed_forms import rest_to_rest_time, three_limit_time
from baselines.path_timing.polyline import Change
from baselines.path_timing.straight import Straight
from study import EndCondition, JointLimits, Problem, judge
from study.planning import RunSettings, Status
from study.problem import StraightPath, Tube
from study.testing import random_problem
from tests.helpers.reference_problems import EACH_LIMIT, INF

SETTINGS = RunSettings("cubic-spline", time_limit=20.0)
CORNER = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]


def planned(problem):
    plan = Straight().plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED, plan.message
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    return plan.motion


@pytest.mark.parametrize("limits", EACH_LIMIT.values(), ids=EACH_LIMIT)
def test_without_room_at_the_corners_every_line_takes_its_closed_form(limits):
    """One scalar moves along each line, within the smallest share that any joint leaves it."""
    points = np.random.default_rng(1).uniform(-1, 1, (5, 3))
    problem = Problem("stops", points, JointLimits(*limits), EndCondition.SMOOTH, path=StraightPath())
    steps = np.abs(np.diff(points, axis=0))
    scalars = np.stack([(problem.limits.rates / step).min(axis=1) for step in steps], axis=1)
    assert planned(problem).duration == pytest.approx(rest_to_rest_time(np.ones(4), scalars).sum(), rel=1e-9)


@pytest.mark.parametrize("radius", [0.01, 0.1, 0.3])
def test_a_square_corner_by_constant_acceleration_takes_its_closed_form(radius):
    """The blend at speed c begins c^2 / (2 A) before the corner; each leg peaks at sqrt(A)."""
    acceleration = 2.0
    problem = Problem("corner", CORNER, JointLimits([9.0] * 2, [acceleration] * 2), path=StraightPath(radius))
    by_hand = (4 * np.sqrt(acceleration) - np.sqrt(2 * acceleration * radius)) / acceleration
    motion = planned(problem)
    assert motion.duration == pytest.approx(by_hand, rel=1e-5)
    assert motion(motion.waypoint_times[1:2])[0] == pytest.approx([1 - radius / 4, radius / 4], rel=1e-4)


@pytest.mark.parametrize(("velocity", "binding"), [(9.0, "room"), (0.3, "velocity")])
def test_a_square_corner_with_jerk_uses_the_room_or_the_speed(velocity, binding):
    problem = Problem("corner", CORNER, JointLimits([velocity] * 2, [5.0] * 2, [30.0] * 2), path=StraightPath(0.1))
    motion = planned(problem)
    assert motion.duration < sum(three_limit_time(np.ones(2), velocity, 5.0, 30.0))
    t = np.linspace(0, motion.duration, 20001)
    away = np.abs(motion(t) - CORNER[1]).max(axis=1)[np.abs(motion(t, 1)).min(axis=1) > 1e-9]
    if binding == "room":
        assert away.max() == pytest.approx(0.1, rel=1e-3)
    else:
        assert away.max() < 0.1
        assert motion(motion.waypoint_times[1:2], 1)[0] == pytest.approx([0.15, 0.15], rel=1e-3)


def test_the_deviation_in_the_middle_of_a_blend_has_a_closed_form():
    """With the time a + b whole at one acceleration it is an eighth, with two pieces of jerk a twelfth of it."""
    assert Change(np.array(2.0), np.array(0.0)).deviation == pytest.approx(2 / 8)
    assert Change(np.array(1.0), np.array(1.0)).deviation == pytest.approx(2 / 12)


@pytest.mark.parametrize("path", [None, Tube(0.05), Tube(0.01)], ids=["free", "tube", "narrow tube"])
def test_a_tolerance_is_used_to_its_end_where_no_tube_is_narrower(path):
    limits = JointLimits([9.0] * 2, [5.0] * 2, [30.0] * 2)
    problem = Problem("corner", CORNER, limits, path=path, tolerance=0.02)
    motion = planned(problem)
    off = np.abs(motion(motion.waypoint_times[1:2])[0] - CORNER[1]).max()
    assert off == pytest.approx(0.01 if path is not None and path.radius < 0.02 else 0.02, rel=1e-3)


def test_corners_in_line_are_passed_at_full_speed():
    points = np.linspace([0.0, 1.0], [4.0, 3.0], 9)
    limits = JointLimits([1.0] * 2, [2.0] * 2, [10.0] * 2)
    whole, parts = (Problem("line", p, limits, path=StraightPath()) for p in (points[[0, -1]], points))
    assert planned(parts).duration == pytest.approx(planned(whole).duration, rel=1e-5)


def test_run_backwards_it_takes_as_long():
    points = np.random.default_rng(3).uniform(-1, 1, (7, 3))
    limits = JointLimits([1.5] * 3, [5.0] * 3, [50.0] * 3)
    there, back = (Problem("line", p, limits, path=StraightPath(0.05)) for p in (points, points[::-1]))
    assert planned(there).duration == pytest.approx(planned(back).duration, rel=2e-3)


def test_a_free_start_begins_at_speed():
    limits = JointLimits([1.0] * 2, [2.0] * 2, [10.0] * 2)
    problem = Problem("line", CORNER[:2], limits, EndCondition.FREE, path=StraightPath())
    motion = planned(problem)
    assert motion.duration == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("number", [*range(8), *(pytest.param(k, marks=pytest.mark.slow) for k in range(8, 24))])
def test_random_problems_with_a_rule_for_the_path(number):
    rng = np.random.default_rng([9, number])
    problem = random_problem(rng)
    size = np.maximum(np.ptp(problem.waypoints, axis=0), 1e-3) * 10.0 ** rng.uniform(-3, 0)
    path = (StraightPath(size), StraightPath(), Tube(size), None)[number % 4]
    tolerance = np.tile(0.5 * size, (problem.n_waypoints, 1)) if number % 3 else None
    ends = {"start": None, "finish": None} if not problem.scalable else {}
    planned(replace(problem, path=path, tolerance=tolerance, timing=None, **ends))


def test_a_line_without_any_limit_is_a_reason():
    problem = Problem("free", CORNER, JointLimits([1.0, INF]), path=StraightPath())
    plan = Straight().plan(problem, SETTINGS)
    assert plan.status is Status.FAILED
    assert plan.message == "nothing limits what moves from waypoint 2 to 3"


@pytest.mark.parametrize("radius", [0.0, 0.003, 0.05, 0.2])
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))])
def test_it_is_never_slower_than_a_stop_at_every_corner(seed, radius):
    points = np.random.default_rng(seed).uniform(-0.5, 0.5, (8, 2))
    limits = JointLimits([1.5] * 2, [5.0] * 2, [50.0] * 2)
    cut, stopping = (Problem("p", points, limits, path=StraightPath(r)) for r in (radius, 0.0))
    assert planned(cut).duration <= planned(stopping).duration * (1 + 1e-9)
