"""Benchmark functions: known optima, printed readings, shifts and rotations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import optimize

from study.errors import StudyError
from study.testfunctions import benchmarks_of, formulas, random_rotation, rotated, shifted

PAPERS = {"woodworking-golds-pso": 8, "ur5-smwoa": 15, "puma560-chaotic-spso": 6}
ALL = [
    pytest.param(function, id=f"{paper} {reading} {function.label}")
    for paper in PAPERS
    for reading in ("standard", "as-printed")
    for function in benchmarks_of(paper, reading)
]


def exact(function, points):
    """Values without noise."""
    return function.formula(np.atleast_2d(points))


def by_label(paper, label, reading="standard"):
    return next(f for f in benchmarks_of(paper, reading) if f.label == label)


@pytest.mark.parametrize("paper", PAPERS)
def test_papers_have_their_functions_in_order(paper):
    for reading in ("standard", "as-printed"):
        labels = [function.label for function in benchmarks_of(paper, reading)]
        assert labels == [f"F{i + 1}" for i in range(PAPERS[paper])]


@pytest.mark.parametrize("function", ALL)
def test_the_known_minimum_is_taken_and_nothing_is_below_it(function):
    if function.minimum is None:
        assert function.minimiser is None
        pytest.skip("printed without a minimum")
    assert exact(function, function.minimiser)[0] == pytest.approx(function.minimum, rel=1e-13, abs=2e-14)
    assert (function.minimiser >= function.lower).all()
    assert (function.minimiser <= function.upper).all()
    rng = np.random.default_rng(0)
    wide = function.lower + rng.random((4000, function.n_dimensions)) * (function.upper - function.lower)
    spread = 10.0 ** rng.uniform(-4, 0, (4000, 1))
    near = function.minimiser + spread * rng.standard_normal((4000, function.n_dimensions))
    near = np.clip(near, function.lower, function.upper)
    assert exact(function, np.concatenate([wide, near])).min() >= function.minimum - 1e-12 * max(
        1.0, abs(function.minimum)
    )


@pytest.mark.parametrize("function", ALL)
def test_a_population_is_its_rows(function):
    rng = np.random.default_rng(1)
    points = function.lower + rng.random((5, function.n_dimensions)) * (function.upper - function.lower)
    together = exact(function, points)
    assert together.shape == (5,)
    np.testing.assert_allclose(together, [exact(function, point)[0] for point in points], rtol=1e-12)


@pytest.mark.parametrize("label", ["F11", "F12", "F13", "F14", "F15"])
def test_fixed_dimension_minima_agree_with_a_local_search(label):
    function = by_label("ur5-smwoa", label)
    start = function.minimiser + 0.01
    found = optimize.minimize(
        lambda x: exact(function, x)[0], start, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-15}
    )
    assert found.fun == pytest.approx(function.minimum, rel=1e-9)


def test_values_by_hand():
    two = np.array([[1.0, -2.0]])
    assert formulas.schwefel_222(two)[0] == 5.0
    assert formulas.schwefel_12(two)[0] == 2.0
    assert formulas.schwefel_221(two)[0] == 2.0
    assert formulas.rosenbrock(two)[0] == 900.0
    assert formulas.step(np.array([[0.4, -0.6]]))[0] == 1.0
    assert formulas.step_without_floor(np.array([[0.5, -0.5]]))[0] == 1.0
    assert formulas.quartic(two)[0] == 33.0
    assert formulas.rastrigin(two)[0] == pytest.approx(5.0)
    assert formulas.griewank(np.array([[np.pi, 0.0]]))[0] == pytest.approx(np.pi**2 / 4000 + 2)
    assert formulas.alpine(np.array([[np.pi]]))[0] == pytest.approx(0.1 * np.pi)
    assert formulas.wall(np.array([[12.0, -7.0, 3.0]]), 5.0, 2.0)[0] == 2 * (7**4 + 2**4)
    assert formulas.branin(np.array([[-np.pi, 12.275]]))[0] == pytest.approx(0.39788735772973816)
    assert formulas.goldstein_price(np.array([[0.0, 0.0]]))[0] == 600.0


def test_peer_functions_agree():
    pymoo = pytest.importorskip("pymoo.problems", reason="the peer package pymoo is not installed")
    points = np.random.default_rng(0).uniform(-3, 3, (20, 6))
    for name, ours in {
        "ackley": formulas.ackley,
        "griewank": formulas.griewank,
        "rastrigin": formulas.rastrigin,
        "rosenbrock": formulas.rosenbrock,
    }.items():
        theirs = pymoo.get_problem(name, n_var=6).evaluate(points, return_values_of=["F"])[:, 0]
        np.testing.assert_allclose(ours(points), theirs, rtol=1e-10, atol=1e-12)


def test_printed_readings_differ_where_the_print_does():
    point = np.linspace(-4.0, 4.0, 30)[None]
    far = np.full((1, 30), 20.0)
    wood, smwoa = "woodworking-golds-pso", "ur5-smwoa"
    assert exact(by_label(wood, "F3", "as-printed"), point)[0] == 16.0
    assert exact(by_label(wood, "F4", "as-printed"), np.zeros(30))[0] == 7.5
    assert exact(by_label(wood, "F8", "as-printed"), point)[0] == 0.0
    ackley, printed = by_label(smwoa, "F7"), by_label(smwoa, "F7", "as-printed")
    assert exact(printed, point)[0] - exact(ackley, point)[0] == pytest.approx(6 - np.e)
    for label in ("F9", "F10"):
        assert exact(by_label(smwoa, label), far)[0] > 1e6 > exact(by_label(smwoa, label, "as-printed"), far)[0]
    assert by_label(smwoa, "F11", "as-printed").minimum is None
    assert exact(by_label(smwoa, "F11", "as-printed"), [[-65.0, -64.9999]])[0] < 1.0


def test_noise_comes_from_the_generator_alone():
    noisy = by_label("woodworking-golds-pso", "F5")
    points = np.zeros((500, 30))
    values = noisy(points, np.random.default_rng(4))
    assert values.min() >= 0 < values.std()
    assert values.max() < 1
    np.testing.assert_array_equal(values, noisy.objective(np.random.default_rng(4))(points))
    with pytest.raises(StudyError, match="pass a numpy Generator"):
        noisy(points)


def test_largest_value_of_the_noisy_quartic_in_its_box():
    corner = np.full((1, 30), 1.28)
    assert exact(by_label("woodworking-golds-pso", "F5"), corner)[0] + 1 == pytest.approx(1249.2, abs=0.1)


def test_a_shift_moves_the_function_and_its_minimiser():
    function = by_label("ur5-smwoa", "F6")
    shift = np.linspace(-3.0, 3.0, 30)
    moved = shifted(function, shift)
    points = np.random.default_rng(0).uniform(-2, 2, (9, 30))
    np.testing.assert_allclose(moved(points + shift), function(points), rtol=1e-12, atol=1e-12)
    assert exact(moved, moved.minimiser)[0] == pytest.approx(moved.minimum)
    with pytest.raises(StudyError, match="out of the box"):
        shifted(function, np.full(30, 6.0))
    with pytest.raises(StudyError, match="needs 30 numbers"):
        shifted(function, np.zeros(29))


@pytest.mark.parametrize("label", ["F1", "F5", "F6", "F12"])
def test_a_rotation_keeps_the_minimum_and_turns_the_rest(label):
    function = by_label("ur5-smwoa", label)
    matrix = random_rotation(function.n_dimensions, np.random.default_rng(2))
    turned = rotated(function, matrix)
    offset = np.random.default_rng(3).standard_normal((6, function.n_dimensions))
    assert exact(turned, turned.minimiser)[0] == pytest.approx(function.minimum, abs=1e-12)
    np.testing.assert_allclose(
        turned(turned.minimiser + offset), function(function.minimiser + offset @ matrix.T), rtol=1e-12
    )
    assert np.allclose(turned(turned.minimiser + offset), function(function.minimiser + offset)) == (label == "F1")


def test_what_is_not_a_rotation_is_refused():
    function = by_label("ur5-smwoa", "F12")
    with pytest.raises(StudyError, match="orthogonal 2 x 2 matrix"):
        rotated(function, np.array([[1.0, 1.0], [0.0, 1.0]]))


def test_wrong_questions_are_refused():
    with pytest.raises(StudyError, match="did you mean 'ur5-smwoa'"):
        benchmarks_of("ur5-smwo")
    with pytest.raises(StudyError, match="no paper reading"):
        benchmarks_of("ur5-smwoa", "printed")
    with pytest.raises(StudyError, match=r"shape \(n_points, 30\), got \(30,\)"):
        by_label("ur5-smwoa", "F1")(np.zeros(30))
