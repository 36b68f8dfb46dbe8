"""Times under three limits at once: exact where optima are known, and below what Ruckig needs between any two states."""

import numpy as np
import pytest

from baselines.bounds.cell_times import Cells, shortest_times
from baselines.bounds.chain_weights import chain_weights, equal_weights, within_one
from baselines.bounds.joined_times import joined_time
from baselines.bounds.lower_bounds import bound
from baselines.bounds.strands import first_strands
from baselines.closed_forms import rest_to_rest_time, three_limit_time
from baselines.free_path.nlp import free_path
from baselines.state_to_state.moves import Mover, State
from study import EndCondition, JointLimits, Problem, judge


def test_between_rests_without_acceleration_it_is_the_optimum():
    rng, rest = np.random.default_rng(0), Cells(np.zeros(1), np.zeros(1), 0.0)
    for rates in 10 ** rng.uniform(-2, 2, (300, 3)):
        rates[1] = min(rates[1], np.sqrt(2 * rates[0] * rates[2]))
        distance = rng.choice([-1, 1]) * 10 ** rng.uniform(-3, 2)
        shortest = float(three_limit_time(distance, *rates))
        assert shortest * (1 - 1e-6) <= shortest_times(distance, rest, rest, rates, 0.0)[0, 0] <= shortest


def test_one_move_from_rest_to_rest_is_proved_to_be_the_fastest():
    rng = np.random.default_rng(1)
    for rates in 10 ** rng.uniform(-2, 2, (20, 3, 1)):
        problem = Problem("line", [[0.0], [10 ** rng.uniform(-3, 2)]], JointLimits(*rates), end=EndCondition.SMOOTH)
        shortest = float(rest_to_rest_time(problem.waypoints[1], rates)[0])
        assert shortest * (1 - 1e-6) < bound(problem, refinements=0).value <= shortest


def test_no_move_between_states_is_faster():
    rng, moves = np.random.default_rng(2), 0
    for _ in range(300):
        limits = JointLimits(*10 ** rng.uniform(-1, 1, (3, 1)))
        velocity, acceleration, jerk = limits.rates[:, 0]
        v = velocity * rng.uniform(-0.6, 0.6, (2, 1))
        a = rng.uniform(-0.3, 0.3, (2, 1)) * min(acceleration, np.sqrt(velocity * jerk))
        distance = 10 ** rng.uniform(-2, 0.5)
        _, own = Mover(limits).times(State(np.zeros(1), v[0], a[0]), State(np.full(1, distance), v[1], a[1]))
        for slopes in ((acceleration, acceleration), (max(a[0, 0], 0.0), max(-a[1, 0], 0.0))):
            assert joined_time(np.zeros(1), distance, (v[0], v[1]), slopes, limits.rates[:, 0])[0] <= own[0] * (
                1 + 1e-9
            )
        moves += np.isfinite(own[0])
    assert moves > 200


def waves(rng, n_waypoints):
    """Three joints through points of smooth waves, at times close together, under limits that all bind in turn."""
    at = np.linspace(0, rng.uniform(0.1, 6), n_waypoints)[:, None]
    points = np.sin(at * rng.uniform(0.3, 1.5, 3) + rng.uniform(0, 6, 3))
    velocity, acceleration, jerk = 10 ** rng.uniform(-1, 1, (3, 3))
    limits = JointLimits(velocity, acceleration, np.inf if rng.random() < 0.25 else jerk)
    return Problem("waves", points, limits, end=list(EndCondition)[rng.integers(3)])


@pytest.mark.parametrize("count", [3, pytest.param(100, marks=[pytest.mark.slow, pytest.mark.timeout(1200)])])
def test_no_motion_of_the_free_path_program_is_faster(count):
    rng = np.random.default_rng(3)
    for _ in range(count):
        problem = waves(rng, int(rng.integers(2, 7)))
        motion = free_path(problem, 3).motion
        assert judge(problem, motion).feasible
        assert bound(problem, n_cells=12, refinements=0).value <= motion.duration * (1 + 1e-6)
        assert bound(problem, motion.duration, 8, 2).value <= motion.duration


def test_skipping_waypoints_helps_where_they_are_dense():
    problem = waves(np.random.default_rng(5), 17)
    every, strands = bound(problem, refinements=0).value, first_strands(problem, 4, 9.0, (1, 2, 5))
    assert [len(strand.points) for strand in strands[:3]] == [17, 9, 5]
    assert strands[2].cover.tolist() == [0] * 4 + [1] * 4 + [2] * 4 + [3] * 4
    thinned = Problem("thinned", problem.waypoints[::4], problem.limits, end=problem.end)
    assert bound(thinned, refinements=0).value <= every * (1 + 1e-3)


def test_weights_add_up_to_at_most_one():
    covers = [np.array([0, 1, 2]), np.array([0, 0, 1]), np.array([0, 0, 0])]
    weights = within_one([np.array([0.5, 2.0, 1.0]), np.array([0.5, 0.5]), np.array([0.2])], covers)
    total = sum(weight[cover] for weight, cover in zip(weights, covers, strict=True))
    assert total.max() <= 1 + 1e-15
    assert [len(weight) for weight in equal_weights(covers)] == [3, 2, 1]
    best, value = chain_weights([[np.array([1.0, 1.0, 2.0])], [np.array([2.5, 1.0])], [np.array([4.2])]], covers)
    assert value == pytest.approx(4.5)
    assert best[1][0] == pytest.approx(1.0)
    assert best[0][2] == pytest.approx(1.0)
