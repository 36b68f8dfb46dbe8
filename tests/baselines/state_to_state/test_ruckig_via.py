"""Ruckig through the waypoints: never worse than stopping, feasible, and never slower than the free-path NLP it starts from."""

from functools import cache

import numpy as np
import pytest

from baselines.free_path.nlp import FreePathNlp, free_path
from baselines.state_to_state.moves import Mover, State
from baselines.state_to_state.stops import ruckig_stops
from baselines.state_to_state.via import RuckigVia, Source, _fastest, ruckig_via
from baselines.state_to_state.via_times import Timing, ViaStates
from study import EndCondition, JointLimits, Problem, judge
from study.cases.library import load_case
from study.planning import RunSettings, Status
from tests.helpers.closed_forms import largest_displacement, shortest_time
from tests.helpers.reference_problems import EACH_LIMIT, INF, LIMITS_AND_ENDS, small, woodworking

SETTINGS = RunSettings("cubic-spline", time_limit=60.0)


def test_the_shortest_time_between_two_velocities_is_ruckigs():
    rng = np.random.default_rng(0)
    for _ in range(200):
        limits = JointLimits(*10 ** rng.uniform(-1, 1, (2, 3)))
        distance = rng.normal(size=3) * 10 ** rng.uniform(-2, 1)
        v0, v1 = limits.velocity * rng.uniform(-1, 1, (2, 3))
        none = np.zeros(3)
        _, own = Mover(limits).times(State(none, v0, none), State(distance, v1, none))
        expected = shortest_time(distance, v0, v1, limits.velocity, limits.acceleration)
        assert own == pytest.approx(expected, rel=1e-9)


def test_no_sampled_motion_goes_farther_than_the_largest_displacement():
    rng = np.random.default_rng(1)
    v0, time, limit, a = 0.3, 1.7, 1.0, 1.2
    for _ in range(200):
        steps = rng.uniform(-1, 1, 200) * a * time / 200
        velocity = np.clip(v0 + np.append(0.0, np.cumsum(steps)), -limit, limit)
        distance = np.sum((velocity[1:] + velocity[:-1]) / 2) * time / 200
        assert distance <= largest_displacement(time, v0, velocity[-1], limit, a) + 1e-12


def test_slopes_are_those_of_the_closed_form():
    problem = small(([1.0] * 3, [2.0] * 3, INF), n_waypoints=5)
    via = ViaStates.of(problem)
    timing = Timing(via)
    x = via.variables(np.random.default_rng(0).uniform(-0.2, 0.2, (5, 3)), np.zeros((5, 3)))
    times, own = timing.moves(x)
    model = timing.model(x, times, own)
    v, steps = x[0] * via.scale[0], np.diff(problem.waypoints, axis=0)
    for side in range(2):
        moved = [v[:-1].copy(), v[1:].copy()]
        moved[side] += 1e-6
        change = (shortest_time(steps, *moved, 1.0, 2.0) - shortest_time(steps, v[:-1], v[1:], 1.0, 2.0)) / 1e-6
        rows = slice(1 - side, 4 - side)
        assert model.slopes[side, 0, rows] == pytest.approx(change[rows], abs=1e-4)


def test_what_is_free_follows_the_end_condition_and_the_limits():
    free = {end: ViaStates.of(small(EACH_LIMIT["mixed"], end)).free for end in EndCondition}
    assert free[EndCondition.FREE][0].tolist() == [[True, False, True]] * 4
    assert free[EndCondition.FREE][1].tolist() == [[True, False, True]] * 4
    assert not free[EndCondition.REST][0, [0, -1]].any()
    assert free[EndCondition.REST][1, 0].tolist() == [True, False, True]
    assert not free[EndCondition.SMOOTH][:, [0, -1]].any()


@pytest.mark.parametrize(("limits", "end"), LIMITS_AND_ENDS)
def test_each_limit_in_turn(limits, end):
    problem = small(limits, end)
    motion = ruckig_via(problem, rounds=30, pieces=4).motion
    verdict = judge(problem, motion)
    assert verdict.feasible, verdict.reasons
    assert verdict.waypoint_error.max() < 1e-10
    assert motion.duration <= ruckig_stops(problem).duration
    assert motion.duration <= free_path(problem, 4).motion.duration * (1 + 1e-3)


