"""Lower bounds: exact where optima are known, and below every feasible motion that any method here can produce."""

from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest

from baselines.bounds import lower_bounds, strands
from baselines.bounds.any_motion import AnyMotionBound
from baselines.bounds.cell_times import Cells, jerk_reach, reach, shortest_times
from baselines.bounds.joined_times import last_jerk_crossing
from baselines.bounds.lower_bounds import bound, lower_bound, with_implied_acceleration
from baselines.bounds.strands import all_chains, first_strands
from baselines.closed_forms import two_limit_time
from baselines.free_path.nlp import free_path
from baselines.path_timing.toppra import retime
from baselines.state_to_state import via as via_module
from baselines.state_to_state.moves import Mover, State
from baselines.state_to_state.stops import ruckig_stops
from baselines.state_to_state.via import ruckig_via
from study import EndCondition, JointLimits, Problem, deadline, judge
from study.curves import CURVES
from study.deadline import Deadline
from study.planning import Freedom, RunSettings
from study.supervisor import supervised
from tests.helpers.closed_forms import shortest_time
from tests.helpers.reference_problems import EACH_LIMIT, INF, LIMITS_AND_ENDS, small, woodworking


def point(value):
    return Cells(np.array([value]), np.array([value]))


def test_with_points_for_cells_it_is_the_shortest_time():
    rng = np.random.default_rng(0)
    for _ in range(500):
        velocity, acceleration = 10 ** rng.uniform(-1, 1, 2)
        d = rng.normal() * 10 ** rng.uniform(-2, 1)
        v0, v1 = velocity * rng.uniform(-1, 1, 2)
        rates = np.array([velocity, acceleration, INF])
        expected = shortest_time(d, v0, v1, velocity, acceleration)
        assert shortest_times(d, point(v0), point(v1), rates, 0.0)[0, 0] == pytest.approx(expected, rel=1e-7)


def test_a_cell_is_never_slower_than_any_of_its_points():
    rng = np.random.default_rng(1)
    for _ in range(300):
        velocity, acceleration = 10 ** rng.uniform(-1, 1, 2)
        d = rng.normal() * 10 ** rng.uniform(-2, 1)
        edges = np.sort(velocity * rng.uniform(-1, 1, (2, 2)))
        start, end = (Cells(*np.array(edge)[:, None]) for edge in edges)
        lower = shortest_times(d, start, end, np.array([velocity, acceleration, INF]), 0.0)[0, 0]
        v0, v1 = (rng.uniform(*edge, 50) for edge in edges)
        assert lower <= shortest_time(d, v0, v1, velocity, acceleration).min() * (1 + 1e-9)


def test_waiting_for_another_joint_may_mean_waiting_longer():
    rates, fast = np.array([9.0, 1.0, INF]), point(1.0)
    assert shortest_times(0.4, fast, fast, rates, 0.0)[0, 0] == pytest.approx(np.sqrt(5.6) - 2)
    stop_and_go = 2 * np.sqrt(0.6) + 2  # brakes, backs up, and comes again
    assert shortest_times(0.4, fast, fast, rates, 1.5)[0, 0] == pytest.approx(stop_and_go)
    assert shortest_times(0.4, fast, fast, rates, 9.0)[0, 0] == pytest.approx(9.0)


def test_reach_is_the_integral_of_the_envelope():
    for a, b, limit, time in [(0.2, 0.4, 1.0, 2.0), (0.2, -0.3, 0.5, 3.0), (0.9, -0.9, 1.0, 0.5)]:
        t = np.linspace(0, time, 200001)
        envelope = np.minimum(np.minimum(a + 1.5 * t, b + 1.5 * (time - t)), limit)
        middle = (envelope[1:] + envelope[:-1]) / 2
        value = reach(np.array(time), np.array(a), np.array(b), limit, 1.5)
        assert value == pytest.approx(middle.sum() * time / 200000, abs=1e-8)


def test_the_bend_crossing_is_the_largest_root():
    rng = np.random.default_rng(2)
    for _ in range(300):
        a, b, d = rng.normal(size=3) * 10 ** rng.uniform(-2, 2, 3)
        jerk = 10 ** rng.uniform(-1, 2)
        roots = np.roots([jerk / 12, 0, (a + b) / 2, -d])
        real = roots[np.abs(roots.imag) < 1e-9 * np.abs(roots).max()].real
        time = last_jerk_crossing(d, np.array(a), np.array(b), jerk)
        if (real > 0).any():
            assert time == pytest.approx(real.max(), rel=1e-5)
            assert jerk_reach(time, np.array(a), np.array(b), jerk) == pytest.approx(d, rel=1e-6, abs=1e-9)


