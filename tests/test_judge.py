"""The judge: each demand of a problem broken in turn, and only that one."""

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem, StudyError, Trajectory, judge
from study.curves import CURVES
from study.demands import PLAIN, Demand, refusal

WOODWORKING = np.array(
    [[0.8, 0.578, 0.688, 0.459], [1.2, 0.868, 0.567, 0.964], [3.141, 1.897, 1.468, 2.355], [0, 1.047, 1.771, 0.754]]
).T
WOODWORKING_LIMITS = JointLimits([0.6, 0.6, 1.8, 1.8], [0.8, 0.8, 2.4, 2.4])


def cubic(duration=1.0):
    """Rest to rest over one unit: 3s^2 - 2s^3; peaks 1.5/T, 6/T^2, 12/T^3."""
    return Trajectory(
        np.array([0.0, duration]),
        (np.array([0, 0, 3.0, -2.0]) / duration ** np.arange(4))[None, :, None],
        np.array([0.0, duration]),
    )


def problem(velocity=10.0, acceleration=np.inf, jerk=np.inf, **rest):
    limits = JointLimits([velocity], [acceleration], [jerk], rest.pop("lower", [-9.0]), rest.pop("upper", [9.0]))
    return Problem("p", [[0.0], [1.0]], limits, **{"end": EndCondition.REST} | rest)


@pytest.mark.parametrize(("kind", "peak", "order"), [("velocity", 1.5, 1), ("acceleration", 6.0, 2), ("jerk", 12.0, 3)])
def test_each_rate_binds_in_turn(kind, peak, order):
    exact = judge(problem(**{kind: peak}), cubic())
    assert exact.feasible
    assert exact.worst_ratio == pytest.approx(1.0, abs=1e-12)
    broken = judge(problem(**{kind: peak * 0.99}), cubic())
    assert not broken.feasible
    assert [reason.split()[0] for reason in broken.reasons] == [kind]
    assert broken.violation == pytest.approx(1 / 0.99 - 1)
    slower = cubic(0.99 ** (-1 / order))
    assert judge(problem(**{kind: peak * 0.99}), slower).feasible


def test_the_tolerance_is_one_part_in_a_million():
    assert judge(problem(velocity=1.5 / (1 + 0.9e-6)), cubic()).feasible
    assert not judge(problem(velocity=1.5 / (1 + 1.1e-6)), cubic()).feasible


def test_where_and_how_much_is_reported():
    verdict = judge(problem(velocity=2.0, acceleration=12.0), cubic())
    assert verdict.ratios[:, 0].tolist() == [0.75, 0.5, 0.0]
    assert verdict.peaks[:, 0] == pytest.approx([1.5, 6.0, 12.0])
    assert verdict.times[0, 0] == pytest.approx(0.5)
    assert verdict.segments.tolist() == [[0], [0], [0]]
    assert verdict.end_velocity.tolist() == [[0.0], [0.0]]
    assert verdict.end_acceleration[:, 0] == pytest.approx([6.0, -6.0])
    assert verdict.overshoot.tolist() == [0.0]
    assert verdict.continuity == 2
    assert verdict.duration == 1.0


def test_a_missed_waypoint_is_infeasible():
    off = Problem("p", [[0.0], [1.001]], JointLimits([10.0]))
    verdict = judge(off, cubic())
    assert verdict.waypoint_error == pytest.approx([1e-3])
    assert verdict.reasons[0].startswith("misses a waypoint")


def test_end_conditions():
    assert judge(problem(end=EndCondition.REST), cubic()).feasible
    smooth = judge(problem(jerk=60.0, end=EndCondition.SMOOTH), cubic())
    assert "acceleration of joint 1 is" in smooth.reasons[0]
    assert judge(problem(acceleration=60.0, end=EndCondition.SMOOTH), cubic()).feasible
    line = Trajectory(np.array([0.0, 1.0]), np.array([[[0.0], [1.0]]]), np.array([0.0, 1.0]))
    assert judge(problem(acceleration=1.0, end=EndCondition.FREE), line).feasible
    assert "velocity of joint 1 is" in judge(problem(acceleration=1.0), line).reasons[0]
    assert "velocity of joint 1 is" in judge(problem(jerk=1.0), line).reasons[0]
    assert judge(problem(end=EndCondition.SMOOTH), line).feasible


