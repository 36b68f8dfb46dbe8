"""Benchmark formulas, each for a whole population: points of shape (n_points, n_dimensions) to values (n_points,)."""

from __future__ import annotations

import numpy as np

from study.problem import Floats

FOXHOLES = np.array(np.meshgrid([-32.0, -16.0, 0.0, 16.0, 32.0], [-32.0, -16.0, 0.0, 16.0, 32.0])).reshape(2, 25)
KOWALIK_A = np.array([0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246])
KOWALIK_B = 1.0 / np.array([0.25, 0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0])
HARTMANN_A = np.array([[3.0, 10.0, 30.0], [0.1, 10.0, 35.0], [3.0, 10.0, 30.0], [0.1, 10.0, 35.0]])
HARTMANN_C = np.array([1.0, 1.2, 3.0, 3.2])
HARTMANN_P = np.array(
    [[0.3689, 0.117, 0.2673], [0.4699, 0.4387, 0.747], [0.1091, 0.8732, 0.5547], [0.03815, 0.5743, 0.8828]]
)
SHEKEL_A = np.array([[4.0] * 4, [1.0] * 4, [8.0] * 4, [6.0] * 4, [3.0, 7.0, 3.0, 7.0]])
SHEKEL_C = np.array([0.1, 0.2, 0.2, 0.4, 0.4])


def sphere(x: Floats) -> Floats:
    """Sum of squares."""
    return (x**2).sum(axis=1)


def schwefel_222(x: Floats) -> Floats:
    """Sum plus product of magnitudes."""
    return np.abs(x).sum(axis=1) + np.abs(x).prod(axis=1)


def schwefel_12(x: Floats) -> Floats:
    """Sum of squared partial sums."""
    return (np.cumsum(x, axis=1) ** 2).sum(axis=1)


def schwefel_221(x: Floats) -> Floats:
    """Largest magnitude."""
    return np.abs(x).max(axis=1)


def rosenbrock(x: Floats) -> Floats:
    """Curved valley."""
    return (100.0 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (x[:, :-1] - 1.0) ** 2).sum(axis=1)


def step(x: Floats) -> Floats:
    """Squares of rounded coordinates: flat around its minimum."""
    return (np.floor(x + 0.5) ** 2).sum(axis=1)


def step_without_floor(x: Floats) -> Floats:
    """Sphere around -0.5."""
    return ((x + 0.5) ** 2).sum(axis=1)


def quartic(x: Floats) -> Floats:
    """Weighted fourth powers; its noise is added by the benchmark."""
    return (np.arange(1, x.shape[1] + 1) * x**4).sum(axis=1)


def rastrigin(x: Floats) -> Floats:
    """Sphere with a lattice of minima."""
    return (x**2 - 10.0 * np.cos(2.0 * np.pi * x) + 10.0).sum(axis=1)


def ackley(x: Floats) -> Floats:
    """Nearly flat plain with one funnel."""
    return _ackley_below(x) + 20.0 + np.e


def ackley_with_six(x: Floats) -> Floats:
    """Ackley's function with 6 in the place of e."""
    return _ackley_below(x) + 20.0 + 6.0


def _ackley_below(x: Floats) -> Floats:
    funnel = -20.0 * np.exp(-0.2 * np.sqrt((x**2).mean(axis=1)))
    return funnel - np.exp(np.cos(2.0 * np.pi * x).mean(axis=1))


def griewank(x: Floats) -> Floats:
    """Shallow sphere with a product of cosines."""
    scale = np.sqrt(np.arange(1, x.shape[1] + 1))
    return (x**2).sum(axis=1) / 4000.0 - np.cos(x / scale).prod(axis=1) + 1.0


def alpine(x: Floats) -> Floats:
    """Magnitudes of x sin x + 0.1 x."""
    return np.abs(x * np.sin(x) + 0.1 * x).sum(axis=1)


def wall(x: Floats, edge: float, factor: float, power: float = 4.0) -> Floats:
    """Penalty u of the penalised functions, zero within [-edge, edge]."""
    return (factor * np.maximum(np.abs(x) - edge, 0.0) ** power).sum(axis=1)


def penalised_1(x: Floats) -> Floats:
    """Levy's function with walls at 10."""
    return _levy(x, np.sin(np.pi * _levy_y(x)[:, 0]) ** 2) + wall(x, 10.0, 100.0)


def penalised_1_printed(x: Floats) -> Floats:
    """UR5 paper on SMWOA, F9, as printed: no square on the first sine, and walls with p = 10 and a = 100."""
    return _levy(x, np.sin(np.pi * _levy_y(x)[:, 0])) + wall(x, 100.0, 10.0)