def test_no_jerk_limited_move_is_faster_than_its_cells():
    rng, moves = np.random.default_rng(3), 0
    for _ in range(300):
        limits = JointLimits(*10 ** rng.uniform(-1, 1, (3, 1)))
        v0, v1 = limits.velocity * rng.uniform(-0.6, 0.6, 2)
        a0, a1 = rng.uniform(-0.3, 0.3, 2) * np.minimum(limits.acceleration, np.sqrt(limits.velocity * limits.jerk))
        d = rng.normal() * 10 ** rng.uniform(-2, 0.5)
        zero = np.zeros(1)
        _, own = Mover(limits).times(State(zero, v0 + zero, a0 + zero), State(d + zero, v1 + zero, a1 + zero))
        lower = shortest_times(d, point(v0), point(v1), limits.rates[:, 0], 0.0)[0, 0]
        assert lower <= own[0] * (1 + 1e-9)
        moves += np.isfinite(own[0])
    assert moves > 200


@pytest.mark.parametrize(("distance", "velocity", "acceleration"), [(1.0, 9.0, 4.0), (3.0, 1.0, 2.0), (3.0, 1.0, INF)])
def test_one_segment_from_rest_to_rest_is_exact(distance, velocity, acceleration):
    problem = Problem("line", [[0.0], [distance]], JointLimits([velocity], [acceleration]))
    assert lower_bound(problem) == pytest.approx(float(two_limit_time(distance, velocity, acceleration)), rel=1e-6)


def test_with_velocity_limits_only_it_is_attained():
    problem = woodworking(acceleration=INF)
    assert lower_bound(problem) == pytest.approx(ruckig_stops(problem).duration, rel=1e-6)


def test_dynamic_programming_against_all_chains():
    problem = small(([1.0] * 3, [2.0] * 3, INF))
    chains = all_chains(problem, first_strands(problem, 6, 10.0))[0]
    weights = np.array([0.2, 0.5, 0.3])
    value, times = chains.cheapest(weights)
    first, second, third = chains.times
    every = weights[0] * first[:, :, None, None] + weights[1] * second[:, :, None] + weights[2] * third
    assert value == pytest.approx(every.min())
    assert weights @ times == pytest.approx(value)
    through = chains.through(weights)
    assert through[1] == pytest.approx(every.min(axis=(0, 2, 3)))
    assert through[2] == pytest.approx(every.min(axis=(0, 1, 3)))


@pytest.mark.parametrize(("limits", "end"), LIMITS_AND_ENDS)
def test_no_motion_is_faster(limits, end):
    problem = small(limits, end, seed=5)
    lower = bound(problem, n_cells=60).value
    motions = [ruckig_stops(problem), free_path(problem, 4).motion, ruckig_via(problem, 30, 4)[0]]
    best = min(motion.duration for motion in motions)
    assert bound(problem, best, 30, 2).value <= best
    for motion in motions:
        assert judge(problem, motion).feasible
        assert motion.duration >= lower * (1 - 1e-6)  # the judge forgives 1e-6 of a limit


@pytest.mark.parametrize("end", list(EndCondition))
def test_jerk_and_velocity_limits_bound_acceleration_between_rests(end):
    problem = small(([1.0, 0.5, 2.0], INF, [9.0, 5.0, 400.0]), end, seed=3)
    implied = with_implied_acceleration(problem).limits.acceleration
    if end is EndCondition.FREE:
        assert np.isinf(implied).all()
        return
    assert implied == pytest.approx(np.sqrt([18.0, 5.0, 1600.0]))
    motion = free_path(problem, 8).motion
    assert (motion.extrema(2).peak <= implied * (1 + 1e-6)).all()
    without = Problem("without", problem.waypoints, JointLimits(problem.limits.velocity), end=end)
    assert lower_bound(without) < lower_bound(problem) <= motion.duration


def test_a_jump_of_speed_from_limit_to_limit_needs_all_of_the_implied_acceleration():
    """From -V to V and back without rest in between: jerk up, jerk down, and the peak in the middle is sqrt(2 V J)."""
    limits, rest = JointLimits([1.0], [INF], [2.0]), np.zeros(1)
    solved = Mover(limits).pieces(State(rest, -np.ones(1), rest), State(rest, np.ones(1), rest))
    widths, cubics = solved
    peaks = np.abs(2 * cubics[:, 2, 0] + 6 * cubics[:, 3, 0] * widths)
    assert peaks.max() == pytest.approx(np.sqrt(2 * 1.0 * 2.0))


@pytest.mark.parametrize("end", [EndCondition.REST, EndCondition.FREE])
def test_no_stretched_random_spline_and_no_retimed_path_is_faster(end):
    problem = small(EACH_LIMIT["acceleration binds"], end, seed=7, n_waypoints=6)
    lower = bound(problem, n_cells=60).value
    rng = np.random.default_rng(0)
    for durations in rng.uniform(0.2, 2.0, (100, 5)):
        motion = CURVES["cubic-spline"].motion(problem.waypoints, durations)
        ratios = judge(problem, motion).ratios.max(axis=1)
        assert motion.duration * max(ratios[0], np.sqrt(ratios[1])) >= lower
    assert retime(problem, 100).motion.duration >= lower


