"""The compiled kernels against their NumPy forms, to rounding, and the choice between the two."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study import engine
from study.curves import CURVES
from study.curves.compiled import with_engine
from study.errors import StudyError
from study.formulation import Penalty
from study.planning import Meter
from study.problem import Floats
from study.registry import planner_named
from study.search.gsa import GSA, half_words
from study.search.loop import minimise
from study.search.pso import PSO, VelocityUpdate
from study.search.sca import SCA
from study.search.state import Box, Search

pytest.importorskip("numba")

from study.curves.compiled import peaks as compiled  # after the check that numba is there
from study.curves.compiled import poly353 as compiled_353
from study.search.compiled import CompiledGSA, CompiledSCA, CompiledVelocityUpdate, compiled_variant

SHAPES = {"poly353": (4, 6), "cubic-spline": (20, 5), "bspline": (7, 3)}
steps = st.one_of(
    st.floats(-3.0, 3.0).map(lambda x: x if abs(x) > 1e-60 else 0.0), st.sampled_from([0.0, 1.0, -1.0, 1e-9, -1e-9])
)
ratios = st.floats(-2.5, 2.5)


def agree(name: str, waypoints: Floats, durations: Floats, orders: tuple[int, ...]) -> None:
    ours = compiled.PEAKS[name](waypoints, durations, orders)
    numpy = CURVES[name].peaks(waypoints, durations, orders)
    assert ours.shape == numpy.shape
    np.testing.assert_allclose(ours, numpy, rtol=1e-12, atol=0)


@pytest.mark.parametrize("orders", [(1,), (2,), (3,), (1, 2), (1, 2, 3), (3, 1), (2, 1)])
@pytest.mark.parametrize("name", SHAPES)
def test_agrees_with_numpy(name: str, orders: tuple[int, ...]) -> None:
    rng = np.random.default_rng(3)
    n_waypoints, n_joints = SHAPES[name]
    spread = 0.2 if name == "bspline" else 1.0
    durations = np.exp(spread * rng.normal(size=(301, n_waypoints - 1)))
    agree(name, rng.normal(size=(n_waypoints, n_joints)), durations, orders)


@pytest.mark.parametrize("name", ["poly353", "cubic-spline", "bspline"])
def test_agrees_for_columns_and_single_candidates(name: str) -> None:
    rng = np.random.default_rng(4)
    n_waypoints, n_joints = SHAPES[name]
    transposed = np.asfortranarray(rng.uniform(0.9, 1.2, (5, n_waypoints - 1)))
    agree(name, rng.normal(size=(n_waypoints, n_joints)), transposed, (1, 2))
    agree(name, rng.normal(size=(n_waypoints, 1)), transposed[:1], (1, 2))


@given(st.tuples(steps, steps, steps), st.tuples(ratios, ratios))
@settings(max_examples=400, deadline=None)
def test_353_agrees_for_any_steps_and_ratios(moves: tuple[float, ...], logs: tuple[float, ...]) -> None:
    waypoints = np.concatenate([[0.0], np.cumsum(moves)])[:, None]
    agree("poly353", waypoints, np.exp([[logs[0], 0.0, logs[1]]]), (1, 2, 3))


@given(st.floats(0.01, 0.99), st.floats(-14.0, -2.0), st.floats(-2.0, 3.0), st.sampled_from([-1.0, 1.0]))
@settings(max_examples=400, deadline=None)
def test_353_agrees_near_double_roots(double: float, gap: float, other: float, sign: float) -> None:
    """Shift a middle quintic's acceleration until it nearly touches zero at a turning point: roots 10^gap apart."""
    first, last, t = (other, sign, np.array([[0.6 + double, 1.0, 1.3 - 0.5 * double]]))
    touching = _touching_middle(first, last, t)
    for middle in touching:
        waypoints = np.cumsum([0.0, first, middle * (1.0 + sign * 10.0**gap), last])[:, None]
        agree("poly353", waypoints, t, (1, 2, 3))


def _touching_middle(first: float, last: float, t: Floats) -> list[float]:
    """Middle steps for which the acceleration's cubic has a double root: zeros of its discriminant, a quartic in the step."""

    def discriminant(middle: float) -> float:
        _, f, _, _ = compiled_353._quintic((first, middle, last), t[0, 1] / t[0, 0], t[0, 1] / t[0, 2])
        d, c, b, a = f
        return 18 * a * b * c * d - 4 * b**3 * d + b * b * c * c - 4 * a * c**3 - 27 * a * a * d * d

    grid = np.linspace(-2.0, 2.0, 5)
    quartic = np.polynomial.Polynomial.fit(grid, [discriminant(x) for x in grid], 4)
    return [float(r.real) for r in quartic.roots() if abs(r.imag) < 1e-6 * (1 + abs(r))]