def two_lines(first_slope):
    """Two straight pieces from 0 over 1 to 2 with a step in velocity unless the slope is 1."""
    times = np.array([1 / first_slope, 1.0])
    return Trajectory.from_pieces(times, np.array([[[0.0], [first_slope]], [[1.0], [1.0]]]))


def test_steps_need_infinite_rates():
    points = [[0.0], [1.0], [2.0]]
    free = Problem("p", points, JointLimits([10.0]), end=EndCondition.FREE)
    assert judge(free, two_lines(2.0)).feasible
    assert judge(free, two_lines(2.0)).continuity == 0
    bounded = Problem("p", points, JointLimits([10.0], [10.0]), end=EndCondition.FREE)
    assert "velocity of joint 1 jumps by 1" in judge(bounded, two_lines(2.0)).reasons[0]
    assert judge(bounded, two_lines(1.0)).feasible


def test_a_step_in_acceleration_breaks_a_jerk_limit_only():
    parabolas = Trajectory.from_pieces(
        np.ones(2), np.array([[[0.0], [0.0], [0.5]], [[0.5], [1.0], [-0.5]]]), pieces_per_segment=2
    )
    assert judge(problem(acceleration=1.0), parabolas).feasible
    verdict = judge(problem(acceleration=1.0, jerk=1e6), parabolas)
    assert verdict.reasons == ("acceleration of joint 1 jumps by 2 at a knot",)
    assert verdict.continuity == 1


def test_a_position_jump_is_never_feasible():
    broken = Trajectory.from_pieces(np.ones(2), np.array([[[0.0], [0.0]], [[1.0], [0.0]]]), pieces_per_segment=2)
    verdict = judge(problem(), broken)
    assert verdict.continuity == -1
    assert "position of joint 1 jumps" in verdict.reasons[0]


def test_range_of_positions_and_overshoot():
    swing = Trajectory(np.array([0.0, 1.0]), np.array([[[0.0], [0.0], [6.0], [-5.0]]]), np.array([0.0, 1.0]))
    top = 6 * 0.8**2 - 5 * 0.8**3
    verdict = judge(problem(velocity=100, end=EndCondition.FREE, upper=[1.1]), swing)
    assert verdict.overshoot == pytest.approx([top - 1])
    assert verdict.position_excess == pytest.approx([top - 1.1])
    assert "leaves its range of positions" in verdict.reasons[0]


def test_shapes_must_match():
    with pytest.raises(StudyError, match="must have 1 joints and pass 2 waypoints, it has 1 and 3"):
        judge(problem(), two_lines(1.0))


@pytest.mark.parametrize(
    ("durations", "ratio"),
    [
        ([1.7301, 3.5905, 1.9008], 1.0340),  # Table 5, PSO, joint 1
        ([1.9488, 3.1077, 2.0645], 1.0403),  # Table 5, Gold-SA, joint 1
        ([2.1107, 2.9540, 2.0025], 1.0711),  # Table 5, GoldS-PSO, joint 1
    ],
)
def test_the_woodworking_papers_joint_1_breaks_its_own_acceleration_limit(durations, ratio):
    one = Problem("woodworking", WOODWORKING, WOODWORKING_LIMITS).joint(0)
    verdict = judge(one, CURVES["poly353"].motion(one.waypoints, np.array(durations)))
    assert verdict.ratios[1, 0] == pytest.approx(ratio, abs=5e-5)
    assert not verdict.feasible
    assert "acceleration of joint 1" in verdict.reasons[0]


