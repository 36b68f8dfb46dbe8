"""Third-order path parameterization: ours, COPP's where it is installed, and what both owe to TOPP-RA."""

from functools import cache

import numpy as np
import pytest

from baselines.path_timing.path import chord_path, grid
from baselines.path_timing.topp3_nlp import Topp3Nlp
from baselines.path_timing.toppra import Toppra
from study import EndCondition, JointLimits, Problem, judge
from study.planning import RunSettings, Status

SETTINGS = RunSettings("cubic-spline")
POINTS = np.array([[0.0, 0.3], [0.8, -0.2], [1.1, 0.6], [0.2, 1.0]])


def problem(jerk=8.0, end=EndCondition.REST):
    return Problem("p", POINTS, JointLimits([1.0, 1.2], [2.0, 2.5], [jerk, jerk]), end)


@cache
def topp3(jerk=8.0, end=EndCondition.REST, halvings=1):
    """Our plan for a problem, which several tests look at."""
    return Topp3Nlp(halvings=halvings).plan(problem(jerk, end), SETTINGS)


def curvature_free_path(motion, case):
    """Largest distance between the motion's positions and the chord path, both sampled densely."""
    path = chord_path(case.waypoints, case.limits)
    points = path.at(np.linspace(0, path.knots[-1], 20_001))[:, 0]
    found = motion(np.linspace(0, motion.duration, 301))
    return np.sqrt(((found[:, None] - points) ** 2).sum(axis=2)).min(axis=1).max()


@pytest.mark.parametrize("end", [EndCondition.REST, EndCondition.SMOOTH])
def test_the_motion_is_feasible_and_stays_on_the_path(end):
    case = problem(end=end)
    plan = topp3(end=end)
    verdict = judge(case, plan.motion)
    assert plan.status is Status.FINISHED
    assert verdict.feasible
    assert verdict.continuity >= 2
    assert curvature_free_path(plan.motion, case) < 1e-3


@pytest.mark.slow
def test_more_pieces_never_lengthen_and_toppra_is_faster_than_any_jerk_limit():
    """A looser jerk limit gains to within a per cent only: the solver is local."""
    tight = topp3().motion.duration
    finer = topp3(halvings=2).motion.duration
    loose = topp3(80.0, halvings=2).motion.duration
    second_order = Toppra().plan(problem(80.0), SETTINGS).motion.duration
    assert finer <= tight * (1 + 1e-4)
    assert second_order * (1 - 1e-4) < loose < finer * 1.01
    assert loose < second_order * 1.15


def test_scaled_limits_scale_the_duration():
    base = topp3().motion.duration
    case = problem()
    slow = Problem("slow", POINTS, case.limits.scaled(2.0), case.end)
    assert Topp3Nlp().plan(slow, SETTINGS).motion.duration == pytest.approx(2 * base, rel=1e-4)


def test_not_applicable_without_a_jerk_limit():
    free = Problem("p", POINTS, JointLimits([1.0, 1.0], [2.0, 2.0]))
    assert Topp3Nlp().plan(free, SETTINGS).status is Status.NOT_APPLICABLE


@pytest.fixture
def copp():
    pytest.importorskip("copp_py", reason="the extra `copp` is not installed")
    from baselines.path_timing import copp as copp_retiming

    return copp_retiming


def test_copp_is_not_applicable_without_a_jerk_limit(copp):
    free = Problem("p", POINTS, JointLimits([1.0, 1.0], [2.0, 2.0]))
    assert copp.Copp().plan(free, SETTINGS).status is Status.NOT_APPLICABLE


def test_driving_a_path_at_constant_speed_is_the_path(copp):
    case = problem()
    path = chord_path(case.waypoints, case.limits)
    points = grid(path, 4)
    states = np.stack([points, np.full_like(points, 0.5), np.zeros_like(points)], axis=1)
    motion = copp.driven(path, points / 0.5, states, np.full(3, 4))
    t = np.linspace(0, motion.duration, 50)
    assert motion(t) == pytest.approx(path.at(0.5 * t)[:, 0], abs=1e-12)
    assert motion(motion.waypoint_times) == pytest.approx(case.waypoints, abs=1e-12)


def test_copp_is_feasible_on_the_same_path_and_not_faster(copp):
    case = problem()
    plan = copp.Copp().plan(case, RunSettings("bspline"))
    assert judge(case, plan.motion).feasible
    assert curvature_free_path(plan.motion, case) < 1e-3
    assert plan.motion.duration > topp3(halvings=2).motion.duration


def test_copp_tries_the_natural_spline_where_toppra_does_and_refuses_what_it_cannot_end_in_time(copp):
    case, usual = problem(), SETTINGS
    natural = copp.Copp().plan(case, usual)
    assert judge(case, natural.motion).feasible
    assert natural.motion.duration <= copp.Copp().plan(case, RunSettings("bspline")).motion.duration
    refused = copp.Copp().plan(case, RunSettings("cubic-spline", time_limit=1e-3))
    assert (refused.status, refused.motion) == (Status.NOT_APPLICABLE, None)
    assert "more than the time limit" in refused.message