def test_the_bracketing_loop_finds_what_the_steps_find() -> None:
    """The loop that finishes unsettled curves is seldom needed; it must give the same peaks wherever it is put to work."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        steps, t = rng.normal(size=3), np.exp(rng.normal(size=3))
        v, f, v2, _ = compiled_353._quintic(tuple(steps), t[1] / t[0], t[1] / t[2])
        peak = max(compiled_353._settle(v, f), abs(v[0]), abs(v2)) / t[1]
        waypoints = np.concatenate([[0.0], np.cumsum(steps)])[:, None]
        outer = 3 * max(abs(steps[0]) / t[0], abs(steps[2]) / t[2])
        assert max(peak, outer) == pytest.approx(CURVES["poly353"].peaks(waypoints, t[None], (1,))[0, 0, 0], rel=1e-12)


def test_few_curves_need_the_bracketing_loop() -> None:
    rng = np.random.default_rng(6)
    result = np.empty((2, 6, 20_000))
    finished = compiled_353.fill(rng.normal(size=(4, 6)), np.exp(2 * rng.normal(size=(20_000, 3))), result)
    assert finished < 120  # of 120 000


def test_infinite_where_the_b_spline_turns_back() -> None:
    durations = np.array([[1.0, 0.001, 1.0, 1.0, 0.001], np.ones(5)])
    peaks = compiled.PEAKS["bspline"](np.arange(6.0)[:, None], durations, (1, 2))
    assert np.isinf(peaks[0]).all()
    assert np.isfinite(peaks[1]).all()


def test_refuses_five_waypoints() -> None:
    with pytest.raises(StudyError, match="exactly 4 waypoints, got 5"):
        compiled.peaks_353(np.zeros((5, 1)), np.ones((1, 4)))


def test_engine_follows_variable_and_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(engine.VARIABLE, raising=False)
    assert engine.chosen(2000) == engine.NUMPY
    assert engine.chosen(engine.WORTHWHILE) == engine.NUMBA
    assert engine.chosen() == engine.NUMBA
    monkeypatch.setenv(engine.VARIABLE, "numba")
    assert engine.chosen(1) == engine.NUMBA
    assert with_engine(CURVES["poly353"], 1).peaks is compiled.peaks_353
    assert with_engine(CURVES["cubic-spline-smooth"], 1) == CURVES["cubic-spline-smooth"]
    monkeypatch.setenv(engine.VARIABLE, "numpy")
    assert with_engine(CURVES["poly353"]) is CURVES["poly353"]
    monkeypatch.setenv(engine.VARIABLE, "fortran")
    with pytest.raises(StudyError, match="fortran"):
        engine.chosen()


def test_engine_without_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "installed", lambda: False)
    monkeypatch.setenv(engine.VARIABLE, "numba")
    assert engine.chosen() == engine.NUMPY
    assert engine.described() == "NumPy"


def test_importing_the_command_does_not_import_numba() -> None:
    code = "import sys, study.cli.main, study.planners.segment_times; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_objective_agrees() -> None:
    from study.cases.library import load_case

    problem = load_case("woodworking").problem
    durations = np.random.default_rng(7).uniform(*problem.duration_bounds, (200, problem.n_segments))
    values = [
        Penalty(problem, CURVES["poly353"]).__call__(durations),
        Penalty(problem, with_engine(CURVES["poly353"])).__call__(durations),
    ]
    np.testing.assert_allclose(values[0], values[1], rtol=1e-12)


SEARCHES: dict[str, Search[Any]] = (
    {
        name: planner_named(name).search
        for name in ("pso", "cfpso", "dynamic-adaptive-pso", "chaotic-spso", "gsa", "sca")
    }
    | {
        "sca, reflected": SCA(bounds="reflect"),
    }
    | {
        f"pso, {velocity}": PSO(velocity=velocity)
        for velocity in (
            VelocityUpdate(0.3, "absolute"),
            VelocityUpdate(bounds="reflect"),
            VelocityUpdate(np.inf, bounds="stop"),
        )
    }
)


def wavy(x: Floats) -> Floats:
    return np.cos(9.0 * x).sum(axis=1) + (x * x).sum(axis=1)


@pytest.mark.parametrize("name", SEARCHES)
@pytest.mark.parametrize(("population", "dimensions"), [(50, 3), (100, 5), (7, 1)])
def test_compiled_searches_give_numpys_bits(
    name: str, population: int, dimensions: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    meters = []
    for wish in (engine.NUMPY, engine.NUMBA):
        monkeypatch.setenv(engine.VARIABLE, wish)
        meter = Meter(wavy, 40 * population - 3)
        box = Box(np.linspace(-3.0, -1.0, dimensions), np.full(dimensions, 2.0))
        minimise(SEARCHES[name], meter, box, population, np.random.default_rng(3))
        meters.append(meter)
    np.testing.assert_array_equal(meters[0].history, meters[1].history)
    np.testing.assert_array_equal(meters[0].incumbents, meters[1].incumbents)


def test_swarms_that_fly_and_two_others_have_compiled_steps() -> None:
    assert type(compiled_variant(SCA(amplitude=3.0))) is CompiledSCA
    assert isinstance(compiled_variant(GSA(gravity=9.0)), CompiledGSA)
    assert compiled_variant(GSA(gravity=9.0)).gravity == 9.0
    for name in ("pso", "cfpso", "dynamic-adaptive-pso", "chaotic-spso"):
        compiled_search = compiled_variant(SEARCHES[name])
        assert type(compiled_search) is type(SEARCHES[name])
        assert isinstance(compiled_search.velocity, CompiledVelocityUpdate)
        assert compiled_variant(compiled_search) is compiled_search
    woa = planner_named("woa").search
    assert compiled_variant(woa) is woa


@given(st.integers(1, 40), st.integers(1, 6), st.integers(1, 40), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_attraction_has_numpys_bits(n: int, dimensions: int, pullers: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    columns = rng.normal(size=(dimensions, n))
    heavy = columns.T[rng.integers(n, size=pullers)]  # each at no distance from itself
    inputs = columns, heavy, rng.random(pullers), half_words(rng, (pullers, dimensions, n))
    np.testing.assert_array_equal(GSA.attraction(*inputs), CompiledGSA.attraction(*inputs))
