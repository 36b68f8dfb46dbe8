"""Limits of joints and what stays of them when one is replaced."""

from dataclasses import replace

import numpy as np

from study import JointLimits


def test_a_replaced_limit_holds_in_both_directions_unless_one_was_given():
    limits = JointLimits(velocity=[1.0, 2.0], acceleration=[3.0, 4.0], min_acceleration=[-1.0, -1.0])
    changed = replace(limits, jerk=np.array([30.0, 40.0]), velocity=np.array([0.5, 0.5]))
    np.testing.assert_array_equal(changed.lowest_rates, [[-0.5, -0.5], [-1.0, -1.0], [-30.0, -40.0]])
    assert replace(limits, min_acceleration=None).symmetric


def test_the_limits_of_one_joint_keep_their_directions():
    limits = JointLimits(velocity=[1.0, 2.0], min_velocity=[-0.5, -2.0])
    np.testing.assert_array_equal(limits.joint(0).lowest_rates[:, 0], [-0.5, -np.inf, -np.inf])
    np.testing.assert_array_equal(limits.scaled(2.0).lowest_rates[0], [-0.25, -1.0])
