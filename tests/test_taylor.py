"""Models of functions over intervals: no value ever leaves them, and halving draws them together."""

import numpy as np
import pytest

from study.taylor import Model, cross, sine_cosine, stacked

INSIDE = np.linspace(-1.0, 1.0, 401)


def at(ascending, u=INSIDE):
    return sum(c[..., None] * u**k for k, c in enumerate(ascending))


def holds(model, values):
    """Largest distance of values, shape (..., n_samples), from the polynomial, as compared with the rest."""
    off = np.abs(values - at(model.poly)).max(axis=-1)
    low, high = model.range()
    assert (low <= values.min(axis=-1) + 1e-12).all()
    assert (high >= values.max(axis=-1) - 1e-12).all()
    return bool((off <= model.rest + 1e-12).all())


@pytest.mark.parametrize("size", [1.0, 0.3, 1e-3])
def test_sums_products_and_functions_stay_inside(size):
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(2, 7, 3, 20)) * size ** np.arange(7)[:, None, None]
    first, second = Model.of(a), Model.of(b)
    x, y = at(a), at(b)
    assert holds(first, x)
    assert holds(first + second, x + y)
    assert holds(first - second * 3.0, x - 3 * y)
    assert holds(first * second, x * y)
    assert holds(first * second * first, x * y * x)
    sine, cosine = sine_cosine(first)
    assert holds(sine, np.sin(x))
    assert holds(cosine, np.cos(x))
    assert holds(cross(first, second), np.cross(x, y, axis=0))
    matrix = rng.normal(size=(2, 3))
    assert holds(first.mapped(matrix), np.einsum("ij,j...->i...", matrix, x))
    assert holds(stacked([first[1], second[2]]), np.stack([x[1], y[2]]))


def test_one_over_a_function_is_enclosed_and_unbounded_where_it_may_be_zero():
    away = Model.of(np.array([[2.0, -2.0, 0.5], [0.5, 0.3, 1.0], [0.1, 0.2, 0.0]]))
    inverse = away.inverse()
    assert holds(inverse[:2], 1 / at(away.poly)[:2])
    assert np.isinf(inverse.range()[1][2])


def test_halving_draws_the_rest_of_a_sine_together_by_its_fourth_power():
    rests = [sine_cosine(Model.of(np.array([[0.5], [size]])))[0].rest[0] for size in (0.4, 0.2, 0.1)]
    assert rests[0] / rests[1] == pytest.approx(16, rel=0.1)
    assert rests[1] / rests[2] == pytest.approx(16, rel=0.1)
