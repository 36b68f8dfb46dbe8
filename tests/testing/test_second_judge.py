"""The second judge: its enclosures against known suprema, and its answers against the first judge's."""

import os

import numpy as np
import pytest
from typer.testing import CliRunner

from study import EndCondition, JointLimits, Problem, StudyError, Trajectory, judge
from study.cli.main import app
from study.curves import CURVES
from study.path_findings import largest_deviation
from study.problem import State, Timing, Tube
from study.testing.attacks import ATTACKS, adversarial
from study.testing.bernstein import Curve, halved, suprema
from study.testing.second_judge import Answer, second_judge
from study.testing.second_parametric import second_judge_parametric
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
    agreement = compare_judges(300, seed=20)
    assert agreement.different == ()
    assert agreement.total("feasible") > 40
    assert agreement.total("infeasible") > 120
    assert agreement.total("undecided") < 15


def test_an_attack_is_the_same_motion_again():
    first, second = (adversarial(7, 10)[2] for _ in range(2))
    assert first.coefficients.tobytes() == second.coefficients.tobytes()
    assert {adversarial(7, k)[0] for k in range(3 * len(ATTACKS))} >= set(ATTACKS)


@pytest.mark.slow
@pytest.mark.timeout(3000)
def test_two_judges_agree_on_a_hundred_thousand_motions():
    agreement = compare_judges(100_000, seed=0, jobs=os.cpu_count() or 1)
    assert agreement.different == ()
    assert sum(agreement.total(outcome) for outcome in AGREEMENTS) == 100_000


def test_a_command_prints_how_often_the_judges_agree():
    ended = CliRunner().invoke(app, ["torture", "--judges", "48", "--jobs", "1", "--seed", "3"])
    assert ended.exit_code == 0, ended.output
    assert "48 motions, seed 3, judged twice" in ended.output
    assert "undecided" in ended.output


def parametric(seed):
    """A curve in u, nearly at its limits or clearly on one side of them, with one demand more or a fault."""
    rng = np.random.default_rng([5, seed])
    points = rng.normal(size=(int(rng.integers(3, 7)), int(rng.integers(1, 4))))
    motion = CURVES["bspline"].motion(points, rng.uniform(0.8, 1.2, len(points) - 1))
    peaks = np.stack([motion.extrema(order).peak for order in (1, 2, 3)])
    rates = peaks * (
        1 + rng.choice([1e-9, -1e-9, 2e-6, -2e-6, 0.1, -0.1], peaks.shape, p=[0.3, 0, 0.3, 0.05, 0.3, 0.05])
    )
    rates[int(rng.integers(1, 4)) :] = np.inf
    start = State(motion(0.0, 1)[0] * (1 + rng.choice([0, 2e-6, 0.1])), motion(0.0, 2)[0])
    lines = largest_deviation(Problem("p", points, JointLimits(rates[0])), motion) * (1 + rng.choice([1e-5, -1e-5]))
    more = [
        {},
        {"start": start},
        {"path": Tube(lines)},
        {"stops": [1]},
        {"timing": Timing(at_least=motion.duration * (1 + rng.choice([0.0, 2e-6])))},
        {
            "segment_limits": {
                1: JointLimits(motion.between(*motion.knots[1:3]).extrema(1).peak * (1 + rng.choice([0, -2e-6])))
            }
        },
        {"tolerance": 0.1},
    ][seed % 7]
    limits = JointLimits(
        *rates, *(motion.extrema()[k] + rng.choice([0, 2e-6]) * np.ptp(points, axis=0) for k in (0, 2))
    )
    limits = limits if seed % 3 else JointLimits(*rates)
    moved = points + (0.05 if seed % 11 == 0 else 0.0)
    return Problem("curve", moved, limits, EndCondition.FREE, **more), motion


def test_two_judges_agree_on_curves_in_a_parameter_too():
    outcomes = []
    for seed in range(60):
        try:
            problem, motion = parametric(seed)
        except StudyError:  # such a demand contradicts the limits
            continue
        verdict, second = judge(problem, motion), second_judge_parametric(problem, motion).answer
        outcomes.append((verdict.feasible, second))
        near = abs(verdict.violation - 1e-6) < 1e-8
        assert near or second is Answer.UNDECIDED or verdict.feasible == (second is Answer.FEASIBLE), (
            seed,
            verdict.reasons,
        )
    assert sum(second is Answer.FEASIBLE for _, second in outcomes) > 5
    assert sum(second is Answer.INFEASIBLE for _, second in outcomes) > 5
    assert sum(second is Answer.UNDECIDED for _, second in outcomes) < 5
