"""The certificate: its bounds against the NLP, random durations and the exact stretch."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain, count
from types import SimpleNamespace

import numpy as np
import pytest

from baselines.bounds import certified
from baselines.bounds import cubic_spline as _bounds_spline
from baselines.bounds.branch_bound import enclose, halves
from baselines.bounds.certified import GAP, Certified, certify, obstacle
from baselines.bounds.cubic_spline import Relaxation, spline_bound, velocity_ranges
from baselines.bounds.poly353 import Bounds353, peak_instants
from baselines.segment_times.nlp import optimise
from baselines.units import dimensionless, largest_steps
from study import JointLimits, Problem, deadline, judge
from study.cases.library import load_case
from study.curves import CURVES
from study.deadline import NEVER, Deadline
from study.formulation import Scaled
from study.planning import RunSettings, Status
from study.supervisor import supervised
from tests.helpers.segment_problems import WOODWORKING, random_problem


@pytest.mark.parametrize("part", [WOODWORKING, *(WOODWORKING.joint(j) for j in range(4))], ids=lambda p: p.name)
def test_nlp_and_certificate_agree_on_woodworking(part: Problem) -> None:
    certificate, nlp = certify(part), optimise(part, "poly353").durations.sum()
    assert certificate.finished
    assert certificate.lower <= certificate.upper <= certificate.lower * (1 + 2e-6)
    assert nlp == pytest.approx(certificate.upper, rel=1e-6)
    assert nlp >= certificate.lower


@pytest.mark.parametrize("rates", [(1.0, 2.0, 8.0), (1.0, np.inf, np.inf), (1e3, 1.0, 1e5), (1e3, 1e3, 1.0)])
@pytest.mark.parametrize("seed", range(3))
def test_nothing_beats_the_lower_bound(seed: int, rates: tuple[float, float, float]) -> None:
    problem = random_problem(seed, 4, 1 + seed, rates)
    certificate, scaled = certify(problem), Scaled(problem, CURVES["poly353"])
    assert certificate.finished
    assert judge(problem, CURVES["poly353"].motion(problem.waypoints, certificate.durations)).feasible
    rng = np.random.default_rng(seed)
    around = certificate.durations * np.exp(np.geomspace(1e-4, 2.0, 20_000)[:, None] * rng.normal(size=(20_000, 3)))
    best = scaled(around).min()
    assert best >= certificate.lower
    assert best >= certificate.upper * (1 - GAP)


@pytest.mark.parametrize("seed", range(4))
def test_bounds_hold_on_boxes_of_every_size_and_close_on_points(seed: int) -> None:
    problem = random_problem(seed, 4, 1 + seed % 3, (1.0, 2.0, 8.0 if seed % 2 else np.inf))
    bounds, scaled = Bounds353(problem), Scaled(problem, CURVES["poly353"])
    rng = np.random.default_rng(seed)
    middle, half = rng.normal(size=(400, 2)), np.geomspace(1e-7, 1.5, 400)[:, None] * rng.uniform(0.3, 1, size=(400, 2))
    found = bounds(middle - half, middle + half)
    for _ in range(30):
        inside = middle + half * rng.uniform(-1, 1, size=half.shape)
        assert (found <= scaled(bounds.durations(inside))).all()
    exact = scaled(bounds.durations(middle))
    assert bounds(middle, middle) == pytest.approx(exact, rel=1e-6)
    slack = 1 - found / exact
    assert slack[:50].max() < 1e-4


def test_the_mean_of_two_limits_errs_by_the_square_of_the_width_at_the_optimum() -> None:
    """The reason why boxes do not cluster; without it this joint needs millions of them."""
    certificate = certify(WOODWORKING.joint(0))
    t1, t2, t3 = certificate.durations
    optimum = np.log([[t2 / t1, t2 / t3]])
    bounds = Bounds353(WOODWORKING.joint(0))
    slack = [certificate.lower - bounds(optimum - half, optimum + half)[0] for half in (4e-3, 2e-3)]
    assert slack[0] < 1e-2 * certificate.lower
    assert certificate.boxes < 5_000


def test_shortest_durations_are_honoured() -> None:
    bounded = replace(random_problem(1, 4, 1), duration_bounds=(2.5, 9.0))
    certificate = certify(bounded)
    assert certificate.finished
    assert certificate.durations.min() >= 2.5 * (1 - 1e-12)
    assert certificate.lower > certify(random_problem(1, 4, 1)).upper


def test_a_better_optimum_than_the_first_guess_is_found() -> None:
    """This joint has two optima of very different proportions, 6.061 s and 4.597 s."""
    waypoints = np.random.default_rng(1).normal(size=(4, 6))[:, :1]
    problem = Problem("two optima", waypoints, JointLimits([1.0], [2.0], [8.0]), duration_bounds=(0.01, 10))
    certificate = certify(problem)
    assert certificate.upper == pytest.approx(4.597133, abs=1e-5)
    assert optimise(problem, "poly353").durations.sum() == pytest.approx(certificate.upper, rel=1e-6)


def test_the_planner_reports_its_bounds() -> None:
    together = Certified().plan(WOODWORKING, RunSettings("poly353"))
    alone = Certified().plan(WOODWORKING, RunSettings("poly353", synchronisation="per-joint"))
    assert together.status is alone.status is Status.FINISHED
    assert judge(WOODWORKING, together.motion).feasible
    assert together.details["upper_bound"] == pytest.approx(7.47562, abs=1e-5)
    assert alone.lower_bound == pytest.approx(7.24009, abs=1e-4)
    assert alone.lower_bound <= together.details["upper_bound"]
    assert together.details["boxes"] >= 1


@pytest.mark.parametrize(
    ("curve", "n", "word"),
    [
        ("cubic-spline-smooth", 4, "cubic-spline-smooth"),
        ("poly353", 5, "4 waypoints"),
        ("cubic-spline", 8, "at most 6"),
    ],
)
def test_elsewhere_it_does_not_apply(curve: str, n: int, word: str) -> None:
    plan = Certified().plan(random_problem(0, n, 2), RunSettings(curve))
    assert plan.status is Status.NOT_APPLICABLE
    assert word in plan.message


def test_ill_posed_problems_are_refused() -> None:
    waypoints = np.array([[0.0], [1.0], [1.0], [2.0]])
    dwelling = Problem("dwell", waypoints, JointLimits([1.0]), duration_bounds=(0.0, 5.0), allow_dwell=True)
    assert "shrink to nothing" in obstacle(dwelling, "poly353")
    assert not obstacle(replace(dwelling, duration_bounds=(0.1, 5.0)), "poly353")
    waypoints = np.stack([np.arange(4.0), np.arange(4.0)], axis=1)
    unlimited = Problem("free", waypoints, JointLimits([1.0, np.inf]), duration_bounds=(0.0, 5.0))
    assert "no limit" in obstacle(unlimited, "poly353")


def test_a_budget_of_boxes_leaves_a_bound_that_holds() -> None:
    bounds, scaled = Bounds353(WOODWORKING), Scaled(WOODWORKING, CURVES["poly353"])
    found = enclose(
        bounds, lambda p: scaled(bounds.durations(p)), bounds.box(9.0), 9.0, gap=GAP, deadline=NEVER, most=20
    )
    assert not found.finished
    assert found.lower <= 7.47562 <= found.upper


def test_halves_cover_their_box() -> None:
    low, high = halves(np.array([[0.0, 1.0]]), np.array([[1.0, 5.0]]))
    assert sorted(zip(low.tolist(), high.tolist(), strict=True)) == [([0.0, 1.0], [1.0, 3.0]), ([0.0, 3.0], [1.0, 5.0])]


def test_peak_instants_include_the_highest_peak() -> None:
    rng = np.random.default_rng(0)
    for degree in (2, 3, 4):
        polynomials = rng.normal(size=(200, degree + 1))
        tau = np.linspace(0, 1, 2001)
        highest = np.abs(polynomials @ (tau[:, None] ** np.arange(degree + 1)).T).max(axis=1)
        at = peak_instants(polynomials)
        found = np.abs((at[..., None] ** np.arange(degree + 1) * polynomials[:, None]).sum(axis=-1)).max(axis=1)
        assert (found >= highest * (1 - 1e-5)).all()


def test_a_b_spline_is_enclosed_by_its_linear_programme() -> None:
    problem = load_case("ur5-bspline").problem
    plan = Certified().plan(problem, RunSettings("bspline"))
    assert plan.lower_bound == pytest.approx(11.70689, abs=1e-5)
    assert plan.details["upper_bound"] == pytest.approx(11.70725, abs=1e-5)
    assert plan.status is Status.NOT_CONVERGED
    assert "3.1e-05 of the time apart" in plan.message
    assert judge(problem, plan.motion).feasible


def test_the_five_segment_cubic_spline_is_enclosed_to_a_thousandth() -> None:
    problem = load_case("ur5-bspline-rest").problem
    plan = Certified().plan(problem, RunSettings("cubic-spline"))
    assert plan.details["upper_bound"] == pytest.approx(11.01696, abs=1e-4)
    assert 0.999 * 0.9999 <= plan.lower_bound / plan.details["upper_bound"] < 1
    assert judge(problem, plan.motion).feasible


@pytest.mark.parametrize("rates", [(1.0, 2.0, 8.0), (1.0, np.inf, np.inf), (1.0, 0.3, np.inf), (1.0, 1e3, 1.0)])
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_no_cubic_spline_beats_its_bound(seed: int, rates: tuple[float, float, float]) -> None:
    problem = replace(random_problem(seed, 4 + seed, 2, rates), duration_bounds=(0.05, 10.0))
    best = optimise(problem, "cubic-spline").durations
    total = float(best.sum())
    values = [spline_bound(problem, total, most)[0] for most in (1, 20, 100)]
    assert values[0] * (1 - 1e-9) <= values[1] <= values[2] * (1 + 1e-9)
    assert 0.95 * total < values[2] <= total
    scaled, rng = Scaled(problem, CURVES["cubic-spline"]), np.random.default_rng(seed)
    sample = best * np.exp(np.geomspace(1e-4, 1.5, 5000)[:, None] * rng.normal(size=(5000, len(best))))
    assert scaled(sample).min() >= values[2]
    # told of a slower motion only, it still stays below the optimum
    assert spline_bound(problem, 1.3 * total, 40)[0] <= total


@pytest.mark.parametrize("rates", [(1.0, 2.0, 8.0), (1.0, 1e3, 1e5), (1e3, 1.0, 1e5), (1e3, 1e3, 1.0)])
def test_a_feasible_spline_is_never_relaxed_away(rates: tuple[float, float, float]) -> None:
    """Boxes around feasible durations, of every size: their programme has a solution that is no longer than they are."""
    problem = random_problem(5, 5, 2, rates)
    scaled, rng = Scaled(problem, CURVES["cubic-spline"]), np.random.default_rng(0)
    for width in np.geomspace(1e-3, 1.0, 25):
        durations = scaled.durations(rng.uniform(0.6, 1.6, size=(1, 4)))[0]
        dimless, units = dimensionless(problem, durations.sum() / 4, largest_steps(problem))
        low = durations * np.exp(-width * rng.uniform(size=4)) / units.time
        high = durations * np.exp(width * rng.uniform(size=4)) / units.time
        value = Relaxation(dimless, low, high).solve()
        assert value <= durations.sum() / units.time * (1 + 1e-9)
        assert value >= low.sum()
        velocities = CURVES["cubic-spline"].motion(problem.waypoints, durations)
        at = velocities(velocities.waypoint_times, 1) * units.time / units.length
        lowest, highest = velocity_ranges(dimless, 1 / high, 1 / low)
        assert (lowest - 1e-9 <= at).all()
        assert (at <= highest + 1e-9).all()


def test_a_deadline_ends_the_spline_s_boxes_and_the_bound_so_far_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = replace(random_problem(0, 5, 2, (1.0, 2.0, 8.0)), duration_bounds=(0.05, 10.0))
    total = float(optimise(problem, "cubic-spline").durations.sum())
    clock, values = count(), []
    monkeypatch.setattr(deadline, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    whole, boxes = spline_bound(problem, total)
    for cuts in (0, 3, 20):
        with supervised() as watch:
            value, done = spline_bound(problem, total, deadline=Deadline(next(clock) + cuts))
        assert watch.deadline_reached
        assert done <= 2 * cuts < boxes
        values.append(value)
    shortest = _bounds_spline.shortest_durations(problem).sum()
    assert values[0] == pytest.approx(shortest, rel=2e-5)
    assert shortest < values[1] <= values[2] <= whole < total
    with supervised() as watch:
        assert spline_bound(problem, total, deadline=Deadline(next(clock) + 1e6)) == (whole, boxes)
    assert not watch.deadline_reached


@pytest.mark.parametrize("curve", ["poly353", "cubic-spline", "bspline"])
def test_joints_whose_turn_comes_too_late_are_enclosed_without_a_solver(
    curve: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The clock stands still for two looks, until the first joint's turn, and is past the limit from then on."""
    problem, asked, clock = random_problem(2, 4, 3), [], chain([0.0, 0.0], count(1e9))
    monkeypatch.setattr(certified, "optimise", lambda *args, **rest: asked.append(args) or optimise(*args, **rest))
    monkeypatch.setattr(deadline, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    with supervised() as watch:
        plan = Certified().plan(problem, RunSettings(curve, synchronisation="per-joint", time_limit=30.0))
    assert watch.deadline_reached
    assert len(asked) == 1
    assert plan.status is Status.NOT_CONVERGED
    assert "of the time apart" in plan.message
    assert judge(problem, plan.motion).feasible
    assert 0 < plan.lower_bound < plan.details["upper_bound"]