def test_the_sandwich_is_thin_without_jerk_limits():
    problem = woodworking()
    upper = ruckig_via(problem, 100)[0].duration
    assert 0.99 * upper < lower_bound(problem) < upper
    assert 0.998 * upper < bound(problem, upper).value < upper


def test_more_cells_and_more_joints_tighten_it():
    coarse, middle, fine = (bound(woodworking(), n_cells=n, refinements=0).value for n in (10, 40, 160))
    assert coarse < middle < fine
    assert fine >= max(lower_bound(woodworking().joint(j)) for j in range(4)) * (1 - 1e-4)


def test_a_free_end_is_not_assumed_to_rest():
    problem = Problem("line", [[0.0], [1.0]], JointLimits([2.0], [1.0]), end=EndCondition.FREE)
    assert lower_bound(problem) == pytest.approx(0.5, rel=1e-2)
    assert lower_bound(problem) <= 0.5


def test_scaled_limits_scale_the_bound():
    problem = woodworking()
    slower = Problem("slower", problem.waypoints, problem.limits.scaled(7.0))
    assert lower_bound(slower) == pytest.approx(7 * lower_bound(problem), rel=1e-3)


def test_it_is_not_slower_than_a_motion_that_reverses_or_dwells():
    problem = Problem("dwell", [[0.0], [1.0], [1.0], [0.2]], JointLimits([1.0], [1.0]), allow_dwell=True)
    assert lower_bound(problem) <= ruckig_stops(problem).duration
    assert lower_bound(problem) <= free_path(problem).motion.duration


def test_the_registered_bound_is_tightened_by_a_motion_that_it_seeks_first():
    proved = AnyMotionBound(n_cells=32, refinements=1).bound(woodworking(), RunSettings("poly353"))
    assert proved.freedom is Freedom.FREE
    assert 0.98 * proved.details["known"] < proved.value < proved.details["known"] < 3.37
    still = Problem("still", [[1.0], [1.0]], JointLimits([1.0]), allow_dwell=True)
    assert AnyMotionBound().bound(still, RunSettings("poly353")).value == 0.0


@pytest.fixture
def looks(monkeypatch):
    """A clock on which every look takes a second; the bounds of segments made meanwhile."""
    made, clock = [], count()
    monkeypatch.setattr(deadline, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    for name in ("first_times", "past_gaps"):
        whole = getattr(strands, name)
        monkeypatch.setattr(strands, name, lambda *args, whole=whole: made.append(1) or whole(*args))
    return SimpleNamespace(made=made, now=lambda: next(clock))


def test_a_deadline_ends_the_bound_between_two_segments_and_what_it_proved_holds(looks):
    problem = small(EACH_LIMIT["all"], seed=5, n_waypoints=6)
    whole = bound(problem, n_cells=12, refinements=3)
    work, values = len(looks.made), []
    for seconds in (-1, 7, 110, 130, 240):
        looks.made.clear()
        with supervised() as watch:
            cut = bound(problem, n_cells=12, refinements=3, deadline=Deadline(looks.now() + seconds))
        assert watch.deadline_reached
        assert len(looks.made) <= max(seconds, 0) < work
        assert cut.rounds <= whole.rounds
        values.append(cut.value)
    straight = float((np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity).max(axis=1).sum())
    assert values[0] == values[1] == pytest.approx(straight)
    assert straight < values[2] < values[-1] <= whole.value
    assert values == sorted(values)
    with supervised() as watch:
        assert bound(problem, n_cells=12, refinements=3, deadline=Deadline(looks.now() + 1e6)).value == whole.value
    assert not watch.deadline_reached


def test_weights_are_sought_until_the_deadline_and_at_least_once(looks):
    problem = woodworking()
    drawn = first_strands(problem, 12, 5.0)
    joints, covers = all_chains(problem, drawn), [strand.cover for strand in drawn]
    once, _, rounds = lower_bounds.best_weights(joints, covers, Deadline(-np.inf))
    some, _, more = lower_bounds.best_weights(joints, covers, Deadline(looks.now() + 2.5))
    best, _, all_rounds = lower_bounds.best_weights(joints, covers)
    assert (rounds, more) == (1, 3)
    assert all_rounds > 3
    assert once <= some <= best


def test_after_its_time_limit_the_planner_asks_no_solver(monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("there is no time for this")

    monkeypatch.setattr(via_module, "free_path", refuse)
    monkeypatch.setattr(strands, "first_times", refuse)
    monkeypatch.setattr(lower_bounds, "chain_weights", refuse)
    with supervised() as watch:
        proved = AnyMotionBound().bound(woodworking(), RunSettings("poly353", time_limit=1e-9))
    assert watch.deadline_reached
    assert 0 < proved.value < 3.2 < proved.details["known"] < np.inf
