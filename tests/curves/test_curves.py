"""The three curve families against linear solves, scipy, and the laws of time scaling."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from study import EndCondition, StudyError
from study.curves import CURVES, bspline, curve_named, poly353


def drawn(name, rng, n_joints=3, n_candidates=20):
    n_waypoints = 4 if name == "poly353" else 7
    waypoints = rng.normal(size=(n_waypoints, n_joints))
    return waypoints, rng.uniform(0.8, 1.3, size=(n_candidates, n_waypoints - 1))


def by_fourteen_equations(q, t1, t2, t3):
    """Coefficients of one joint as the papers solve for them: Eq. (16)-(18) of the woodworking paper."""

    def row(t, degree, order):
        powers = np.eye(degree + 1)
        for _ in range(order):
            powers = np.array([np.append(p[1:] * np.arange(1, degree + 1), 0) for p in powers])
        return np.array([np.polynomial.polynomial.polyval(t, p) for p in powers])

    zeros3, zeros5 = np.zeros(4), np.zeros(6)
    rows, right = [], []
    for order in range(3):
        rows.append(np.concatenate([row(t1, 3, order), -row(0, 5, order), zeros3]))
        rows.append(np.concatenate([zeros3, row(t2, 5, order), -row(0, 3, order)]))
        rows.append(np.concatenate([row(0, 3, order), zeros5, zeros3]))
        rows.append(np.concatenate([zeros3, zeros5, row(t3, 3, order)]))
        right += [0, 0, q[0] if order == 0 else 0, q[3] if order == 0 else 0]
    rows.append(np.concatenate([zeros3, row(0, 5, 0), zeros3]))
    rows.append(np.concatenate([zeros3, zeros5, row(0, 3, 0)]))
    return np.linalg.solve(np.array(rows), [*right, q[1], q[2]])


def test_closed_form_of_353_equals_the_fourteen_equations():
    rng = np.random.default_rng(3)
    waypoints, durations = drawn("poly353", rng)
    for t in durations:
        motion = CURVES["poly353"].motion(waypoints, t)
        for joint in range(3):
            a = by_fourteen_equations(waypoints[:, joint], *t)
            assert motion.coefficients[0, :4, joint] == pytest.approx(a[:4], abs=1e-10)
            assert motion.coefficients[1, :, joint] == pytest.approx(a[4:10], abs=1e-9)
            assert motion.coefficients[2, :4, joint] == pytest.approx(a[10:], abs=1e-10)


def test_cubic_spline_equals_scipy_clamped():
    rng = np.random.default_rng(4)
    waypoints, durations = drawn("cubic-spline", rng)
    for h in durations:
        motion = CURVES["cubic-spline"].motion(waypoints, h)
        peer = CubicSpline(motion.knots, waypoints, bc_type="clamped")
        t = np.linspace(0, motion.duration, 50)
        for order in range(4):
            assert motion(t[1:-1], order) == pytest.approx(peer(t[1:-1], order), abs=1e-9)


@pytest.mark.parametrize("n_waypoints", [3, 4, 9])
def test_smooth_spline_starts_and_ends_unaccelerated_and_stays_twice_differentiable(n_waypoints):
    rng = np.random.default_rng(9)
    waypoints, durations = rng.normal(size=(n_waypoints, 2)), rng.uniform(0.5, 2.0, n_waypoints - 1)
    motion = CURVES["cubic-spline-smooth"].motion(waypoints, durations)
    assert motion.duration == pytest.approx(durations.sum())
    assert motion(motion.waypoint_times) == pytest.approx(waypoints, abs=1e-10)
    ends = np.array([0.0, motion.duration])
    for order in (1, 2):
        assert motion(ends, order) == pytest.approx(0, abs=1e-8)
    for order in range(3):
        assert motion.jumps(order) == pytest.approx(0, abs=1e-8)


def test_smooth_spline_needs_three_waypoints():
    with pytest.raises(StudyError, match="at least 3 waypoints"):
        CURVES["cubic-spline-smooth"].motion(np.array([[0.0], [1.0]]), np.ones(1))


def test_bspline_passes_the_waypoints_moving_but_unaccelerated():
    rng = np.random.default_rng(5)
    waypoints, durations = drawn("bspline", rng)
    motion = CURVES["bspline"].motion(waypoints, durations[0])
    assert motion.waypoint_times == pytest.approx(np.concatenate([[0], np.cumsum(durations[0])]), abs=1e-12)
    assert motion(motion.waypoint_times) == pytest.approx(waypoints, abs=1e-12)
    ends = np.array([0, motion.duration])
    assert np.abs(motion(ends, 1)).min() > 1e-3
    assert motion(ends, 2) == pytest.approx(0, abs=1e-9)
    for order in range(3):
        assert motion.jumps(order) == pytest.approx(0, abs=1e-9)


def test_bspline_basis_reproduces_its_control_polygon():
    values = np.arange(6.0)
    points = bspline.control_points(values)
    assert points[0] == points[1]
    assert points[-1] == points[-2]
    assert (points[:-2] + 4 * points[1:-1] + points[2:]) / 6 == pytest.approx(values)


def test_too_uneven_durations_give_no_bspline_motion():
    waypoints = np.arange(4.0)[:, None]
    uneven = np.array([1.0, 1e-3, 1.0])
    assert np.isinf(CURVES["bspline"].peaks(waypoints, uneven[None])).all()
    with pytest.raises(StudyError, match="too uneven"):
        CURVES["bspline"].motion(waypoints, uneven)


@pytest.mark.parametrize("name", CURVES)
def test_population_peaks_are_the_exact_extrema_of_each_motion(name):
    rng = np.random.default_rng(6)
    waypoints, durations = drawn(name, rng)
    curve = curve_named(name)
    peaks = curve.peaks(waypoints, durations)
    assert peaks.shape == (20, 3, 3)
    for row, h in zip(peaks, durations, strict=True):
        motion = curve.motion(waypoints, h)
        t = np.linspace(0, motion.duration, 4001)
        for order in (1, 2, 3):
            assert row[order - 1] == pytest.approx(motion.extrema(order).peak, rel=1e-9)
            assert (np.abs(motion(t, order)).max(axis=0) <= row[order - 1] * (1 + 1e-9)).all()


@pytest.mark.parametrize("name", CURVES)
def test_time_scaling_law(name):
    waypoints, durations = drawn(name, np.random.default_rng(7))
    curve = curve_named(name)
    k = 1.7
    slow, fast = curve.peaks(waypoints, durations * k), curve.peaks(waypoints, durations)
    for order in (1, 2, 3):
        assert slow[:, order - 1] * k**order == pytest.approx(fast[:, order - 1], rel=1e-9)


@pytest.mark.parametrize("name", CURVES)
def test_reversing_time_shifting_positions_and_permuting_joints(name):
    waypoints, durations = drawn(name, np.random.default_rng(8))
    curve = curve_named(name)
    peaks = curve.peaks(waypoints, durations)
    assert curve.peaks(waypoints[::-1], durations[:, ::-1]) == pytest.approx(peaks, rel=1e-8)
    assert curve.peaks(waypoints + 5.0, durations) == pytest.approx(peaks, rel=1e-8)
    assert curve.peaks(waypoints[:, [2, 0, 1]], durations) == pytest.approx(peaks[:, :, [2, 0, 1]], rel=1e-12)


def test_a_joint_that_does_not_move_has_no_rates():
    waypoints = np.zeros((4, 1))
    assert CURVES["poly353"].peaks(waypoints, np.ones((1, 3))).tolist() == [[[0.0], [0.0], [0.0]]]


def test_mistakes_are_named():
    with pytest.raises(StudyError, match="exactly 4 waypoints, got 5"):
        poly353.unit_coefficients(np.zeros((5, 1)), np.ones((1, 4)))
    with pytest.raises(StudyError, match="did you mean 'cubic-spline'"):
        curve_named("cubicspline")
    with pytest.raises(StudyError, match="3 positive numbers"):
        CURVES["poly353"].motion(np.zeros((4, 1)), np.array([1.0, 0.0, 1.0]))


def test_families_state_their_ends():
    assert {c.name: c.end for c in CURVES.values()} == {
        "poly353": EndCondition.SMOOTH,
        "cubic-spline": EndCondition.REST,
        "cubic-spline-smooth": EndCondition.SMOOTH,
        "bspline": EndCondition.FREE,
    }


@pytest.mark.parametrize("name", CURVES)
def test_whole_numbers_are_waypoints_and_durations_too(name):
    waypoints = np.array([[0, 1], [2, 3], [1, 5], [4, 4]])
    durations = np.array([[1, 2, 1], [2, 1, 3]])
    curve = curve_named(name)
    exact = curve.peaks(waypoints.astype(float), durations.astype(float))
    np.testing.assert_array_equal(curve.peaks(waypoints, durations), exact)
