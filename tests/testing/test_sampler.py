"""The sampler confirms what is feasible, and finds every kind of fault that samples can show."""

from dataclasses import replace

import numpy as np
import pytest

from study.api import plan
from study.problem import EndCondition, JointLimits, Problem, State, StraightPath, Timing, Tube
from study.testing import example_problems
from study.testing.attacks import adversarial
from study.testing.sampler import sampled
from study.testing.second_judge import Answer, second_judge


@pytest.mark.parametrize("problem", example_problems()[:5], ids=lambda problem: problem.name)
@pytest.mark.parametrize("planner", ["ruckig-stops", "casadi-nlp"])
def test_feasible_motions_are_confirmed_and_faster_ones_are_not(problem, planner):
    planned = plan(problem, planner)
    assert planned.feasible
    assert sampled(problem, planned.motion).confirmed
    faster = sampled(problem, planned.motion.scaled(0.9))
    assert not faster.confirmed
    assert faster.worst.startswith("limit of order") or faster.worst.startswith("end rates")


POINTS = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])
PLAIN = Problem("p", POINTS, JointLimits(np.ones(2), np.ones(2), np.full(2, 20.0)), EndCondition.REST)


@pytest.mark.parametrize(
    ("worst", "asked"),
    [
        ("waypoints", {"waypoints": POINTS + 1e-4}),
        (
            "limit of position",
            {"limits": replace(PLAIN.limits, lower=np.array([0.0, -0.1]), upper=np.array([1.4, 0.3]))},
        ),
        ("limit of segment 1", {"segment_limits": {1: PLAIN.limits.scaled(3.0)}}),
        ("end rates", {"start": State(np.full(2, 0.1)), "finish": EndCondition.REST}),
        ("stops", {"stops": [2]}),
        ("dwells", {"dwells": {1: 0.5}}),
        ("path", {"path": Tube(np.full(2, 1e-4))}),
        ("path", {"path": StraightPath(np.full(2, 1e-4))}),
        ("duration", {"timing": Timing(at_least=100.0)}),
    ],
)
def test_each_demand_that_a_motion_does_not_meet_is_named(worst, asked):
    motion = plan(PLAIN, "ruckig-stops" if worst == "dwells" else "casadi-nlp").motion
    result = sampled(replace(PLAIN, **asked), motion)
    assert not result.confirmed
    assert result.worst.startswith(worst)


def test_what_the_sampler_does_not_confirm_the_second_judge_finds_infeasible():
    refused = 0
    for number in range(60):
        _, problem, motion = adversarial(5, number)
        if not sampled(problem, motion).confirmed:
            refused += 1
            assert second_judge(problem, motion).answer is not Answer.FEASIBLE
    assert refused > 10
