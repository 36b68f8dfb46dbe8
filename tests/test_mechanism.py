"""Inverse dynamics of arms against closed forms, published numbers, energy and another derivation."""

import numpy as np
import pytest

from study import StudyError
from study.mechanism import Mechanism
from study.taylor import Model
from study.testing.second_dynamics import second_dynamics
from tests.helpers.arms import G, lift, pendulum, random_arm, two_links


def test_a_pendulum_obeys_its_closed_form():
    m, length = 2.0, 0.5
    q, v, a = np.random.default_rng(1).normal(size=(3, 9, 1))
    arm = pendulum(m, length, rotors=[0.1], viscous=[0.3], coulomb=[0.7])
    expected = (m * length**2 + 0.1) * a + m * G * length * np.cos(q) + 0.3 * v + 0.7 * np.sign(v)
    np.testing.assert_allclose(arm.torque(q, v, a), expected, rtol=1e-13)
    speed, rate = arm.tool_rates(q, v, a)
    np.testing.assert_allclose(np.linalg.norm(speed, axis=1), length * np.abs(v[:, 0]), rtol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(rate, axis=1), length * np.hypot(a, v**2)[:, 0], rtol=1e-13)


def test_a_lift_carries_its_weight():
    arm = lift(5.0)
    np.testing.assert_allclose(arm.torque([[0.3]], [[2.0]], [[1.5]]), [[5.0 * (1.5 + G)]], rtol=1e-14)
    np.testing.assert_allclose(arm.carrying(2.0).torque([[0]], [[0]], [[0]]), [[7.0 * G]], rtol=1e-14)


def test_two_links_at_rest_and_in_motion_obey_the_textbook():
    (m1, m2), (l1, l2) = (3.0, 2.0), (0.5, 0.4)
    q, v, a = np.random.default_rng(2).normal(size=(3, 7, 2))
    arm = two_links((m1, m2), (l1, l2))
    c1, c12, c2, s2 = np.cos(q[:, 0]), np.cos(q.sum(axis=1)), np.cos(q[:, 1]), np.sin(q[:, 1])
    weight = np.stack([(m1 + m2) * G * l1 * c1 + m2 * G * l2 * c12, m2 * G * l2 * c12], axis=1)
    np.testing.assert_allclose(arm.torque(q, 0 * q, 0 * q), weight, rtol=1e-13)
    h = m2 * l1 * l2
    m11, m12, m22 = (m1 + m2) * l1**2 + m2 * l2**2 + 2 * h * c2, m2 * l2**2 + h * c2, m2 * l2**2
    first = m11 * a[:, 0] + m12 * a[:, 1] - h * s2 * (2 * v[:, 0] * v[:, 1] + v[:, 1] ** 2)
    second = m12 * a[:, 0] + m22 * a[:, 1] + h * s2 * v[:, 0] ** 2
    np.testing.assert_allclose(arm.torque(q, v, a), weight + np.stack([first, second], axis=1), rtol=1e-12)


def test_a_payload_is_a_mass_at_the_tool():
    carrying = two_links((3.0, 0.5)).carrying(1.5)
    heavier = two_links((3.0, 2.0))
    q, v, a = np.random.default_rng(3).normal(size=(3, 5, 2))
    np.testing.assert_allclose(carrying.torque(q, v, a), heavier.torque(q, v, a), rtol=1e-13)


@pytest.mark.parametrize("n_joints", [1, 2, 4, 7])
def test_the_recursion_agrees_with_virtual_work_in_the_base_frame(n_joints):
    rng = np.random.default_rng(n_joints)
    arm, (q, v, a) = random_arm(rng, n_joints), rng.normal(size=(3, 40, n_joints))
    torque, speed, rate = second_dynamics(arm, q, v, a)
    np.testing.assert_allclose(arm.torque(q, v, a), torque, rtol=1e-9, atol=1e-9)
    for first, second in zip(arm.tool_rates(q, v, a), (speed, rate), strict=True):
        np.testing.assert_allclose(*(np.linalg.norm(each, axis=1) for each in (first, second)), rtol=1e-11)


def test_intervals_of_time_enclose_the_instants_in_them():
    rng = np.random.default_rng(5)
    arm, inside = random_arm(rng, 4), np.linspace(-1, 1, 101)
    rates = rng.normal(size=(3, 5, 4, 6)) * 0.3 ** np.arange(5)[:, None, None]
    swing = arm.swing(*(Model.of(rate) for rate in rates))
    values = [np.einsum("kjn,ku->jnu", rate, inside ** np.arange(5)[:, None]) for rate in rates]
    flat = [value.reshape(4, -1).T for value in values]
    low, high = swing.torque.range()
    torque = arm.torque(*flat).T.reshape(4, 6, 101)
    assert (low <= torque.min(axis=2) + 1e-9).all()
    assert (high >= torque.max(axis=2) - 1e-9).all()
    for model, exact in zip((swing.velocity, swing.acceleration), arm.tool_rates(*flat), strict=True):
        low, high = model.range()
        exact = exact.T.reshape(3, 6, 101)
        assert (low <= exact.min(axis=2) + 1e-9).all()
        assert (high >= exact.max(axis=2) - 1e-9).all()


def test_a_mechanism_that_makes_no_sense_is_refused_in_one_sentence():
    with pytest.raises(StudyError, match="masses of joint 1 must not be negative"):
        pendulum(mass=-1.0)
    with pytest.raises(StudyError, match="centres must be finite, of shape"):
        Mechanism(np.eye(4)[None], [0], [1], [[0, 0]], np.zeros((1, 3, 3)), [0], [0], [0])