def test_the_woodworking_papers_synchronised_total_is_feasible():
    case = Problem("woodworking", WOODWORKING, WOODWORKING_LIMITS, end=EndCondition.SMOOTH)
    verdict = judge(case, CURVES["poly353"].motion(WOODWORKING, np.array([2.3189, 2.9540, 2.6047])))
    assert verdict.feasible
    assert verdict.duration == pytest.approx(7.8776)
    assert verdict.ratios[0].max() == pytest.approx(0.9879, abs=5e-5)
    assert verdict.ratios[1].max() == pytest.approx(0.8888, abs=5e-5)
    assert verdict.continuity == 2


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_scaling_limits_and_motion_together_changes_no_ratio(factor):
    rng = np.random.default_rng(2)
    points = rng.normal(size=(6, 3))
    limits = JointLimits([2.0] * 3, [3.0] * 3, [9.0] * 3)
    motion = CURVES["cubic-spline"].motion(points, rng.uniform(0.5, 1.5, 5))
    before = judge(Problem("p", points, limits), motion)
    after = judge(Problem("p", points, limits.scaled(factor)), motion.scaled(factor))
    assert after.ratios == pytest.approx(before.ratios, rel=1e-9)
    assert after.duration == pytest.approx(before.duration * factor)


def test_tiny_and_huge_units_are_judged_alike():
    for unit in (1e-6, 1e6):
        case = Problem("p", [[0.0], [unit]], JointLimits([1.6 * unit], [6.5 * unit]))
        motion = Trajectory(cubic().knots, cubic().coefficients * unit, cubic().waypoint_times)
        assert judge(case, motion).feasible
        missed = Problem("p", [[0.0], [unit * 1.01]], JointLimits([1.6 * unit], [6.5 * unit]))
        assert not judge(missed, motion).feasible


def through_three(times=(0.0, 1.0, 2.0)):
    """Rest to rest to rest over 0, 1, 0.5, one second each; the waypoints are said to be passed at the given times."""
    legs = np.array([[0, 0, 3.0, -2.0], [1.0, 0, -1.5, 1.0]])[:, :, None]
    return Trajectory(np.arange(3.0), legs, np.array(times))


def order(points):
    return Problem("order", [[q] for q in points], JointLimits([2.0], [7.0]))


def test_waypoints_in_another_order_are_refused():
    assert judge(order([0, 1, 0.5]), through_three()).feasible
    verdict = judge(Problem("order", [[0.0], [0.5], [1.0], [0.5]], JointLimits([2.0], [7.0])), swapped())
    assert "passes the waypoints out of order" in verdict.reasons
    assert verdict.violation == np.inf


def swapped():
    """Passes 0, 1, 0.5, and says so of a problem that wants 0, 0.5, 1, 0.5."""
    motion = through_three()
    return Trajectory(motion.knots, motion.coefficients, np.array([0.0, 2.0, 1.0, 2.0]))


@pytest.mark.parametrize("times", [(0.5, 1.0, 2.0), (0.0, 1.0, 1.5), (0.1, 1.0, 1.9)])
def test_a_motion_that_begins_or_ends_away_from_its_waypoints_is_refused(times):
    points = through_three()(np.array(times))[:, 0]
    reasons = judge(order(points), through_three(times)).reasons
    assert any("passes the first waypoint at" in reason for reason in reasons)


def test_a_jerk_that_overflows_is_a_reason_and_hides_no_other():
    limits = JointLimits([10.0, 10.0], [100.0, 100.0], [np.inf, 0.001])
    problem = Problem("overflow", [[0, 0], [1, 1]], limits, EndCondition.FREE)
    coefficients = np.zeros((2, 5, 2))
    coefficients[0, 4, 0] = 1e307
    coefficients[1] = [[0, 0], [1, 0.5], [0, 0], [0, 0.5], [0, 0]]
    coefficients[0, 1] = [1, 0.5]
    verdict = judge(problem, Trajectory(np.array([0, 1e-154, 1]), coefficients, np.array([0.0, 1.0])))
    assert "jerk of joint 1 is not finite" in verdict.reasons
    assert any("jerk of joint 2 reaches 3000 of its limit" in reason for reason in verdict.reasons)
    assert not np.isnan(verdict.ratios).any()


