"""The segment-time NLP against known optima, other optimisers and the laws that optima obey."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from baselines.segment_times import model
from baselines.segment_times.bspline_curve import velocity_bound
from baselines.segment_times.critical_points import NEAR, Critical, Slots, polynomial_critical
from baselines.segment_times.nlp import CasadiNlp, optimise
from baselines.segment_times.starts import starts
from study import EndCondition, JointLimits, Problem, StudyError, judge
from study.curves import CURVES
from study.formulation import Scaled
from study.planning import RunSettings, Status, usual_settings
from tests.helpers.segment_problems import BINDING, WOOD, WOODWORKING, random_problem, shape


def total(problem: Problem, curve: str) -> float:
    plan = CasadiNlp().plan(problem, RunSettings(curve))
    assert plan.status is Status.FINISHED, plan.message
    verdict = judge(replace(problem, end=EndCondition.FREE), plan.motion)
    # at the ends the clamped spline and the B-spline step; only the rates belong to this planner
    assert verdict.ratios.max() <= 1 + 1e-9
    assert plan.details["stretch"] <= 1 + 1e-7
    return verdict.duration


def test_woodworking_together_takes_7_47562_seconds() -> None:
    assert total(WOODWORKING, "poly353") == pytest.approx(7.47562, abs=1e-5)


@pytest.mark.parametrize(("joint", "seconds"), list(enumerate([7.24009, 7.19064, 6.88037, 6.86719])))
def test_woodworking_joints_alone(joint: int, seconds: float) -> None:
    assert total(WOODWORKING.joint(joint), "poly353") == pytest.approx(seconds, abs=1e-5)


def test_per_joint_takes_the_longest_duration_of_every_segment() -> None:
    plan = CasadiNlp().plan(WOODWORKING, RunSettings("poly353", synchronisation="per-joint"))
    alone = [optimise(WOODWORKING.joint(j), "poly353").durations for j in range(4)]
    assert plan.durations == pytest.approx(np.max(alone, axis=0), rel=1e-9)


@pytest.mark.parametrize("binding", BINDING)
@pytest.mark.parametrize("curve", CURVES)
def test_each_limit_binds_in_turn(curve: str, binding: str) -> None:
    problem = random_problem(1, *shape(curve), BINDING[binding])
    plan = CasadiNlp().plan(problem, RunSettings(curve))
    ratios = judge(problem, plan.motion).ratios.max(axis=1)
    expected = list(BINDING).index(binding)
    assert ratios[expected] == pytest.approx(1.0, abs=1e-8)
    assert np.delete(ratios, expected).max() < 0.99


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("curve", CURVES)
def test_no_local_search_on_the_stretched_total_improves_it(curve: str, seed: int) -> None:
    """An optimiser of another kind, on another form of the problem, with another code for the peaks."""
    problem = random_problem(seed, 4, 2)
    scaled, answer = Scaled(problem, CURVES[curve]), optimise(problem, curve)
    rng = np.random.default_rng(seed)
    options = {"xatol": 1e-9, "fatol": 1e-11, "maxiter": 150, "maxfev": 150}
    ends = [
        minimize(
            lambda y: scaled(np.exp(y)[None])[0],
            np.log(answer.durations) + offset,
            method="Nelder-Mead",
            options=options,
        )
        for offset in (np.zeros(len(answer.durations)), 0.05 * rng.normal(size=len(answer.durations)))
    ]
    assert min(end.fun for end in ends) >= answer.durations.sum() * (1 - 1e-7)


@pytest.mark.parametrize("curve", CURVES)
def test_started_from_a_search_it_never_ends_slower(curve: str) -> None:
    problem = random_problem(2, *shape(curve))
    rng = np.random.default_rng(0)
    scaled = Scaled(problem, CURVES[curve])
    for _ in range(3):
        first = rng.uniform(0.8, 1.4, size=problem.n_segments)
        answer = optimise(problem, curve, count=1, first=first)
        assert answer.durations.sum() <= scaled(first[None])[0] * (1 + 1e-9)


@pytest.mark.parametrize("curve", CURVES)
def test_limits_scaled_by_powers_scale_time(curve: str) -> None:
    problem = random_problem(3, *shape(curve))
    slower = replace(problem, limits=problem.limits.scaled(1.7), duration_bounds=(1.7e-3, 17.0))
    assert total(slower, curve) == pytest.approx(1.7 * total(problem, curve), rel=1e-7)


@pytest.mark.parametrize("curve", CURVES)
def test_order_of_joints_direction_of_time_and_origin_do_not_matter(curve: str) -> None:
    problem = random_problem(4, *shape(curve))
    expected = total(problem, curve)
    for waypoints in (problem.waypoints[:, ::-1], problem.waypoints[::-1], -problem.waypoints, problem.waypoints + 3.0):
        assert total(replace(problem, waypoints=waypoints), curve) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("curve", CURVES)
def test_shortest_durations_are_honoured(curve: str) -> None:
    problem = random_problem(5, *shape(curve))
    free = optimise(problem, curve).durations
    shortest = float(np.median(free))
    bound = optimise(replace(problem, duration_bounds=(shortest, 50.0)), curve).durations
    assert bound.min() >= shortest * (1 - 1e-9)
    assert bound.sum() > free.sum()


def test_the_linear_programme_is_a_bound_and_is_met_where_only_velocity_binds() -> None:
    slow = random_problem(6, 7, 3, (1.0, 1e3, 1e5))
    assert velocity_bound(slow) <= total(slow, "bspline") <= velocity_bound(slow) * 1.002
    tight = random_problem(6, 7, 3)
    plan = CasadiNlp().plan(tight, RunSettings("bspline"))
    assert plan.lower_bound == pytest.approx(velocity_bound(tight))
    sample = np.random.default_rng(0).uniform(0.8, 1.3, size=(300, 6))
    assert Scaled(tight, CURVES["bspline"])(sample).min() > plan.durations.sum() > velocity_bound(tight)


def test_same_seed_same_bytes_and_other_seeds_the_same_optimum() -> None:
    problem = random_problem(7, 6, 3)
    runs = [CasadiNlp().plan(problem, RunSettings("cubic-spline", seed=seed)) for seed in (0, 0, 1)]
    assert runs[0].durations.tobytes() == runs[1].durations.tobytes()
    assert runs[2].durations.sum() == pytest.approx(runs[0].durations.sum(), rel=1e-8)


@pytest.mark.parametrize("curve", ["poly353", "cubic-spline"])
def test_a_joint_that_rests_costs_nothing(curve: str) -> None:
    problem = random_problem(8, 4, 2)
    still = replace(problem, waypoints=problem.waypoints * [1.0, 0.0])
    assert total(still, curve) == pytest.approx(total(problem.joint(0), curve), rel=1e-7)


def test_no_time_means_no_motion_or_an_unfinished_one() -> None:
    plan = CasadiNlp().plan(random_problem(9, 6, 3), RunSettings("cubic-spline", time_limit=1e-9))
    assert plan.status is not Status.FINISHED
    assert "time limit" in plan.message


def test_two_waypoints_with_smooth_ends_are_declined_in_one_sentence() -> None:
    problem = Problem(
        "move", [[0.0, 0.0], [1.0, 0.5]], JointLimits([1.0] * 2, [2.0] * 2, [20.0] * 2), EndCondition.SMOOTH
    )
    plan = CasadiNlp().plan(problem, usual_settings(problem))
    assert plan.status is Status.FAILED
    assert plan.message == "the smooth cubic spline needs at least 3 waypoints, got 2; use ruckig-stops"


def test_wrong_words_are_answered() -> None:
    with pytest.raises(StudyError, match="did you mean 'shared'"):
        CasadiNlp().plan(WOODWORKING, RunSettings("poly353", synchronisation="share"))
    assert "exactly 4 waypoints" in CasadiNlp().plan(random_problem(0, 5, 2), RunSettings("poly353")).message
    assert "no curve" in CasadiNlp().plan(WOODWORKING, RunSettings("spline")).message


def test_the_package_needs_no_casadi() -> None:
    code = "import sys, baselines; sys.exit('casadi' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_starts_are_feasible_and_the_first_ignores_the_seed() -> None:
    problem = random_problem(10, 5, 2)
    scaled = Scaled(problem, CURVES["bspline"])
    first, second = (starts(problem, CURVES["bspline"], 3, seed) for seed in (0, 1))
    assert first[0] == pytest.approx(second[0])
    for guess in first + second:
        assert scaled(guess[None])[0] <= guess.sum()


def test_slots_follow_a_peak_and_keep_what_is_not_met_again() -> None:
    slots = Slots((1, 1, 2))
    slots.refresh(Critical(np.array([[[0.5]]]), np.array([[[1.2]]]), np.array([[[-0.1]]])), 0.9, corrected=True)
    slots.refresh(
        Critical(np.array([[[0.5 + NEAR / 2]]]), np.array([[[1.1]]]), np.array([[[-0.2]]])), 0.9, corrected=True
    )
    assert slots.points[0, 0, 0] == pytest.approx(0.5 + NEAR / 2)
    assert np.isnan(slots.points[0, 0, 1])
    slots.refresh(Critical(np.array([[[0.0]]]), np.array([[[-1.1]]]), np.array([[[0.0]]])), 0.9, corrected=True)
    assert slots.points[0, 0].tolist() == pytest.approx([0.5 + NEAR / 2, 0.0])
    assert slots.corrections[0, 0].tolist() == [0.0, 0.0]


def test_only_true_peaks_bend() -> None:
    motion = CURVES["poly353"].motion(WOOD, np.array([2.0, 2.5, 2.2]))
    for order in (1, 2):
        critical = polynomial_critical(WOODWORKING, motion, order)
        step = 1e-5
        starts_, widths = motion.knots[:-1, None, None], np.diff(motion.knots)[:, None, None]
        for piece, joint, k in np.argwhere(critical.corrections != 0):
            at = critical.points[piece, joint, k] + np.array([-step, 0.0, step])
            rate = (
                motion(starts_[piece, 0] + at * widths[piece, 0], order)[:, joint]
                / WOODWORKING.limits.rates[order - 1, joint]
            )
            assert rate[2] - rate[0] == pytest.approx(0.0, abs=1e-7)
            curvature = (rate[2] - 2 * rate[1] + rate[0]) / step**2
            assert critical.corrections[piece, joint, k] == pytest.approx(0.5 / curvature, rel=1e-3)


def test_only_the_models_used_last_are_kept(monkeypatch):
    monkeypatch.setattr(model, "_MODELS", {})
    monkeypatch.setattr(model, "MOST_MODELS", 2)
    for n_waypoints in (3, 4, 3, 5, 3):
        problem = Problem("small", np.arange(n_waypoints)[:, None] % 2, JointLimits([1.0], [1.0]))
        assert CasadiNlp().plan(problem, RunSettings("cubic-spline")).motion is not None
    assert len(model._MODELS) == 2
