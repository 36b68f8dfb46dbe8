"""Every demand of a problem: a motion that just meets it, and one that just does not."""

from dataclasses import replace

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem, StudyError, Trajectory, judge
from study.curves import CURVES
from study.parametric import ParametricTrajectory
from study.path_findings import largest_deviation
from study.problem import Demand, State, StraightPath, Timing, Tube
from study.testing.second_judge import Answer, second_judge
from study.testing.second_parametric import second_judge_parametric


def judged(problem, motion):
    """Verdict of the judge, with which the second judge must agree."""
    verdict = judge(problem, motion)
    second = second_judge if isinstance(motion, Trajectory) else second_judge_parametric
    wanted = Answer.FEASIBLE if verdict.feasible else Answer.INFEASIBLE
    assert second(problem, motion).answer is wanted, verdict.reasons
    return verdict


def legs(points, durations):
    """Rest to rest from point to point, each leg 3s^2 - 2s^3 of its own straight line."""
    points, durations = np.asarray(points, dtype=float), np.asarray(durations, dtype=float)
    step = np.diff(points, axis=0)
    pieces = np.stack(
        [points[:-1], 0 * step, 3 * step / durations[:, None] ** 2, -2 * step / durations[:, None] ** 3], axis=1
    )
    return Trajectory.from_pieces(durations, pieces)


CORNER = [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]]
STOPPING = legs(CORNER, [1.0, 2.0])
LOOSE = JointLimits([10.0, 10.0], [100.0, 100.0])


def corner(**demands):
    return Problem("corner", CORNER, LOOSE, **demands)


def reasons(motion, **demands):
    return judged(corner(**demands), motion).reasons


def test_limits_of_one_segment_hold_on_that_segment_only():
    def first_at(velocity):
        return {"segment_limits": {0: JointLimits([velocity, velocity])}}

    assert not reasons(STOPPING, **first_at(1.5))
    assert reasons(STOPPING, **first_at(1.4))[0].startswith("velocity of joint 1 reaches 1.07143 of its limit at 0.5")
    assert not reasons(legs(CORNER, [2.0, 1.0]), **first_at(0.75))
    verdict = judged(corner(segment_limits={1: JointLimits([1.0, 1.0], [2.9, np.inf])}), STOPPING)
    assert verdict.ratios[:, 1].tolist() == pytest.approx([1.5, 0.03, 0])
    assert verdict.segments[0, 1] == 1
    assert verdict.times[0, 1] == pytest.approx(2.0)
    assert judged(corner(segment_limits={1: JointLimits([1.0, 1.0])}), STOPPING.scaled(verdict.stretch)).feasible


def test_a_range_of_positions_of_one_segment():
    swing = Trajectory.from_pieces(
        np.ones(2), np.array([[[0.0], [6.0], [-5.0]], [[1.0], [-4.0], [5.0]]]), pieces_per_segment=1
    )
    points, limits = [[0.0], [1.0], [2.0]], JointLimits([9.0])

    def on(segment, **box):
        box = {segment: JointLimits([9.0], **box)}
        return judged(Problem("p", points, limits, EndCondition.FREE, segment_limits=box), swing).reasons

    assert not on(1, upper=[2.0], lower=[0.2])
    assert "leaves its range of positions by 0.8" in on(0, upper=[1.0])[0]
    assert "leaves its range of positions by 0.1" in on(1, lower=[0.3])[0]


def moving(velocity, acceleration=0.0):
    """One joint from 0 to 1 in one second with the given rates at the start, at rest at the end."""
    v, a = velocity, acceleration
    return Trajectory(
        np.array([0.0, 1.0]),
        np.array([[[0.0], [v], [a / 2], [4 - 3 * v - a], [-3 + 2 * v + a / 2]]]),
        np.array([0.0, 1.0]),
    )