def _levy_y(x: Floats) -> Floats:
    return 1.0 + (x + 1.0) / 4.0


def _levy(x: Floats, first: Floats) -> Floats:
    y = _levy_y(x)
    inner = ((y[:, :-1] - 1.0) ** 2 * (1.0 + 10.0 * np.sin(np.pi * y[:, 1:]) ** 2)).sum(axis=1)
    return np.pi / x.shape[1] * (10.0 * first + inner + (y[:, -1] - 1.0) ** 2)


def penalised_2(x: Floats) -> Floats:
    """Second penalised function, with walls at 5."""
    inner = ((x[:, :-1] - 1.0) ** 2 * (1.0 + np.sin(3.0 * np.pi * x[:, 1:]) ** 2)).sum(axis=1)
    return 0.1 * (_penalised_2_ends(x) + inner) + wall(x, 5.0, 100.0)


def penalised_2_printed(x: Floats) -> Floats:
    """UR5 paper on SMWOA, F10, as printed: 3 pi x_k + 1 for 3 pi x_(k+1), and walls with p = 5 and a = 100."""
    return _penalised_2_braces(x) + wall(x, 100.0, 5.0)


def penalised_2_product(x: Floats) -> Floats:
    """Woodworking paper, F8, as printed: without the plus sign the braces multiply the walls, so it is 0 within 5."""
    return _penalised_2_braces(x) * wall(x, 5.0, 100.0)


def _penalised_2_ends(x: Floats) -> Floats:
    """First and last terms; the papers print x_i or x_k where x_1 and x_n belong."""
    last = (x[:, -1] - 1.0) ** 2 * (1.0 + np.sin(2.0 * np.pi * x[:, -1]) ** 2)
    return np.sin(3.0 * np.pi * x[:, 0]) ** 2 + last


def _penalised_2_braces(x: Floats) -> Floats:
    inner = ((x - 1.0) ** 2 * (1.0 + np.sin(3.0 * np.pi * x + 1.0) ** 2)).sum(axis=1)
    return 0.1 * (_penalised_2_ends(x) + inner)


def foxholes(x: Floats) -> Floats:
    """Shekel's foxholes: 25 narrow holes in a plain."""
    depth = np.arange(1, 26) + ((x[:, :, None] - FOXHOLES) ** 6).sum(axis=1)
    return 1.0 / (1.0 / 500.0 + (1.0 / depth).sum(axis=1))


def foxholes_printed(x: Floats) -> Floats:
    """UR5 paper on SMWOA, F11, as printed, without the power 6 and the reciprocal: it has poles and no minimum."""
    depth = np.arange(1, 26) + (x[:, :, None] - FOXHOLES).sum(axis=1)
    with np.errstate(divide="ignore"):
        return 1.0 / 500.0 + (1.0 / depth).sum(axis=1)


def branin(x: Floats) -> Floats:
    """Three equal minima."""
    valley = x[:, 1] - 5.1 / (4.0 * np.pi**2) * x[:, 0] ** 2 + 5.0 / np.pi * x[:, 0] - 6.0
    return valley**2 + 10.0 * (1.0 - 1.0 / (8.0 * np.pi)) * np.cos(x[:, 0]) + 10.0


def goldstein_price(x: Floats) -> Floats:
    """Polynomial over many orders of magnitude."""
    a, b = x.T
    head = 1.0 + (a + b + 1.0) ** 2 * (19.0 - 14.0 * a + 3.0 * a**2 - 14.0 * b + 6.0 * a * b + 3.0 * b**2)
    tail = 18.0 - 32.0 * a + 12.0 * a**2 + 48.0 * b - 36.0 * a * b + 27.0 * b**2
    return head * (30.0 + (2.0 * a - 3.0 * b) ** 2 * tail)


def hartmann_3(x: Floats) -> Floats:
    """Four Gaussian wells in three dimensions."""
    exponents = (HARTMANN_A * (x[:, None] - HARTMANN_P) ** 2).sum(axis=2)
    return -(HARTMANN_C * np.exp(-exponents)).sum(axis=1)


def shekel_5(x: Floats) -> Floats:
    """Five wells in four dimensions."""
    return -(1.0 / (((x[:, None] - SHEKEL_A) ** 2).sum(axis=2) + SHEKEL_C)).sum(axis=1)


def kowalik(x: Floats) -> Floats:
    """Least-squares fit of a rational function to eleven points."""
    b = KOWALIK_B
    top, bottom = b**2 + b * x[:, 1:2], b**2 + b * x[:, 2:3] + x[:, 3:4]
    return ((KOWALIK_A - x[:, :1] * top / bottom) ** 2).sum(axis=1)
