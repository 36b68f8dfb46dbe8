"""Roots and extrema against factored polynomials and dense sampling."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study import polynomial


@pytest.mark.parametrize("degree", range(1, 8))
def test_every_real_root_in_the_interval_is_found(degree):
    rng = np.random.default_rng(degree)
    wanted = np.sort(rng.uniform(0.02, 0.98, size=(200, degree)), axis=1)
    keep = np.diff(wanted, axis=1).min(axis=1, initial=1.0) > 0.01
    wanted = wanted[keep]
    coefficients = np.array([np.polynomial.polynomial.polyfromroots(row) for row in wanted])
    found = polynomial.roots(coefficients * rng.uniform(0.1, 10, size=(len(wanted), 1)))
    nearest = np.abs(found[:, :, None] - wanted[:, None, :]).min(axis=1)
    assert nearest.max() < 1e-9
    assert found.min() >= 0
    assert found.max() <= 1


@pytest.mark.parametrize(
    ("coefficients", "root"),
    [
        ([-1.0, 2.0, 0.0], 0.5),  # a quadratic whose square term is zero
        ([-1.0, 2.0, 0.0, 0.0], 0.5),
        ([-1e-12, 1.0, 1e12], 6.18e-13),
        ([0.0, 0.0, 0.0, 1.0], 0.0),
        ([-0.125, 0.75, -1.5, 1.0], 0.5),  # a triple root
        ([0.25, -1.0, 1.0], 0.5),  # a double root
    ],
)
def test_degenerate_polynomials(coefficients, root):
    found = polynomial.roots(np.array(coefficients))
    assert np.abs(found - root).min() < 1e-5


def test_constants_have_no_roots_and_no_derivative():
    assert polynomial.roots(np.array([[3.0], [0.0]])).shape == (2, 0)
    assert polynomial.derivative(np.array([3.0])).tolist() == [0.0]
    lowest, _, highest, _ = polynomial.extrema(np.array([3.0]))
    assert (lowest, highest) == (3.0, 3.0)


@settings(max_examples=200, deadline=None)
@given(st.lists(st.floats(-100, 100), min_size=2, max_size=7))
def test_no_sample_lies_beyond_the_extrema(coefficients):
    p = np.array(coefficients)
    u = np.linspace(0, 1, 2001)
    samples = polynomial.value(p, u)
    lowest, at_lowest, highest, at_highest = polynomial.extrema(p)
    scale = np.abs(p).sum() * 1e-12 + 1e-300
    assert lowest <= samples.min() + scale
    assert highest >= samples.max() - scale
    assert polynomial.value(p, at_lowest) == pytest.approx(lowest, abs=scale)
    assert polynomial.value(p, at_highest) == pytest.approx(highest, abs=scale)
    assert polynomial.peak(p) == pytest.approx(max(abs(lowest), abs(highest)))


def test_product_is_convolution():
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(5, 1, 4)), rng.normal(size=(3, 3))
    result = polynomial.product(a, b)
    for i in range(5):
        for j in range(3):
            assert result[i, j] == pytest.approx(np.convolve(a[i, 0], b[j]))


@settings(max_examples=200, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4), st.sampled_from([1.0, 1e-4, 1e-9, 0.0]))
def test_closed_cubic_roots_find_the_same_peak_as_brackets(coefficients, lead):
    """Also where the leading coefficient nearly vanishes, which the cubic formula alone would not survive."""
    cubic = np.array([*coefficients[:3], coefficients[3] * lead])
    quartic = np.array([0.3, *(cubic / np.arange(1, 5))])
    closed = polynomial.peak_of_terms(tuple(quartic[:, None]), tuple(cubic[:, None]))
    assert closed[0] == pytest.approx(polynomial.peak(quartic), rel=1e-12)