def test_a_moving_start_must_have_the_given_rates():
    limits = JointLimits([9.0], [50.0], [500.0])

    def wanted(velocity, acceleration=None):
        start = State([velocity], None if acceleration is None else [acceleration])
        return Problem("p", [[0.0], [1.0]], limits, EndCondition.REST, start=start)

    assert judged(wanted(0.5), moving(0.5, 3.0)).feasible
    assert judged(wanted(0.5, 3.0), moving(0.5, 3.0)).feasible
    assert judged(wanted(0.6), moving(0.5)).reasons == ("velocity of joint 1 is 0.5 at the start, not 0.6",)
    assert judged(wanted(0.5, 2.0), moving(0.5)).reasons == ("acceleration of joint 1 is 0 at the start, not 2",)
    assert not wanted(0.5).scalable
    assert Demand.MOVING_ENDS in wanted(0.5).demands


def test_each_end_has_its_own_condition():
    limits = JointLimits([9.0], [50.0], [500.0])
    free = Problem("p", [[0.0], [1.0]], limits, EndCondition.REST, start=EndCondition.FREE)
    assert judged(free, moving(0.5)).feasible
    assert Demand.DIFFERENT_ENDS in free.demands
    assert free.scalable
    turned = Problem("p", [[0.0], [1.0]], limits, EndCondition.REST, finish=EndCondition.FREE)
    assert judged(turned, moving(0.5)).reasons == ("velocity of joint 1 is 0.5 at the start, not zero",)
    plain = Problem("p", [[0.0], [1.0]], limits, EndCondition.FREE, start=State([0.0]), finish=EndCondition.REST)
    assert plain.end is EndCondition.REST
    assert not {Demand.DIFFERENT_ENDS, Demand.MOVING_ENDS} & plain.demands


def straight_through():
    """Both legs at constant velocity 1 without stopping."""
    return Trajectory.from_pieces(np.array([1.0, 2.0]), np.array([[[0.0, 0], [1.0, 0]], [[1.0, 0], [0.0, 1.0]]]))


def test_a_stop_has_zero_velocity():
    line = Problem("p", [[0.0], [1.0], [2.0]], JointLimits([9.0], [9.0]), EndCondition.FREE, stops=[1])
    stopping, passing = (
        legs(line.waypoints, [1.0, 1.0]),
        Trajectory.from_pieces(np.ones(2), np.ones((2, 2, 1)) * [[[0], [1]], [[1], [1]]]),
    )
    assert judged(line, stopping).feasible
    assert judged(line, passing).reasons == ("does not stop at waypoint 2: joint 1 moves at 1",)


def resting(time):
    """Three points of one joint, one second a leg, standing still at the second for some time."""
    pieces = np.array([[0.0, 0, 3, -2], [1.0, 0, 0, 0], [1.0, 0, 3, -2]])[:, :, None]
    return Trajectory.from_pieces(np.array([1.0, time, 1.0]), pieces, np.array([1, 2]))


def test_a_dwell_stands_still_from_the_arrival_on():
    points, limits = [[0.0], [1.0], [2.0]], JointLimits([9.0], [99.0])
    wanted = Problem("p", points, limits, dwells={1: 0.4})
    assert judged(wanted, resting(0.4)).feasible
    assert judged(wanted, resting(0.4).scaled(1.1)).feasible
    assert judged(wanted, resting(0.399)).reasons == ("does not stand still for 0.4 s at waypoint 2",)
    assert judged(wanted, legs(points, [1.0, 1.0])).reasons == ("does not stand still for 0.4 s at waypoint 2",)
    assert {Demand.DWELLS} == wanted.demands & {Demand.DWELLS, Demand.STOPS}


@pytest.mark.parametrize(
    ("tolerance", "passes"),
    [(0.1, True), (0.09, False), ([0, 0.1, 0], True), ([0.1, 0, 0.1], False), ([[0, 0], [0.1, 0], [0, 0]], True),
     ([[0, 0], [0, 0.1], [0, 0]], False)],
)  # fmt: skip
def test_a_waypoint_may_be_passed_within_its_tolerance(tolerance, passes):
    near = legs([[0.0, 0.0], [0.9, 0.0], [1.0, 2.0]], [1.0, 2.0])
    assert judged(corner(tolerance=tolerance), near).feasible is passes
    assert Demand.TOLERANCE in corner(tolerance=tolerance).demands


