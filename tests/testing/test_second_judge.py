"""The second judge: its enclosures against known suprema, and its answers against the first judge's."""

import os

import numpy as np
import pytest
from typer.testing import CliRunner

from study import EndCondition, JointLimits, Problem, Trajectory
from study.cli.main import app
from study.testing.attacks import ATTACKS, adversarial
from study.testing.bernstein import Curve, halved, suprema
from study.testing.second_judge import Answer, second_judge
from study.testing.two_judges import AGREEMENTS, compare_judges


def bernstein(power):
    """Bernstein coefficients of one polynomial in ascending powers on [0, 1]."""
    pieces = np.asarray(power, dtype=float)[None, :, None]
    return Curve(Trajectory(np.array([0.0, 1.0]), pieces, np.array([0.0, 1.0]))).unit(0)[0]


@pytest.mark.parametrize(
    ("power", "highest"),
    [
        ([0, 4, -4], 1.0),
        ([1, -18, 48, -32], 1.0),  # the Chebyshev polynomial -T3 on [0, 1]
        ([0, 0, 16, -32, 16], 1.0),
        ([1.0 - 1e-9], 1.0 - 1e-9),
        ([0.2, 0.3], 0.5),
    ],
)
def test_a_supremum_is_enclosed(power, highest):
    low, high = suprema(bernstein(power))
    assert low[0] <= highest + 1e-15
    assert highest - 1e-15 <= high[0]
    assert high[0] - low[0] <= 1.1e-10 or high[0] < 0.99


def test_both_parts_of_a_polynomial_are_the_polynomial():
    power = np.random.default_rng(3).normal(size=6)
    left, right = halved(bernstein(power), 0.3)
    assert left[0, -1] == pytest.approx(np.polyval(power[::-1], 0.3))
    middle = halved(right, 0.5)[0][0, -1]
    assert middle == pytest.approx(np.polyval(power[::-1], 0.65))


def test_a_bump_between_knots_is_seen():
    motion = Trajectory(np.array([0.0, 1.0]), np.array([[[0.0], [1], [1e-3], [-2e-3], [1e-3]]]), np.array([0.0, 1.0]))
    problem = Problem("bump", [[0.0], [1.0]], JointLimits([1.0 + 0.9e-3 * 0.19245]), EndCondition.FREE)
    assert second_judge(problem, motion).answer is Answer.INFEASIBLE
    wider = Problem("bump", [[0.0], [1.0]], JointLimits([1.0 + 1.1e-3 * 0.19245]), EndCondition.FREE)
    assert second_judge(wider, motion).answer is Answer.FEASIBLE


def test_two_judges_agree_on_random_and_adversarial_motions():
    agreement = compare_judges(800, seed=20)
    assert agreement.different == ()
    assert agreement.total("feasible") > 100
    assert agreement.total("infeasible") > 300
    assert agreement.total("undecided") < 40


def test_an_attack_is_the_same_motion_again():
    first, second = (adversarial(7, 10)[2] for _ in range(2))
    assert first.coefficients.tobytes() == second.coefficients.tobytes()
    assert {adversarial(7, k)[0] for k in range(3 * len(ATTACKS))} >= set(ATTACKS)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_two_judges_agree_on_ten_thousand_motions():
    agreement = compare_judges(10_000, seed=0, jobs=os.cpu_count() or 1)
    assert agreement.different == ()
    assert sum(agreement.total(outcome) for outcome in AGREEMENTS) == 10_000


def test_a_command_prints_how_often_the_judges_agree():
    ended = CliRunner().invoke(app, ["torture", "--judges", "48", "--jobs", "1", "--seed", "3"])
    assert ended.exit_code == 0, ended.output
    assert "48 motions, seed 3, judged twice" in ended.output
    assert "undecided" in ended.output
