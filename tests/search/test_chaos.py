"""Chaotic maps: closed-form orbits, uniformity, and the populations made of them."""

import numpy as np
import pytest
from scipy import stats

from study import StudyError
from study.search.chaos import (
    MAPS,
    chaotic_population,
    circle,
    logistic,
    map_named,
    rescaled,
    sine_tent_cosine,
    singer,
    tent,
    uniformity,
)
from study.search.state import Box

BOX = Box(np.array([1.0, -2.0, 0.0]), np.array([5.0, 2.0, 0.5]))


def orbits(name, n_sequences=60, length=1000):
    rng = np.random.default_rng(0)
    return MAPS[name].sequences(rng.random(n_sequences), length, rng)


def test_logistic_orbit_is_a_squared_sine():
    angle = 0.3
    orbit = MAPS["logistic"].sequences(np.array([np.sin(angle) ** 2]), 12, np.random.default_rng(0))[:, 0]
    assert orbit == pytest.approx(np.sin(angle * 2.0 ** np.arange(12)) ** 2, abs=1e-10)


def test_tent_is_conjugate_to_logistic():
    x = np.linspace(0, 1, 101)
    assert logistic(np.sin(np.pi * x / 2) ** 2) == pytest.approx(np.sin(np.pi * tent(x) / 2) ** 2, abs=1e-15)


def test_tent_orbits_of_dyadic_numbers():
    orbit = MAPS["tent"].sequences(np.array([0.125, 0.75]), 6, np.random.default_rng(0))
    assert orbit.T.tolist() == [[0.125, 0.25, 0.5, 1.0, 0.0, 0.0], [0.75, 0.5, 1.0, 0.0, 0.0, 0.0]]


def test_plain_tent_collapses_to_exactly_zero_and_the_perturbed_tent_does_not():
    assert not orbits("tent")[54:].any()
    assert (orbits("perturbed-tent")[54:] > 0).all()


def test_circle_without_its_sine_is_a_rotation():
    x, orbit = np.array([0.1]), []
    for _ in range(20):
        orbit.append(x[0])
        x = circle(x, a=0.0)
    assert orbit == pytest.approx(np.mod(0.1 + 0.2 * np.arange(20), 1), abs=1e-12)


def test_circle_and_singer_single_steps():
    assert circle(np.array([0.25, 0.75])) == pytest.approx([0.45 - 0.25 / np.pi, 0.95 + 0.25 / np.pi - 1])
    x = np.linspace(0, 1, 11)
    assert singer(x, 1.0) == pytest.approx(np.polyval([-13.3028275, 28.75, -23.31, 7.86, 0.0], x), abs=1e-12)


def test_sine_tent_cosine_is_symmetric_and_ends_at_zero():
    x = np.linspace(0, 1, 101)
    assert sine_tent_cosine(x) == pytest.approx(sine_tent_cosine(1 - x), abs=1e-12)
    assert sine_tent_cosine(np.array([0.0, 0.5, 1.0])) == pytest.approx(np.zeros(3), abs=1e-12)
    assert sine_tent_cosine(x, r=0.0) == pytest.approx(np.cos(np.pi * (tent(x) - 0.5)), abs=1e-12)


@pytest.mark.parametrize("name", MAPS)
def test_maps_stay_in_the_unit_interval(name):
    numbers = orbits(name)
    assert numbers.min() >= 0
    assert numbers.max() <= 1


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("perturbed-tent", 5, 12),
        ("circle", 90, 110),
        ("sine-tent-cosine", 190, 240),
        ("logistic", 260, 310),
        ("singer", 280, 340),
        ("tent", 5000, 9000),
    ],
)
def test_only_the_perturbed_tent_is_uniform(name, low, high):
    values = [uniformity(column) for column in orbits(name).T]
    assert low < np.median(values) < high


def test_uniformity_is_pearsons_chi_square():
    values = np.random.default_rng(5).random(1000)
    counts = np.histogram(values, 10, (0, 1))[0]
    assert uniformity(values) == pytest.approx(stats.chisquare(counts).statistic)
    assert uniformity(np.linspace(0.05, 0.95, 10)) == 0
    assert uniformity(np.full(1000, 1.0)) == pytest.approx(9000)
    reference = [uniformity(column) for column in np.random.default_rng(6).random((200, 1000))]
    assert np.mean(reference) == pytest.approx(9, abs=1)


@pytest.mark.parametrize("name", ["circle", "sine-tent-cosine", "logistic"])
def test_sequences_side_by_side_are_independent(name):
    rng = np.random.default_rng(1)
    start = rng.random(4)
    together = MAPS[name].sequences(start, 30, rng)
    alone = [MAPS[name].sequences(start[i : i + 1], 30, rng)[:, 0] for i in range(4)]
    assert (together == np.transpose(alone)).all()


@pytest.mark.parametrize("along", ["population", "dimensions"])
@pytest.mark.parametrize("name", MAPS)
def test_populations_fill_the_box_the_same_way_for_the_same_seed(name, along):
    first, second = (chaotic_population(MAPS[name], BOX, 40, np.random.default_rng(3), along) for _ in range(2))
    assert first.shape == (40, 3)
    assert (first >= BOX.lower).all()
    assert (first <= BOX.upper).all()
    assert first.tobytes() == second.tobytes()


def test_sequences_run_along_the_axis_that_was_asked_for():
    fractions = (chaotic_population(MAPS["circle"], BOX, 9, np.random.default_rng(0)) - BOX.lower) / BOX.width
    assert fractions[1:] == pytest.approx(circle(fractions[:-1]))
    across = chaotic_population(MAPS["circle"], BOX, 9, np.random.default_rng(0), along="dimensions")
    fractions = (across - BOX.lower) / BOX.width
    assert fractions[:, 1:] == pytest.approx(circle(fractions[:, :-1]))


def test_rescaled_sequences_touch_both_walls():
    population = chaotic_population(MAPS["perturbed-tent"], BOX, 50, np.random.default_rng(0), rescale=True)
    assert population.min(axis=0) == pytest.approx(BOX.lower)
    assert population.max(axis=0) == pytest.approx(BOX.upper)
    assert not rescaled(np.full((5, 2), 0.3)).any()


def test_unknown_names_say_what_would_do():
    with pytest.raises(StudyError, match="no chaotic map 'circl'; did you mean 'circle'"):
        map_named("circl")
    with pytest.raises(StudyError, match="no direction 'dimension'"):
        chaotic_population(MAPS["tent"], BOX, 5, np.random.default_rng(0), along="dimension")
