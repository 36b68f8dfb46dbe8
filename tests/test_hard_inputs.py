"""Problems at the edges of what is allowed: every planner solves them or says why not, and the judge agrees."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from study import EndCondition, JointLimits, Problem, StudyError, judge, plan
from study.planning import RunSettings, usual_settings
from study.registry import peer_names, planner_named, planner_names, unavailable_planners
from study.testing.stress import CRASH, ENDS, FEASIBLE, REASON, WRONG, Attempt, endure, problem_number, torture

QUICK = ("casadi-nlp", "ruckig-stops", "toppra", "golds-pso", "random-search")
ALWAYS = ("casadi-nlp", "ruckig-stops")


def walk(n_waypoints, n_joints, seed=0, size=1.0):
    return size * np.cumsum(np.random.default_rng(seed).uniform(-1, 1, (n_waypoints, n_joints)), axis=0)


def limits(n_joints, velocity=1.0, acceleration=2.0, jerk=np.inf):
    return JointLimits(*(np.full(n_joints, rate) for rate in (velocity, acceleration, jerk)))


def near(gap):
    points = walk(6, 3)
    points[3] = points[2] + gap
    return points


HARD = {
    "2 waypoints": Problem("p", walk(2, 3), limits(3)),
    "2 waypoints, jerk": Problem("p", walk(2, 3), limits(3, jerk=30.0), EndCondition.REST),
    "200 waypoints": Problem("p", walk(200, 2), limits(2)),
    "1 joint": Problem("p", walk(5, 1), limits(1)),
    "14 joints": Problem("p", walk(5, 14), limits(14)),
    "a joint that does not move": Problem("p", np.column_stack([walk(5, 2), np.full(5, 0.3)]), limits(3)),
    "a joint that does not move and has no limit": Problem(
        "p", np.column_stack([walk(5, 1), np.zeros(5)]), JointLimits(np.array([1.0, np.inf]), np.array([2.0, np.inf]))
    ),
    "a joint that waits": Problem("p", np.array([[0.0, 0], [1, 1], [2, 1], [3, 1], [4, 0]]), limits(2)),
    "neighbours 1e-3 apart": Problem("p", near(1e-3), limits(3)),
    "neighbours 1e-6 apart": Problem("p", near(1e-6), limits(3)),
    "neighbours 1e-9 apart": Problem("p", near(1e-9), limits(3)),
    "there and back": Problem("p", np.array([[0.0], [1.0], [0.0], [1.0]]), limits(1)),
    "in a line": Problem("p", np.arange(8.0)[:, None] * [1.0, 2.0], limits(2)),
    "six orders of magnitude": Problem(
        "p",
        walk(5, 7),
        JointLimits(10.0 ** np.arange(-3.0, 4.0), 10.0 ** np.arange(4.0, -3.0, -1.0)),
    ),
    "microseconds": Problem("p", walk(5, 3), limits(3, 1e6, 2e12)),
    "microseconds, jerk": Problem("p", walk(5, 3), limits(3, 1e6, 2e12, 3e19)),
    "hours": Problem("p", walk(5, 3), limits(3, 1e-4, 2e-8)),
    "hours, jerk": Problem("p", walk(5, 3), limits(3, 1e-4, 2e-8, 3e-11)),
    "micrometres": Problem("p", walk(5, 3, size=1e-6), limits(3, 1e-6, 2e-6)),
    "kilometres": Problem("p", walk(5, 3, size=1e3), limits(3, 1e3, 2e3)),
    "far from zero": Problem("p", 1e4 + walk(5, 3), limits(3)),
    "only jerk": Problem("p", walk(5, 2), JointLimits(np.full(2, np.inf), jerk=np.ones(2))),
    "only velocity": Problem("p", walk(5, 2), JointLimits(np.ones(2))),
    "limits of different kinds": Problem(
        "p",
        walk(5, 3),
        JointLimits(np.array([1, np.inf, np.inf]), np.array([np.inf, 2.0, np.inf]), np.array([np.inf, np.inf, 3.0])),
    ),
    "uneven ranges": Problem(
        "p",
        walk(5, 2),
        JointLimits(np.ones(2), 2 * np.ones(2), lower=walk(5, 2).min(axis=0), upper=np.array([9.0, 99.0])),
    ),
}


@pytest.mark.parametrize("planner", QUICK)
@pytest.mark.parametrize("problem", HARD.values(), ids=HARD)
def test_a_hard_problem_is_solved_or_refused_with_a_reason(problem, planner):
    given = replace(usual_settings(problem), evaluations=200, population=20, time_limit=20.0)
    answer = planner_named(planner).plan(problem, given)
    if answer.motion is None:
        assert answer.message
        assert planner == "toppra" or (planner, problem) == ("ruckig-stops", HARD["six orders of magnitude"])
        return
    reasons = judge(problem, answer.motion).reasons
    allowed = {"toppra": ("jerk", "acceleration", "leaves"), "ruckig-stops": ()}.get(planner, ("leaves",))
    assert not [reason for reason in reasons if not any(word in reason for word in allowed)]


@pytest.mark.parametrize("problem", HARD.values(), ids=HARD)
def test_auto_always_finds_a_feasible_motion(problem):
    planned = plan(problem, settings=replace(usual_settings(problem), time_limit=3.0))
    assert planned.feasible, planned.reason


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("planner", ALWAYS)
def test_slower_limits_only_make_the_same_motion_slower(planner, scale):
    problem = Problem("p", walk(6, 3), limits(3, jerk=20.0))
    slower = Problem("p", walk(6, 3), limits(3, jerk=20.0).scaled(scale))
    one, other = (
        judge(p, planner_named(planner).plan(p, usual_settings(p)).motion).duration for p in (problem, slower)
    )
    assert other == pytest.approx(scale * one, rel=1e-5)


numbers = st.floats(-10, 10, allow_nan=False).map(lambda value: round(value, 3))


@st.composite
def problems(draw):
    n_joints, n_waypoints = draw(st.integers(1, 4)), draw(st.integers(2, 7))
    rows = draw(
        st.lists(st.lists(numbers, min_size=n_joints, max_size=n_joints), min_size=n_waypoints, max_size=n_waypoints)
    )
    waypoints = np.array(rows)
    keep = np.append(True, (np.diff(waypoints, axis=0) != 0).any(axis=1))
    if keep.sum() < 2:
        waypoints, keep = np.array([[0.0] * n_joints, [1.0] * n_joints]), np.array([True, True])
    rates = 10.0 ** np.array(draw(st.lists(st.floats(-2, 2), min_size=3 * n_joints, max_size=3 * n_joints)))
    rates = rates.reshape(3, n_joints)
    rates[draw(st.integers(1, 3)) :] = np.inf
    return Problem("drawn", waypoints[keep], JointLimits(*rates), EndCondition.REST)


INSTALLED = [name for name in planner_names() if name not in {*unavailable_planners(), *peer_names()}]
EXPENSIVE = {
    "bspline-nlp",
    "certified",
    "copp",
    "free-path-nlp",
    "quintic-nlp",
    "ruckig-via",
    "topp3-nlp",
}


@pytest.mark.parametrize(
    "planner", [pytest.param(name, marks=[pytest.mark.slow] if name in EXPENSIVE else []) for name in INSTALLED]
)
@pytest.mark.timeout(1200)
@given(problem=problems())
@settings(max_examples=6, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
def test_every_answer_passes_the_judge_or_says_why_not(planner, problem):
    chosen = RunSettings("cubic-spline", evaluations=100, population=20, formulation="scaled", time_limit=20.0)
    if planner.startswith("cma-es") and problem.n_segments == 1:
        with pytest.raises(StudyError, match="at least 2 dimensions"):
            planner_named(planner).plan(problem, chosen)
        return
    answer = planner_named(planner).plan(problem, chosen)
    if answer.motion is None:
        assert answer.message
        assert planner not in ALWAYS
        assert not planner_named(planner).stochastic
        return
    verdict = judge(problem, answer.motion)
    if planner.startswith("toppra") and np.isfinite(problem.limits.jerk).any():
        assert all("jerk" in reason or "jumps" in reason for reason in verdict.reasons), verdict.reasons
        return
    assert verdict.feasible, verdict.reasons


def test_some_random_problems_for_the_quick_planners():
    outcomes = [
        endure(Attempt(name, 0, k, 20.0)) for k in range(4) for name in ("casadi-nlp", "ruckig-stops", "toppra")
    ]
    assert not [o for o in outcomes if o.kind in (WRONG, CRASH)]
    stops = [o for o in outcomes if o.attempt.planner == "ruckig-stops"]
    assert all(o.kind == FEASIBLE or "does not know" in o.sentence for o in stops)
    assert sum(o.kind == FEASIBLE for o in stops) > len(stops) / 3
    assert all(o.sentence for o in outcomes if o.kind != FEASIBLE)


def test_random_problems_do_not_depend_on_each_other():
    alone, again = problem_number(3, 17), problem_number(3, 17)
    assert (alone.waypoints == again.waypoints).all()
    assert alone.name == "random 3/17"
    assert not np.array_equal(problem_number(3, 18).waypoints, alone.waypoints)


def test_the_command_prints_a_count_for_every_planner(study_command):
    ended = study_command("torture", "--problems", 2, "--planners", "ruckig-stops,toppra", "--jobs", 1)
    assert ended.returncode == 0, ended.stderr
    for word in ("ruckig-stops", "toppra", *ENDS):
        assert word in ended.stdout


def test_a_planner_that_crashes_is_counted_and_ends_with_3(study_command, stubs):
    ended = study_command("torture", "--problems", 1, "--planners", "stub-raise,stub-crash", "--jobs", 1)
    assert ended.returncode == 3, ended.stderr
    assert "KeyError" in ended.stdout
    assert ended.stdout.count("crash: stub-") == 2


@pytest.mark.slow
@pytest.mark.timeout(3000)
def test_two_hundred_random_problems_for_every_reference_planner():
    names = ("casadi-nlp", "ruckig-stops", "toppra", "free-path-nlp", "ruckig-via", "certified")
    counts = torture(names, 200, seed=1, time_limit=2.0, jobs=2)
    for name in names:
        assert counts[name].total() == 200
        assert counts[name][WRONG] == counts[name][CRASH] == 0
    assert counts["ruckig-stops"][FEASIBLE] + counts["ruckig-stops"][REASON] == 200


def test_free_ends_are_hard_for_nobody():
    problem = Problem("p", walk(5, 2), limits(2), EndCondition.FREE)
    assert plan(problem).feasible