def test_each_direction_has_its_own_limit():
    there = Problem("p", [[0.0], [1.0]], JointLimits([1.5], min_velocity=[-0.1]))
    back = Problem("p", [[1.0], [0.0]], JointLimits([1.5], min_velocity=[-0.1]))
    assert judge(there, cubic()).feasible
    homeward = Trajectory(np.array([0.0, 1.0]), np.array([[[1.0], [0], [-3.0], [2.0]]]), np.array([0.0, 1.0]))
    verdict = judge(back, homeward)
    assert verdict.ratios[0, 0] == pytest.approx(15)
    assert verdict.stretch == pytest.approx(15)
    assert judge(back, homeward.scaled(verdict.stretch)).feasible


@pytest.mark.parametrize(("kind", "peak", "power"), [("velocity", 1.5, 1), ("acceleration", 6.0, 2), ("jerk", 12.0, 3)])
def test_the_stretch_makes_a_motion_just_feasible(kind, peak, power):
    tight = problem(**{kind: peak / 8})
    verdict = judge(tight, cubic())
    assert verdict.stretch == pytest.approx(8 ** (1 / power))
    assert judge(tight, cubic().scaled(verdict.stretch)).worst_ratio == pytest.approx(1)
    assert judge(problem(), cubic()).stretch == 1.0


def test_a_planner_declines_what_it_does_not_know():
    limits = JointLimits([1.0], [2.0], [3.0], [-4.0], [5.0], min_velocity=[-0.5])
    demands = Problem("p", [[0.0], [1.0]], limits).demands
    assert demands == PLAIN | {Demand.DIRECTIONAL_LIMITS}
    assert refusal(demands, frozenset({Demand.VELOCITY})).startswith("the planner does not know limits that differ")
    assert refusal(demands, frozenset({Demand.DIRECTIONAL_LIMITS})) == ""


def test_no_step_of_rounding_is_a_fault():
    still = np.zeros((2, 2, 2))
    still[:, :, 0], still[:, 0, 1] = [[0, 1], [1, 1]], [0.7, 0.7 + 3e-15]
    motion = Trajectory(np.array([0.0, 1.0, 2.0]), still, np.array([0.0, 1.0, 2.0]))
    line = Problem("p", [[0, 0.7], [1, 0.7], [2, 0.7]], JointLimits([2.0, 2.0]), EndCondition.FREE)
    assert judge(line, motion).feasible
    still[1, 0, 1] = 0.7 + 3e-9
    reasons = judge(line, Trajectory(motion.knots, still, motion.waypoint_times)).reasons
    assert "position of joint 2 jumps by 3e-09 at a knot" in reasons


def test_a_coefficient_whose_power_of_time_vanishes_still_counts():
    coefficients = np.zeros((2, 4, 1))
    coefficients[0, :, 0] = [0, 0, 0, 1e306]
    coefficients[1, :, 0] = [1e-3, 1, 0, 0]
    width = 1e-103  # its cube is a denormal number, its product with the coefficient a millimetre
    motion = Trajectory(np.array([0, width, 1.0]), coefficients, np.array([0.0, 1.0]))
    assert motion.extrema().highest[0] == pytest.approx(1e-3 + 1)
    assert motion.between(0, width).extrema().highest[0] == pytest.approx(1e-3, rel=1e-9)


def test_no_motion_is_one_sentence():
    with pytest.raises(StudyError, match="there is no motion to judge, but a NoneType"):
        judge(problem(), None)


def test_a_verdict_is_found_again_for_the_same_problem_and_motion_only():
    motion, asked = cubic(), problem()
    first = judge(asked, motion)
    assert judge(asked, motion) is first
    assert judge(asked, cubic()).ratios == pytest.approx(first.ratios)
    assert judge(problem(velocity=1.0), motion).ratios[0, 0] == pytest.approx(1.5)
    assert judge(asked, motion).feasible
