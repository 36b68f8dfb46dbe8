"""The exact piecewise polynomial and its parametric sibling."""

import numpy as np
import pytest

from study import StudyError, Trajectory
from study.curves import CURVES
from study.parametric import ParametricTrajectory


@pytest.fixture
def zigzag():
    """Position 2t^2 for one second, then 2 + 4s - s^2 for two more; a second joint stands still."""
    coefficients = np.zeros((2, 3, 2))
    coefficients[0, :, 0] = [0, 0, 2]
    coefficients[1, :, 0] = [2, 4, -1]
    coefficients[:, 0, 1] = 5
    return Trajectory.from_pieces(np.array([1.0, 2.0]), coefficients)


def test_values_and_derivatives(zigzag):
    assert zigzag([0, 0.5, 1, 2, 3])[:, 0].tolist() == [0, 0.5, 2, 5, 6]
    assert zigzag([0.5, 2], 1)[:, 0].tolist() == [2, 2]
    assert zigzag([0.5, 2], 2)[:, 0].tolist() == [4, -2]
    assert zigzag([0.5, 2], 3).tolist() == [[0, 0], [0, 0]]
    assert zigzag(99.0)[0].tolist() == [6, 5]
    assert (zigzag.duration, zigzag.n_joints, zigzag.degree) == (3.0, 2, 2)


def test_extrema_name_value_and_time(zigzag):
    velocity = zigzag.extrema(1)
    assert velocity.highest.tolist() == [4, 0]
    assert velocity.at_highest[0] == 1.0
    assert velocity.lowest[0] == 0.0
    assert zigzag.extrema(2).peak.tolist() == [4, 0]
    position = zigzag.extrema(0)
    assert (position.highest[0], position.at_highest[0]) == (6, 3)


def test_jumps(zigzag):
    assert zigzag.jumps(0).tolist() == [[0, 0]]
    assert zigzag.jumps(1).tolist() == [[0, 0]]
    assert zigzag.jumps(2).tolist() == [[-6, 0]]


def test_scaling_slows_every_rate(zigzag):
    slow = zigzag.scaled(2.0)
    assert slow.duration == 6.0
    assert slow.waypoint_times.tolist() == [0, 2, 6]
    for order in range(3):
        assert slow([0.0, 1.0, 4.0], order) * 2.0**order == pytest.approx(zigzag([0.0, 0.5, 2.0], order))


def test_waypoints_stand_after_groups_of_pieces(zigzag):
    grouped = Trajectory.from_pieces(np.array([1.0, 2.0]), zigzag.coefficients, 2)
    assert grouped.waypoint_times.tolist() == [0, 3]
    uneven = Trajectory.from_pieces(np.ones(3), np.zeros((3, 1, 1)), np.array([2, 1]))
    assert uneven.waypoint_times.tolist() == [0, 2, 3]
    assert zigzag.joints([1]).extrema().highest.tolist() == [5]


@pytest.mark.parametrize(
    ("knots", "shape", "sentence"),
    [
        ([0, 1, 1], (2, 2, 1), "increase strictly"),
        ([0.5, 1, 2], (2, 2, 1), "start at 0"),
        ([0, 1], (2, 2, 1), "n_pieces"),
        ([0, np.inf], (1, 2, 1), "finite"),
    ],
)
def test_malformed_trajectories_are_refused(knots, shape, sentence):
    with pytest.raises(StudyError, match=sentence):
        Trajectory(knots, np.zeros(shape), [0.0])


def test_parametric_rates_match_finite_differences():
    rng = np.random.default_rng(1)
    motion = CURVES["bspline"].motion(rng.normal(size=(6, 2)), rng.uniform(0.8, 1.2, size=5))
    t, step = np.linspace(0.3, motion.duration - 0.3, 40), 1e-5
    t = t[np.abs(t[:, None] - motion.knots).min(axis=1) > 2 * step]
    for order in range(3):
        difference = (motion(t + step, order) - motion(t - step, order)) / (2 * step)
        assert motion(t, order + 1) == pytest.approx(difference, rel=1e-4, abs=1e-4)


def test_parametric_equals_polynomial_when_time_is_linear():
    rng = np.random.default_rng(2)
    position = rng.normal(size=(1, 4, 2))
    parametric = ParametricTrajectory(np.array([[0.0, 2.0, 0.0, 0.0]]), position)
    plain = Trajectory(np.array([0.0, 2.0]), position / 2.0 ** np.arange(4)[:, None], np.array([0.0, 2.0]))
    t = np.linspace(0, 2, 30)
    for order in range(4):
        assert parametric(t, order) == pytest.approx(plain(t, order), abs=1e-12)
        assert parametric.extrema(order).peak == pytest.approx(plain.extrema(order).peak, rel=1e-9, abs=1e-12)
    assert parametric.scaled(3.0).duration == 6.0
    assert parametric.joints([1])(t)[:, 0] == pytest.approx(plain(t)[:, 1])


@pytest.mark.parametrize("name", ["cubic-spline", "bspline"])
def test_there_is_no_derivative_of_negative_order(name):
    motion = CURVES[name].motion(np.random.default_rng(1).normal(size=(6, 2)), np.ones(5))
    with pytest.raises(StudyError, match="must be a whole number of at least 0 and at most 20, got -1"):
        motion(0.5, order=-1)


def test_parametric_time_must_increase():
    with pytest.raises(StudyError, match="increase strictly"):
        ParametricTrajectory(np.array([[0.0, 1.0, -1.0]]), np.zeros((1, 4, 1)))
    with pytest.raises(StudyError, match="one row of coefficients per piece"):
        ParametricTrajectory(np.zeros((2, 2)), np.zeros((1, 4, 1)))
