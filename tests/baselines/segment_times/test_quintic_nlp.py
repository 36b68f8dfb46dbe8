"""Free quintic segments: closed forms, the narrower curves inside them, and the laws of time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baselines.segment_times.nlp import optimise
from baselines.segment_times.quintic_curve import Quintic
from baselines.segment_times.quintic_nlp import QuinticNlp
from study import EndCondition, JointLimits, Problem, judge
from study.curves import CURVES
from study.planning import RunSettings, Status
from tests.helpers.segment_problems import BINDING, WOODWORKING, random_problem

SETTINGS = RunSettings("cubic-spline")


def total(problem: Problem) -> float:
    plan = QuinticNlp().plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED, plan.message
    verdict = judge(problem, plan.motion)
    assert verdict.feasible, verdict.reasons
    return verdict.duration


@pytest.mark.parametrize(
    ("limits", "seconds"),
    [
        ((1.0, np.inf, np.inf), 15 / 8 * 2.0),
        ((1e3, 1.0, np.inf), np.sqrt(10 / np.sqrt(3) * 2.0)),
        ((1e3, 1e3, 1.0), np.cbrt(60 * 2.0)),
    ],
)
def test_one_smooth_segment_is_the_minimum_jerk_polynomial(limits: tuple[float, ...], seconds: float) -> None:
    problem = Problem("one", [[0.0], [2.0]], JointLimits(*([v] for v in limits)), end=EndCondition.SMOOTH)
    assert total(problem) == pytest.approx(seconds, rel=1e-7)


@pytest.mark.parametrize("binding", BINDING)
@pytest.mark.parametrize(("end", "curve"), [(EndCondition.REST, "cubic-spline"), (EndCondition.SMOOTH, "poly353")])
def test_it_is_never_slower_than_the_curves_inside_it(end: EndCondition, curve: str, binding: str) -> None:
    problem = replace(random_problem(3, 4, 2, BINDING[binding]), end=end)
    plan = QuinticNlp().plan(problem, SETTINGS)
    verdict = judge(problem, plan.motion)
    assert verdict.ratios.max() <= 1 + 1e-9
    assert verdict.continuity >= 2
    assert verdict.waypoint_error.max() < 1e-9
    assert verdict.duration <= optimise(problem, curve).durations.sum() * (1 + 1e-9)


def test_woodworking_with_freer_segments() -> None:
    assert total(WOODWORKING) < 7.4756


def test_scaled_limits_and_reversed_time() -> None:
    problem = replace(random_problem(5, 5, 2), end=EndCondition.SMOOTH)
    expected = total(problem)
    slower = replace(problem, limits=problem.limits.scaled(1.7), duration_bounds=(1.7e-3, 17.0))
    assert total(slower) == pytest.approx(1.7 * expected, rel=1e-5)
    assert total(replace(problem, waypoints=problem.waypoints[::-1])) == pytest.approx(expected, rel=1e-5)


def test_stricter_ends_cost_time() -> None:
    problem = random_problem(6, 5, 2)
    free, rest, smooth = (total(replace(problem, end=end)) for end in EndCondition)
    assert free <= rest * (1 + 1e-6) <= smooth * (1 + 2e-6)


def test_lifting_a_cubic_spline_gives_it_back() -> None:
    problem = replace(random_problem(7, 5, 3), end=EndCondition.REST)
    durations = np.array([0.8, 1.3, 0.9, 1.1])
    family = Quintic(5, 3, (1, 2, 3))
    spline = CURVES["cubic-spline"].motion(problem.waypoints, durations)
    lifted = family.motion(problem, family.lift(problem, durations))
    times = np.linspace(0, spline.duration, 101)
    for order in range(3):
        assert lifted(times, order) == pytest.approx(spline(times, order), abs=1e-9)