def test_woodworking():
    motion = ruckig_via(woodworking(), rounds=100).motion
    assert motion.duration < 3.3595
    assert judge(woodworking(), motion).feasible


@pytest.mark.parametrize("jerk", [INF, [30.0] * 6], ids=["no jerk limit", "jerk limit"])
def test_a_longer_path_of_six_joints(jerk):
    rng = np.random.default_rng(3)
    limits = JointLimits(rng.uniform(1, 3, 6), rng.uniform(2, 8, 6), jerk)
    problem = Problem("ten", rng.uniform(-1, 1, (10, 6)), limits)
    plan = RuckigVia(rounds=60, pieces=3).plan(problem, SETTINGS)
    assert plan.status is Status.FINISHED
    assert judge(problem, plan.motion).feasible
    assert plan.motion.duration < 0.95 * ruckig_stops(problem).duration


def test_one_joint_alone():
    problem = woodworking().joint(2)
    motion = ruckig_via(problem).motion
    assert judge(problem, motion).feasible
    assert motion.duration <= ruckig_stops(problem).duration


def test_with_velocity_limits_only_there_is_nothing_to_choose():
    problem = woodworking(acceleration=INF)
    motion, rounds, _ = ruckig_via(problem)
    assert rounds == 0
    assert motion.duration == pytest.approx(ruckig_stops(problem).duration)


def test_the_same_answer_twice():
    first, second = (ruckig_via(woodworking(jerk=[5.0] * 4), 20, 2)[0] for _ in range(2))
    assert first.knots.tolist() == second.knots.tolist()
    assert first.coefficients.tolist() == second.coefficients.tolist()


def test_nothing_to_move():
    still = Problem("still", [[1.0], [1.0]], JointLimits([1.0]), allow_dwell=True)
    assert RuckigVia().plan(still, SETTINGS).status is Status.NOT_APPLICABLE


def test_a_joint_that_has_nowhere_to_go_stays_at_rest():
    """Its states once took up rounding and so missed the waypoints, which left stopping everywhere as the best motion."""
    problem = load_case("puma560-jerk-matched").problem
    assert np.ptp(problem.waypoints[:, 3]) == 0
    motion = ruckig_via(problem).motion
    assert judge(problem, motion).feasible
    assert motion.duration < 0.6 * ruckig_stops(problem).duration
    assert motion.extrema(1).peak[3] == 0


def with_noise(size: float) -> Problem:
    """A waving arm of three joints, the last of which trembles by so much."""
    steps, rng = np.arange(8), np.random.default_rng(5)
    waves = [np.sin(0.9 * steps), np.cos(0.7 * steps) + 0.2 * steps, 0.3 + size * rng.uniform(-1.0, 1.0, 8)]
    return Problem("seam", np.column_stack(waves), JointLimits([2.0] * 3, [6.0] * 3, [40.0] * 3))


@cache
def quiet_duration():
    """Duration where the third joint does not move at all."""
    return RuckigVia().plan(with_noise(0.0), SETTINGS).motion.duration


SLOW = pytest.mark.slow


@pytest.mark.parametrize("size", [1e-14, 1e-4, *(pytest.param(size, marks=SLOW) for size in (1e-12, 1e-9, 1e-6))])
def test_a_joint_that_hardly_moves_does_not_spoil_the_motion_of_the_others(size):
    noisy = with_noise(size)
    motion = RuckigVia().plan(noisy, SETTINGS).motion
    assert judge(noisy, motion).feasible
    assert motion.duration <= 1.005 * quiet_duration()
    assert motion.duration <= FreePathNlp().plan(noisy, SETTINGS).motion.duration * (1 + 1e-9)


def test_moves_that_exceed_a_limit_are_slowed_down_exactly_and_said_to_be():
    problem = small(EACH_LIMIT["all"])
    stops = ruckig_stops(problem)
    hasty = stops.scaled(1 / 1.009)
    motion, source = _fastest(problem, [(hasty, Source.MOVES)])
    assert source is Source.STRETCHED
    assert judge(problem, motion).feasible
    assert hasty.duration < motion.duration <= stops.duration * (1 + 1e-9)
    assert _fastest(problem, [(stops.scaled(2.0), Source.FREE_PATH), (hasty, Source.MOVES)])[1] is Source.STRETCHED
    assert _fastest(problem, [(stops, Source.FREE_PATH), (hasty.scaled(2.0), Source.MOVES)])[1] is Source.FREE_PATH
