"""The free-path NLP: optimal where optima are known, better with more pieces, exact in every limit."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from baselines.bounds.lower_bounds import lower_bound
from baselines.closed_forms import three_limit_time, two_limit_time
from baselines.free_path import nlp as free_path_nlp
from baselines.free_path.nlp import FreePathNlp, free_path, surplus
from baselines.segment_times.quintic_nlp import QuinticNlp
from baselines.state_to_state.stops import ruckig_stops
from baselines.state_to_state.via import ruckig_via
from study import EndCondition, JointLimits, Problem, StudyError, judge
from study.planning import RunSettings, Status
from tests.helpers.reference_problems import EACH_LIMIT, INF, LIMITS_AND_ENDS, small, woodworking

SETTINGS = RunSettings("cubic-spline", time_limit=60.0)


def line(distance, *limits, end=EndCondition.SMOOTH):
    return Problem("line", [[0.0], [distance]], JointLimits(*([limit] for limit in limits)), end=end)


@pytest.mark.parametrize("distance", [0.3, 2.0])
def test_bang_bang_is_found_with_two_pieces_and_approached_with_many(distance):
    problem = line(distance, 100.0, 2.0, INF)
    assert free_path(problem, 2).motion.duration == pytest.approx(two_limit_time(distance, 100.0, 2.0), rel=1e-6)


def test_a_trapezoid_is_approached_from_above():
    exact = float(two_limit_time(3.0, 1.0, 2.0))
    durations = [free_path(line(3.0, 1.0, 2.0, INF), pieces).motion.duration for pieces in (4, 8, 32)]
    assert durations[0] >= durations[1] >= durations[2] >= exact * (1 - 1e-6)
    assert durations[2] == pytest.approx(exact, rel=2e-2)


@pytest.mark.parametrize("limits", [(9.0, 9.0, 4.0), (9.0, 1.0, 4.0), (1.0, 2.0, 4.0)])
def test_seven_phases_are_approached_from_above(limits):
    exact = float(three_limit_time(2.0, *limits))
    duration = free_path(line(2.0, *limits), 16).motion.duration
    assert exact * (1 - 1e-6) <= duration <= exact * 1.02


@pytest.mark.parametrize(("limits", "end"), LIMITS_AND_ENDS)
def test_each_limit_in_turn(limits, end):
    problem = small(limits, end)
    found = free_path(problem, 4)
    verdict = judge(problem, found.motion)
    assert found.converged
    assert verdict.feasible, verdict.reasons
    assert verdict.worst_ratio == pytest.approx(1.0, abs=1e-5)
    assert verdict.waypoint_error.max() < 1e-7  # what the solver leaves of its equations
    assert found.stretch < 1.001


@pytest.mark.parametrize(("pieces", "room"), [((2, 4), 0.0), pytest.param((4, 8), 1e-4, marks=pytest.mark.slow)])
def test_more_pieces_and_looser_ends_are_faster(pieces, room):
    durations = {
        end: [free_path(small(EACH_LIMIT["all"], end), n).motion.duration for n in pieces] for end in EndCondition
    }
    for fewer, more in durations.values():
        assert fewer > more * (1 - room)
    smooth, rest, free = (durations[end][-1] for end in (EndCondition.SMOOTH, EndCondition.REST, EndCondition.FREE))
    assert smooth > rest > free


def test_it_beats_stopping_on_woodworking():
    found = free_path(woodworking(), 16)
    assert found.motion.duration == pytest.approx(3.36097, abs=2e-4)
    assert found.motion.duration < ruckig_stops(woodworking()).duration


def test_with_velocity_limits_only_the_straight_line_is_the_optimum():
    problem = woodworking(acceleration=INF)
    assert free_path(problem).motion.duration == pytest.approx(ruckig_stops(problem).duration)


def test_permuted_joints_and_shifted_positions_change_nothing():
    problem = small(EACH_LIMIT["all"])
    order = [2, 0, 1]
    limits = JointLimits(*(rate[order] for rate in problem.limits.rates))
    other = Problem("other", problem.waypoints[:, order] + 5.0, limits, problem.end)
    assert free_path(other, 4).motion.duration == pytest.approx(free_path(problem, 4).motion.duration, rel=1e-5)


def test_scaled_limits_scale_the_time():
    problem = small(EACH_LIMIT["all"])
    slower = Problem("slower", problem.waypoints, problem.limits.scaled(100.0), problem.end)
    assert free_path(slower, 4).motion.duration == pytest.approx(100 * free_path(problem, 4).motion.duration, rel=1e-6)


def test_the_plan():
    plan = FreePathNlp(4).plan(woodworking(), SETTINGS)
    assert plan.status is Status.FINISHED
    assert plan.iterations > 0
    assert plan.details["pieces"] == 4.0
    still = Problem("still", [[1.0], [1.0]], JointLimits([1.0]), allow_dwell=True)
    assert FreePathNlp().plan(still, SETTINGS).status is Status.NOT_APPLICABLE
    with pytest.raises(StudyError, match="nothing to move"):
        free_path(still)


def test_out_of_time_is_not_called_finished():
    problem = small(EACH_LIMIT["all"], n_waypoints=12)
    plan = FreePathNlp(48).plan(problem, RunSettings("cubic-spline", time_limit=0.2))
    assert plan.status in (Status.NOT_CONVERGED, Status.FAILED)
    assert "IPOPT" in plan.message


def test_pieces_must_be_positive():
    with pytest.raises(StudyError, match="at least 1, got 0"):
        free_path(woodworking(), 0)


@pytest.mark.parametrize(
    "problem", [small(EACH_LIMIT["all"], EndCondition.SMOOTH), woodworking()], ids=["jerk", "acceleration"]
)
def test_too_few_pieces_are_refused_with_the_reason(problem):
    """One piece per segment with smooth ends has more equations than unknowns; a motion of 77757 s once passed for one."""
    assert surplus(problem, 1) < 0 <= surplus(problem, 2)
    plan = FreePathNlp(1).plan(problem, SETTINGS)
    assert plan.status is Status.FAILED
    assert plan.motion is None
    assert "more equations than unknowns" in plan.message


def test_where_one_piece_is_enough_it_is_taken():
    problem = small(EACH_LIMIT["all"], EndCondition.REST)
    assert surplus(problem, 1) >= 0
    assert FreePathNlp(1).plan(problem, SETTINGS).status is Status.FINISHED


def test_an_absurdly_long_motion_is_a_failure(monkeypatch):
    problem = small(EACH_LIMIT["all"])
    astray = free_path(problem, 2)
    astray = replace(astray, motion=astray.motion.scaled(1e4))
    monkeypatch.setattr(free_path_nlp, "free_path", lambda *_: astray)
    plan = FreePathNlp(2).plan(problem, SETTINGS)
    assert plan.status is Status.FAILED
    assert "far faster" in plan.message


@pytest.mark.parametrize("order", range(3))
@pytest.mark.parametrize("planner", ["free_path", "ruckig_via", "quintic"])
def test_loosening_a_limit_never_lengthens(planner, order):
    problem, before = before_loosening(planner)
    rates = problem.limits.rates.copy()
    rates[order] *= 1.5
    looser = replace(problem, limits=JointLimits(*rates))
    assert fastest(planner, looser) <= before * (1 + 1e-6)


@pytest.mark.parametrize("waypoint", [1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3))])
@pytest.mark.parametrize("limits", ["acceleration binds", pytest.param("all", marks=pytest.mark.slow)])
def test_without_a_waypoint_the_best_of_all_motions_is_no_longer(limits, waypoint):
    """The motion through all waypoints passes those that are left; 1e-3 is for what 16 pieces are above the best."""
    problem, free, via = through_all(limits)
    fewer = replace(problem, waypoints=np.delete(problem.waypoints, waypoint, axis=0))
    assert free_path(fewer, 16).motion.duration <= free * (1 + 1e-3)
    assert fastest("ruckig_via", fewer) <= via * (1 + 1e-3)
    assert lower_bound(fewer) <= via


@cache
def through_all(limits):
    """A problem of five waypoints, and the durations of two planners on it."""
    problem = small(EACH_LIMIT[limits], EndCondition.REST, seed=4, n_waypoints=5)
    return problem, free_path(problem, 16).motion.duration, fastest("ruckig_via", problem)


@cache
def before_loosening(planner):
    """A problem, and the duration of a planner on it."""
    problem = small(EACH_LIMIT["all"], EndCondition.SMOOTH)
    return problem, fastest(planner, problem)


def fastest(planner, problem):
    if planner == "free_path":
        return free_path(problem, 8).motion.duration
    if planner == "ruckig_via":
        return ruckig_via(problem)[0].duration
    return QuinticNlp().plan(problem, SETTINGS).motion.duration
