"""The door: what a problem accepts and the sentence with which it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem, StudyError
from study.problem import State, StraightPath, Timing, Tube

HUGE = 10**5000
"""A whole number that Python does not write out."""

POINTS = [[0.0, 0.0], [1.0, 2.0], [2.0, 1.0]]


def limits(**changes):
    return JointLimits(**({"velocity": [1.0, 2.0], "acceleration": [3.0, 4.0]} | changes))


def test_a_missing_limit_is_infinite():
    found = limits()
    assert found.rates.tolist() == [[1, 2], [3, 4], [np.inf, np.inf]]
    assert found.lower.tolist() == [-np.inf, -np.inf]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"velocity": [1.0, 5e-324]}, "velocity limit of joint 2 must be between 1e-60 and 1e.60, got 4.94066e-324"),
        ({"velocity": [1.0, 0.0]}, "velocity limit of joint 2 must be positive, got 0"),
        ({"acceleration": [-3.0, 1.0]}, "acceleration limit of joint 1 must be positive, got -3"),
        ({"jerk": [1.0]}, "jerk limits must have one number for each of 2 joints, got 1"),
        ({"jerk": [1.0, np.nan]}, "not a number"),
        ({"velocity": 3.0}, "velocity limits must be a list"),
        ({"velocity": ["fast", "slow"]}, "must be a rectangular table of numbers"),
        ({"lower": [0.0, 0.0], "upper": [1.0, 0.0]}, "position limits of joint 2 are empty"),
    ],
)
def test_bad_limits_are_refused_with_one_sentence(changes, sentence):
    with pytest.raises(StudyError, match=sentence):
        limits(**changes)


@pytest.mark.parametrize(
    ("points", "sentence"),
    [
        ([[0, 0], [1, np.nan]], "not a number .NaN. at position 2, 2"),
        ([[0, 0], [1, np.inf]], "waypoint 2 is infinite or too large"),
        ([[0, 0], [1, 1], [1, 1]], "waypoints 2 and 3 are equal"),
        ([[0, 0]], "n_waypoints >= 2"),
        ([[0, 0, 0], [1, 1, 1]], r"must have shape \(n_waypoints >= 2, 2\) to match the limits, got \(2, 3\)"),
        ([[0, 0], [1]], "rectangular table"),
    ],
)
def test_bad_waypoints_are_refused_with_the_case_named(points, sentence):
    with pytest.raises(StudyError, match=sentence) as refused:
        Problem("my arm", points, limits())
    assert "case 'my arm'" in str(refused.value)


def test_a_problem_without_any_limit_has_no_shortest_time():
    with pytest.raises(StudyError, match="no joint has a finite limit"):
        Problem("p", POINTS, JointLimits([np.inf, np.inf]))


def test_bad_duration_bounds_and_names_and_ranges():
    with pytest.raises(StudyError, match="duration bounds"):
        Problem("p", POINTS, limits(), duration_bounds=(2.0, 1.0))
    with pytest.raises(StudyError, match="3 joint names for 2 joints"):
        Problem("p", POINTS, limits(), joint_names=("a", "b", "c"))
    with pytest.raises(StudyError, match="waypoint 2 puts joint 2 at 2, outside its range"):
        Problem("p", POINTS, limits(upper=[5.0, 1.5]))


def test_arrays_are_copies_that_cannot_be_written():
    points = np.array(POINTS)
    problem = Problem("p", points, limits())
    points[0, 0] = 7
    assert problem.waypoints[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        problem.waypoints[0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        problem.limits.velocity[0] = 1


def test_one_joint_alone_may_dwell():
    problem = Problem("p", [[0, 0], [0, 1], [1, 2]], limits(), end=EndCondition.SMOOTH, joint_names=("a", "b"))
    alone = problem.joint(0)
    assert alone.waypoints.tolist() == [[0], [0], [1]]
    assert alone.limits.acceleration.tolist() == [3]
    assert alone.joint_names == ("a",)
    assert alone.end is EndCondition.SMOOTH
    assert (alone.n_joints, alone.n_waypoints, alone.n_segments) == (1, 3, 2)


def test_scaled_limits():
    found = limits(jerk=[8.0, 16.0]).scaled(2.0)
    assert found.rates.tolist() == [[0.5, 1], [0.75, 1], [1, 2]]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"limits": None}, "limits must be a JointLimits, got NoneType"),
        ({"limits": {"velocity": [1, 1]}}, "limits must be a JointLimits, got dict"),
        ({"end": "rest"}, "end must be a EndCondition, got str 'rest'"),
        ({"duration_bounds": "ab"}, "duration bounds must be a rectangular table of numbers"),
        ({"duration_bounds": (1, 2, 3)}, r"duration bounds must satisfy 0 <= lower < upper, got \(1, 2, 3\)"),
        ({"duration_bounds": (0.0, np.nan)}, "duration bounds holds a value that is not a number"),
        ({"joint_names": "ab"}, "2 joint names for 2 joints; give a list"),
        ({"waypoints": np.ma.masked_less(POINTS, 0.5)}, "waypoints holds a masked entry"),
        ({"waypoints": None}, "waypoints"),
        ({"stops": 1}, "stops must be a Sequence or ndarray, got int"),
        ({"joint_names": None}, "joint_names must be a Sequence"),
        ({"waypoints": [[0, 0], [1e200, 1]]}, "waypoint 2 is infinite or too large; give numbers up to 1e\\+60"),
        ({"start": "rest"}, "start must be a State or EndCondition"),
        ({"start": State([1.0])}, "end velocity must have one number for each of 2 joints, got 1"),
        ({"finish": State([1.5, 0.0])}, "end velocity of joint 1, 1.5, is beyond its limit"),
        ({"stops": [2]}, "stop 2 is none of the places allowed, which are from 1 to 1"),
        ({"stops": [True]}, "stop True is none"),
        ({"dwells": [1]}, "dwells must be a Mapping"),
        ({"dwells": {1: -1.0}}, "dwell at waypoint 1 must be a positive number, got -1.0"),
        ({"segment_limits": {2: None}}, "segment limit 2 is none of the places allowed, which are from 0 to 1"),
        ({"segment_limits": {0: None}}, "limits of segment 0 must be JointLimits of 2 joints"),
        ({"segment_limits": {0: JointLimits([1, 1], upper=[0.5, 9])}}, "segment 0 ends outside its own range"),
        ({"tolerance": [0.1]}, "tolerance must be one number, one for each of 3 waypoints, or a table"),
        ({"tolerance": -0.1}, "tolerance must hold finite numbers that are not negative"),
        ({"path": "straight"}, "path must be a StraightPath or Tube, got str"),
        ({"path": Tube([0.1, 0.1, 0.1])}, "radius of a Tube must have one number for each of 2 joints, got 3"),
        ({"timing": 3.0}, "timing must be a Timing, got float"),
        ({"name": 3}, "the name of a problem must be a str, got int 3"),
        ({"joint_names": ["a", 2]}, "a joint's name must be a str, got int 2"),
        *(
            (change, "thousands of digits|too large to convert")
            for change in (
                *({name: HUGE} for name in ("name", "limits", "start", "path", "timing", "tolerance")),
                {"stops": [HUGE]},
                {"dwells": {HUGE: 1.0}},
                {"dwells": {1: HUGE}},
                {"segment_limits": {HUGE: None}},
                {"waypoints": [[0, 0], [HUGE, 1]]},
                {"duration_bounds": (0, HUGE)},
            )
        ),
    ],
)
def test_a_part_of_another_kind_is_refused_with_one_sentence(changes, sentence):
    with pytest.raises(StudyError, match=sentence) as refused:
        Problem(**({"name": "p", "waypoints": POINTS, "limits": limits()} | changes))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Tube(), "the radius of a Tube must be positive"),
        (lambda: Tube(-1.0), "not negative"),
        (lambda: StraightPath(np.inf), "not negative"),
        (lambda: Timing(cycle=0), "timing: cycle must be a positive number, got 0"),
        (lambda: Timing(exactly="soon"), "timing: exactly must be a positive number, got 'soon'"),
        (lambda: State([np.inf]), "velocity must be a list with one finite number per joint"),
        (lambda: State(1.0), "velocity must be a list with one finite number per joint"),
        (lambda: JointLimits(None), "velocity limits must be a list with one number per joint"),
        (lambda: limits(min_velocity=[0.0, -1.0]), "min_velocity limit of joint 1 must be negative, got 0"),
    ],
)
def test_a_rule_that_cannot_be_is_refused(make, sentence):
    with pytest.raises(StudyError, match=sentence):
        make()


def test_none_is_no_limit():
    found = limits(acceleration=None, jerk=None, lower=None, upper=None)
    assert not np.isfinite(found.rates[1:]).any()
    assert np.isinf(found.upper).all()


def test_one_direction_may_have_another_limit():
    found = limits(min_velocity=[-0.5, -3.0])
    assert found.lowest_rates[0].tolist() == [-0.5, -3.0]
    assert found.rates[0].tolist() == [0.5, 2.0]
    assert not found.symmetric
    assert found.scaled(2.0).min_velocity.tolist() == [-0.25, -1.5]
    assert found.joint(1).min_velocity.tolist() == [-3.0]


def test_a_joint_that_moves_less_than_the_floor_is_still():
    noisy = np.column_stack(
        [[0.0, 1.0, 2.0], 0.7 + 1e-16 * np.arange(3), [0.0, 1e-6, 0.0], 1e4 + 0.9e-9 * np.arange(3)]
    )
    problem = Problem("p", noisy, JointLimits(np.ones(4)))
    assert problem.moving.tolist() == [True, False, True, False]
    assert problem.position_tolerance[:3] == pytest.approx([2e-6, 1e-9, 1e-9], rel=1e-3)


def test_a_problem_of_one_joint_keeps_the_demands_on_it():
    whole = Problem(
        "p", POINTS, limits(), start=State([0.1, 0.2]), finish=EndCondition.FREE, stops=[1], tolerance=[0, 0.1, 0],
        path=Tube([0.3, 0.4]), segment_limits={1: limits(velocity=[0.5, 0.6])},
    )  # fmt: skip
    alone = whole.joint(1)
    assert alone.start.velocity.tolist() == [0.2]
    assert alone.finish is EndCondition.FREE
    assert alone.path.of(1).tolist() == [0.4]
    assert alone.tolerance.tolist() == [[0], [0.1], [0]]
    assert alone.segment_limits[1].velocity.tolist() == [0.6]
    assert alone.demands == whole.demands


def test_a_jerk_limit_asks_for_smooth_ends_unless_told_otherwise():
    jerky = limits(jerk=[8.0, np.inf])
    assert Problem("p", POINTS, jerky).end is EndCondition.SMOOTH
    assert Problem("p", POINTS, jerky, EndCondition.REST).end is EndCondition.REST
    assert Problem("p", POINTS, limits()).end is EndCondition.REST


def test_another_number_of_waypoints_keeps_the_other_demands():
    longer = replace(Problem("p", POINTS, limits(), path=Tube(0.1)), waypoints=[*POINTS, [0.0, 0.0]])
    assert longer.tolerances.shape == (4, 2)
    assert longer.path.of(2).tolist() == [0.1, 0.1]


LINE = [[0.0], [1.0], [2.0]]
ONE = JointLimits([1.0])


@pytest.mark.parametrize(
    "build",
    [lambda: JointLimits([True]), lambda: JointLimits([1.0], min_jerk=[False]), lambda: JointLimits([1.0], lower=np.array([False])),
     lambda: Problem("p", [[0.0], [True]], ONE), lambda: Problem("p", np.array([[True], [False]]), ONE),
     lambda: Problem("p", LINE, ONE, tolerance=[0, True, 0]), lambda: Problem("p", LINE, ONE, duration_bounds=(False, 1.0)),
     lambda: Problem("p", LINE, ONE, dwells={1: True}), lambda: Problem("p", LINE, ONE, dwells={True: 1.0}),
     lambda: Problem("p", LINE, ONE, stops=[True]), lambda: Problem("p", LINE, ONE, segment_limits={True: ONE}),
     lambda: Problem("p", LINE, ONE).at_speed(True), lambda: ONE.scaled(True), lambda: State([True]), lambda: Tube(True),
     lambda: StraightPath([True]), lambda: Timing(exactly=True), lambda: Timing(cycle=np.True_), lambda: JointLimits(np.array([True], dtype=object))],
)  # fmt: skip
def test_true_and_false_are_no_numbers(build):
    with pytest.raises(StudyError) as refused:
        build()
    assert "\n" not in str(refused.value)