def test_a_tube_holds_the_path_between_the_waypoints():
    bow = Trajectory.from_pieces(
        np.array([1.0, 2.0]),
        np.array([[[0.0, 0], [1, 0.4], [0, -0.4]], [[1.0, 0], [0.0, 1.0], [0, 0]]]),
    )
    assert not judged(corner(end=EndCondition.FREE, path=Tube(0.1)), bow).reasons[1:]  # the step of velocity alone
    free = Problem("corner", CORNER, JointLimits([10.0, 10.0]), path=Tube(0.1))
    assert judged(free, bow).feasible
    tight = Problem("corner", CORNER, JointLimits([10.0, 10.0]), path=Tube([1.0, 0.099]))
    assert judged(tight, bow).reasons == ("leaves the tube between waypoints 1 and 2: 1.0101 of its radius",)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("curve", ["cubic-spline", "bspline"])
def test_the_largest_deviation_is_the_radius_of_the_narrowest_tube(seed, curve):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(5, 3))
    points[1, 0], points[2:4, 1] = points[0, 0], points[2, 1]  # a joint that stands still for a segment
    motion = CURVES[curve].motion(points, rng.uniform(0.5, 1.5, 4))
    points = motion(motion.waypoint_times)
    problem = Problem("p", points, JointLimits([1e3] * 3))
    radius = largest_deviation(problem, motion)
    tubes = [replace(problem, path=Tube(radius * share)) for share in (1 - 1e-5, 1 + 1e-5)]
    narrow, wide = (judge(tube, motion).reasons for tube in tubes)
    assert any("leaves the tube" in reason for reason in narrow)
    assert not any("leaves the tube" in reason for reason in wide)


def test_straight_motions_deviate_by_nothing_and_a_blend_by_its_distance():
    assert largest_deviation(corner(), STOPPING) < 1e-15
    assert largest_deviation(corner(), blended(0.2)) == pytest.approx(0.05)


def diagonal(bow):
    """From 0 to (1, 1), off the line by `bow` in the first and back in the second joint, for a moment."""
    return Trajectory(
        np.array([0.0, 1.0]), np.array([[[0.0, 0], [1 + 4 * bow, 1], [-4 * bow, 0]]]), np.array([0.0, 1.0])
    )


def test_a_tube_around_a_diagonal_is_measured_in_every_pair_of_joints():
    def inside(radius):
        return judged(
            Problem("p", [[0, 0], [1, 1]], JointLimits([9.0, 9.0]), path=Tube(radius)), diagonal(0.2)
        ).feasible

    assert inside(0.1)  # the middle of the line's nearest stretch is off by half the bow in each joint
    assert not inside(0.0999)
    assert inside([0.15, 0.05])
    assert not inside([0.15, 0.0499])


def blended(size):
    """Along the first joint, a quarter turn that begins `size` before the corner, and along the second joint."""
    s = size
    pieces = [[[0, 0], [1, 0], [0, 0]], [[1 - s, 0], [1, 0], [-0.25 / s, 0.25 / s]], [[1, s], [0, 1], [0, 0]]]
    motion = Trajectory.from_pieces(np.array([1 - s, 2 * s, 2 - s]), np.array(pieces, dtype=float))
    return Trajectory(motion.knots, motion.coefficients, np.array([0.0, 1.0, 3.0 - 0.0 * s]))


def test_a_straight_path_may_be_left_near_corners_only():
    limits = JointLimits([10.0, 10.0], [100.0, 100.0])

    def straight(radius):
        return Problem("corner", CORNER, limits, EndCondition.FREE, path=StraightPath(radius))

    assert judged(straight(0.0), STOPPING).feasible
    assert judged(straight(0.25), blended(0.25)).feasible
    early = judged(straight(0.2), blended(0.25)).reasons
    assert early[0].startswith("leaves the straight line from waypoint 1 to 2")
    assert judged(straight(0.0), blended(0.25)).reasons[0].startswith("misses a waypoint")


