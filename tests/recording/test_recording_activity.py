"""Constraint activity against closed forms and brute force."""

from __future__ import annotations

import numpy as np
import pytest

from study.analysis.activity import Use, lane, limit_uses
from study.curves import CURVES
from study.problem import JointLimits
from study.trajectory import Trajectory


def trapezoid(peak: float = 1.0, slope: float = 2.0, cruise: float = 3.0) -> Trajectory:
    """Accelerate with `slope` to `peak`, cruise, brake: one joint, from rest to rest."""
    ramp = peak / slope
    position = [0.0, 0.5 * slope * ramp**2]
    position.append(position[1] + peak * cruise)
    pieces = [[position[0], 0.0, slope / 2], [position[1], peak, 0.0], [position[2], peak, -slope / 2]]
    return Trajectory.from_pieces(np.array([ramp, cruise, ramp]), np.array(pieces)[:, :, None], [3])


def test_a_trapezoid_uses_each_limit_exactly_where_the_closed_form_says() -> None:
    share = 0.999
    uses = limit_uses(trapezoid(), JointLimits([1.0], [2.0]), share)
    slack = (1 - share) * 0.5  # time short of the ramp's end at which velocity reaches the share
    expected = [(1, 0.5 - slack, 3.5 + slack), (2, 0.0, 0.5), (2, 3.5, 4.0)]
    assert [use.order for use in uses] == [order for order, _, _ in expected]
    np.testing.assert_allclose([(use.start, use.end) for use in uses], [pair[1:] for pair in expected], atol=1e-8)


@pytest.mark.parametrize(("limits", "order"), [(([1.0], [9.0]), 1), (([9.0], [2.0]), 2), (([9.0], [9.0]), None)])
def test_only_the_limit_that_binds_is_active(limits: tuple[list[float], list[float]], order: int | None) -> None:
    uses = limit_uses(trapezoid(), JointLimits(*limits))
    assert {use.order for use in uses} == ({order} if order else set())


def test_a_jerk_limit_is_seen_and_an_absent_one_never() -> None:
    cubic = Trajectory.from_pieces(np.array([1.0]), np.array([[[0.0], [0.0], [0.0], [1.0]]]))
    (use,) = limit_uses(cubic, JointLimits([np.inf], [np.inf], [6.0]))
    assert (use.joint, use.order, use.start, use.end) == (0, 3, 0.0, 1.0)
    assert limit_uses(cubic, JointLimits([9.0])) == ()


@pytest.mark.parametrize("family", sorted(CURVES))
def test_stretches_agree_with_dense_sampling(family: str) -> None:
    rng = np.random.default_rng(5)
    waypoints = rng.normal(size=(4, 3))
    motion = CURVES[family].motion(waypoints, rng.uniform(0.8, 1.3, size=3))
    peaks = [motion.extrema(order).peak for order in (1, 2, 3)]
    limits, share = JointLimits(*(0.9 * peak for peak in peaks)), 1.0
    uses = limit_uses(motion, limits, share)
    times = np.linspace(0.0, motion.duration, 4001)
    for order in (1, 2, 3):
        above = np.abs(motion(times, order)) >= limits.rates[order - 1]
        for joint in range(3):
            mine = [use for use in uses if (use.order, use.joint) == (order, joint)]
            inside = np.any([(use.start <= times) & (times <= use.end) for use in mine], axis=0)
            assert (above[:, joint] <= inside).all()
            # beyond what sampling sees, only joined gaps, which are short
            assert (inside & ~above[:, joint]).sum() <= 4001 / 500 * max(len(mine), 1)


def test_the_exact_peak_is_found_however_narrow() -> None:
    motion = CURVES["poly353"].motion(np.array([[0.0], [1.0], [-1.0], [0.0]]), np.array([1.0, 0.7, 1.3]))
    extrema = motion.extrema(1)
    (use,) = limit_uses(motion, JointLimits(extrema.peak), 1.0 - 1e-12)
    assert use.start <= extrema.at_peak[0] <= use.end
    assert use.end - use.start < 1e-4


def test_a_lane_names_the_joints_and_is_silent_between() -> None:
    uses = (Use(0, 1, 1.0, 3.0), Use(1, 1, 2.0, 4.0), Use(0, 2, 0.0, 9.0))
    assert lane(uses, 1, ("a", "b")) == [(0.0, ""), (1.0, "a"), (2.0, "a + b"), (3.0, "b"), (4.0, "")]
    assert lane(uses, 3, ("a", "b")) == [(0.0, "")]
