"""The door: what a problem accepts and the sentence with which it refuses."""

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem, StudyError

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
        ([[0, 0], [1, np.inf]], "waypoint 2 holds an infinite value"),
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