def test_a_straight_path_of_a_curve_in_u_is_measured_too():
    still = np.zeros((2, 4, 2))
    still[0, :, 0], still[1, 0, 0], still[1, :, 1] = [0, 1, 0, 0], 1, [0, 2, 0, 0]
    time = np.array([[0.0, 0.5, 0.5, 0.0], [1.0, 1.5, 0.0, 0.5]])
    motion = ParametricTrajectory(time, still)
    straight = Problem("corner", CORNER, JointLimits([10.0, 10.0]), path=StraightPath())
    assert judged(straight, motion).feasible
    still[0, 2:, 1] = [0.01, -0.01]
    assert "leaves the straight line" in judged(straight, ParametricTrajectory(time, still)).reasons[0]


@pytest.mark.parametrize(
    ("timing", "passes"),
    [({"exactly": 3.0}, True), ({"exactly": 3.001}, False), ({"at_least": 3.0}, True), ({"at_least": 3.1}, False),
     ({"cycle": 0.001}, True), ({"cycle": 0.0011}, False), ({"cycle": 4.0}, False)],
)  # fmt: skip
def test_a_duration_may_be_demanded(timing, passes):
    wanted = corner(timing=Timing(**timing))
    assert judged(wanted, STOPPING).feasible is passes
    slower = STOPPING.scaled(wanted.timing.stretch(STOPPING.duration))
    assert judged(wanted, slower).feasible
    assert Demand.DURATION in wanted.demands or Demand.CYCLE in wanted.demands


def test_a_motion_that_lasts_too_long_cannot_be_stretched_to_its_time():
    with pytest.raises(StudyError, match="takes 3 s, longer than the 2 s it must take"):
        Timing(exactly=2.0).stretch(3.0)
    with pytest.raises(StudyError, match="contradicts"):
        Timing(exactly=2.0, at_least=2.1)


@pytest.mark.parametrize("duration", [5e-324, 1e-3, 1e300, 1.7e308])
@pytest.mark.parametrize("cycle", [5e-324, 1e-300, 0.004, 1e308])
def test_cycles_of_any_size_are_counted(cycle, duration):
    timing = Timing(exactly=1e308, cycle=cycle) if cycle < 1 else Timing(cycle=cycle)
    assert timing.excess(duration) >= 0
    assert Timing(cycle=cycle).stretch(duration) >= 1


def test_a_share_of_the_speed_takes_its_inverse_in_time():
    half = corner(segment_limits={0: JointLimits([4.0, 4.0])}).at_speed(0.5)
    assert half.limits.rates[:2, 0].tolist() == [5, 25]
    assert half.segment_limits[0].velocity.tolist() == [2, 2]
    assert half.duration_bounds[1] == 2 * corner().duration_bounds[1]


@pytest.mark.parametrize("name", ["cubic-spline", "bspline"])
def test_a_part_of_a_motion_moves_as_the_whole(name):
    rng = np.random.default_rng(4)
    motion = CURVES[name].motion(rng.normal(size=(6, 2)), rng.uniform(0.8, 1.2, size=5))
    for start, stop in [(0.3, 0.4), (0.3, 3.1), (0.0, motion.knots[2]), (motion.knots[1], 3.3)]:
        part, t = motion.between(start, stop), np.linspace(0.0, stop - start, 30)
        assert part.duration == pytest.approx(stop - start)
        for order in range(3):
            assert part(t[1:-1], order) == pytest.approx(motion(start + t[1:-1], order), rel=1e-7, abs=1e-7)
    with pytest.raises(StudyError, match="cannot run from 2 to 1 s"):
        motion.between(2.0, 1.0)


@pytest.mark.parametrize("name", ["cubic-spline", "bspline"])
def test_crossings_hold_every_passage_of_a_level(name):
    rng = np.random.default_rng(5)
    motion = CURVES[name].motion(rng.normal(size=(7, 1)), rng.uniform(0.8, 1.2, size=6))
    t = np.linspace(0, motion.duration, 4000)
    level = np.array([0.1])
    sign = motion(t)[:, 0] > level[0]
    crossings = motion.crossings(level)
    for k in np.flatnonzero(sign[1:] != sign[:-1]):
        assert ((crossings >= t[k] - 1e-9) & (crossings <= t[k + 1] + 1e-9)).any()
