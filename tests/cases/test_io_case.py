"""A case file of one's own: what it may leave out, where its numbers come from, and what is wrong with it."""

import json

import jsonschema
import numpy as np
import pytest
import yaml

from study import EndCondition, StudyError
from study.cases.library import load_case
from study.cases.obstacles import nearest
from study.cases.own_file import schema
from study.cli.example import EXAMPLE
from study.datafiles import data_folder
from tests.helpers.robot_files import MOVEIT, URDF

PLAIN = {
    "units": "deg",
    "waypoints": [[0, 90], [180, 0], [90, -90]],
    "limits": {"velocity": 90, "acceleration": [180, 360]},
}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "bench.urdf").write_text(URDF)
    (tmp_path / "limits.yaml").write_text(MOVEIT)
    (tmp_path / "points.csv").write_text("slide,turn\n0.1,0.5\n0.2,1.0\n0.05,0.7\n")
    return tmp_path


def load(folder, content, name="mine.yaml"):
    path = folder / name
    path.write_text(json.dumps(content) if name.endswith("json") else yaml.safe_dump(content))
    return load_case(path)


@pytest.mark.parametrize("name", ["mine.yaml", "mine.json"])
def test_the_least_that_a_case_needs(tmp_path, name):
    case = load(tmp_path, PLAIN, name)
    assert case.name == "mine"
    np.testing.assert_allclose(case.problem.waypoints, np.pi / 2 * np.array([[0, 1], [2, 0], [1, -1]]))
    np.testing.assert_allclose(case.problem.limits.velocity, np.pi / 2)
    np.testing.assert_allclose(case.problem.limits.acceleration, [np.pi, 2 * np.pi])
    assert np.isinf(case.problem.limits.jerk).all()
    assert case.problem.end is EndCondition.REST
    assert case.curve == "cubic-spline"
    assert case.problem.duration_bounds[0] == pytest.approx(1.0)


def test_a_jerk_limit_asks_for_smooth_ends_unless_told_otherwise(tmp_path):
    limits = PLAIN["limits"] | {"jerk": 1000}
    assert load(tmp_path, PLAIN | {"limits": limits}).problem.end is EndCondition.SMOOTH
    assert load(tmp_path, PLAIN | {"limits": limits, "end": "rest"}).problem.end is EndCondition.REST


def test_mixed_joints_uneven_ranges_and_joints_without_a_limit(tmp_path):
    case = load(
        tmp_path,
        {
            "units": ["mm", "deg"],
            "joints": ['<b>"rail"</b>', "wrist 'a'"],
            "waypoints": [[0, 0], [500, 45]],
            "limits": {
                "velocity": [200, None],
                "acceleration": [None, 90],
                "position": {"lower": [-1, None], "upper": 900},
            },
        },
    )
    limits = case.problem.limits
    assert case.units == ("m", "rad")
    assert case.problem.joint_names == ('<b>"rail"</b>', "wrist 'a'")
    np.testing.assert_allclose(limits.velocity, [0.2, np.inf])
    np.testing.assert_allclose(limits.acceleration, [np.inf, np.pi / 2])
    np.testing.assert_allclose(limits.lower, [-1e-3, -np.inf])
    np.testing.assert_allclose(limits.upper, [0.9, np.radians(900)])


def test_waypoints_and_limits_from_files_are_put_in_the_joints_order(folder):
    case = load(
        folder,
        {
            "units": ["rad", "m"],
            "joints": ["turn", "slide"],
            "waypoints": "points.csv",
            "limits": {"from": "bench.urdf"},
        },
    )
    np.testing.assert_array_equal(case.problem.waypoints[:, 0], [0.5, 1.0, 0.7])
    np.testing.assert_array_equal(case.problem.limits.velocity, [3.14, 0.25])
    np.testing.assert_array_equal(case.problem.limits.lower, [-1.5, 0.0])
    assert case.sources == {"waypoints": "points.csv", "limits": "bench.urdf"}


def test_later_files_and_own_numbers_win(folder):
    (folder / "more.yaml").write_text(
        "joint_limits: {turn: {max_velocity: 2.0, max_acceleration: 5.0}, slide: {max_acceleration: 1}}"
    )
    content = {
        "units": ["rad", "mm"],
        "joints": ["turn", "slide"],
        "waypoints": [[0, 0], [1, 100]],
        "limits": {"from": ["bench.urdf", "more.yaml"], "velocity": [None, 150], "jerk": [30, None]},
    }
    limits = load(folder, content).problem.limits
    np.testing.assert_allclose(limits.velocity, [2.0, 0.15])
    np.testing.assert_allclose(limits.acceleration, [5.0, 1.0])
    np.testing.assert_allclose(limits.jerk, [30.0, np.inf])
    np.testing.assert_allclose(limits.upper, [2.5, 0.6])


def test_a_joint_trajectory_needs_no_units(folder):
    points = [{"positions": [0.0, 0.1, 0.0]}, {"positions": [1.0, 0.2, -1.0]}]
    (folder / "taught.json").write_text(json.dumps({"joint_names": ["turn", "slide", "spin"], "points": points}))
    case = load(folder, {"waypoints": "taught.json", "limits": {"from": "bench.urdf"}, "robot": "bench.urdf"})
    assert case.units == ("rad", "m", "rad")
    np.testing.assert_array_equal(case.problem.waypoints[1], [1.0, 0.2, -1.0])


@pytest.mark.parametrize("unit", ["rad", "deg"])
def test_a_unit_in_a_column_s_name_must_be_the_case_s(tmp_path, unit):
    (tmp_path / "points.csv").write_text("a [deg],b (deg)\n10,20\n30,40\n")
    content = {"units": unit, "waypoints": "points.csv", "limits": PLAIN["limits"]}
    if unit == "deg":
        assert load(tmp_path, content).problem.waypoints[0, 0] == pytest.approx(np.pi / 18)
        return
    with pytest.raises(StudyError, match=r"column 'a \[deg\]' is in deg, but 'units' says rad; make the two agree"):
        load(tmp_path, content)


def test_obstacles_and_the_arm_that_meets_them(folder):
    content = {
        "units": ["rad", "m"],
        "joints": ["turn", "slide"],
        "waypoints": [[0, 0], [1, 0.3]],
        "limits": {"velocity": 1},
        "robot": "bench.urdf",
        "arm_radius": 0.02,
    }
    from study import plan

    near = load(folder, content | {"obstacles": [{"lower": [-1, -1, 0.9], "upper": [1, 1, 1]}]})
    found = nearest(near, plan(near.problem).motion)
    assert found.distance == pytest.approx(
        0.9 - 0.5 - 0.02, abs=1e-9
    )  # the arm's highest point is its shoulder, at 0.5
    hit = load(folder, content | {"obstacles": [{"lower": [-0.05, 0.1, 0.4], "upper": [0.05, 0.15, 0.6]}]})
    assert "hits an obstacle" in nearest(hit, plan(hit.problem).motion).sentence
    assert nearest(load(folder, content), plan(near.problem).motion) is None


def without(key):
    return {name: value for name, value in PLAIN.items() if name != key}


WRONG = {
    "no units": (without("units"), "field 'units' is missing; state rad or deg"),
    "no limits": (without("limits"), "field 'limits' is missing; add it"),
    "no waypoints": (without("waypoints"), "field 'waypoints' is missing; add it"),
    "misspelt": (PLAIN | {"waypionts": 1}, "unknown key 'waypionts'; did you mean 'waypoints'?"),
    "odd unit": (
        PLAIN | {"units": "degrees"},
        "field 'units': input should be 'rad', 'deg', 'm' or 'mm', got 'degrees'",
    ),
    "units short": (PLAIN | {"units": ["deg"]}, "1 unit for 2 joints; give one for all or one for each"),
    "negative": (
        PLAIN | {"limits": {"velocity": -1}},
        "field 'limits.velocity': input should be greater than 0, got '-1'",
    ),
    "zero in list": (
        PLAIN | {"limits": {"velocity": [1, 0]}},
        "field 'limits.velocity', item 2: input should be greater than 0",
    ),
    "limits short": (PLAIN | {"limits": {"velocity": [1]}}, "1 velocity limit for 2 joints"),
    "nothing limited": (PLAIN | {"limits": {}}, "no joint has a finite limit, so there is no shortest time"),
    "ragged": (PLAIN | {"waypoints": [[1, 2], [3]]}, "waypoint 2 has 1 number, the first has 2"),
    "words": (
        PLAIN | {"waypoints": [[1, "two"], [3, 4]]},
        "field 'waypoints', item 2 of item 1: input should be a valid number",
    ),
    "one waypoint": (PLAIN | {"waypoints": [[1, 2]]}, "there is only one waypoint; a motion needs at least two"),
    "no waypoint": (PLAIN | {"waypoints": []}, "there are no waypoints; give at least two"),
    "repeated": (PLAIN | {"waypoints": [[1, 2], [1, 2]]}, "all waypoints are the same place"),
    "outside": (
        PLAIN | {"limits": {"velocity": 1, "position": {"lower": -10, "upper": 10}}},
        "outside its range",
    ),
    "empty range": (
        PLAIN | {"limits": {"velocity": 1, "position": {"lower": 10, "upper": -10}}},
        "position limits of joint 1 are empty",
    ),
    "names short": (PLAIN | {"joints": ["a"]}, "1 joint name for 2 columns of waypoints"),
    "names twice": (PLAIN | {"joints": ["a", "a"]}, "two joints have the same name: a, a"),
    "missing file": (PLAIN | {"waypoints": "nothing.csv"}, "does not exist; check the path"),
    "unnamed columns": (PLAIN | {"limits": {"from": "bench.urdf"}}, "list the columns' names under 'joints'"),
    "strange names": (
        PLAIN | {"joints": ["x", "y"], "limits": {"from": "bench.urdf"}},
        "no limits for joint 'x'; the files of limits know turn, slide, spin",
    ),
    "strange columns": (
        PLAIN | {"joints": ["x", "y"], "waypoints": "points.csv"},
        "columns are slide, turn; there is none for 'x'",
    ),
    "slide in degrees": (
        PLAIN | {"joints": ["turn", "slide"], "limits": {"from": "bench.urdf"}},
        "joint 'slide' slides, so its unit is m or mm, got deg",
    ),
    "odd robot": (PLAIN | {"robot": "ur6"}, "no robot 'ur6'; did you mean 'ur5'"),
    "robot too long": (PLAIN | {"robot": "ur5"}, "has 6 moving joints, the waypoints have 2"),
    "obstacles in thin air": (
        PLAIN | {"obstacles": [{"lower": [0, 0, 0], "upper": [1, 1, 1]}]},
        "obstacles need a robot",
    ),
    "odd end": (PLAIN | {"end": "stop"}, "field 'end': input should be 'free', 'rest' or 'smooth'"),
    "odd curve": (PLAIN | {"curve": "nurbs"}, "field 'curve': input should be"),
    "bounds crossed": (PLAIN | {"duration_bounds": {"lower": 2, "upper": 1}}, "0 <= lower < upper"),
}


@pytest.mark.parametrize(("content", "sentence"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_with_a_case_is_one_sentence(folder, content, sentence):
    with pytest.raises(StudyError) as error:
        load(folder, content)
    assert sentence in str(error.value)
    assert "mine" in str(error.value) or "nothing.csv" in str(error.value) or "ur6" in str(error.value)
    assert "\n" not in str(error.value)


def test_the_example_is_a_case_with_seven_joints_and_ten_waypoints(tmp_path):
    path = tmp_path / "my_case.yaml"
    path.write_text(EXAMPLE.replace("NAME", "my_case"))
    case = load_case(path)
    assert (case.problem.n_joints, case.problem.n_waypoints) == (7, 10)


def test_the_schema_takes_what_the_program_takes(folder):
    judge = jsonschema.Draft202012Validator(schema())
    judge.check_schema(schema())
    assert judge.is_valid(yaml.safe_load(EXAMPLE))
    assert judge.is_valid(PLAIN)
    refused = [
        "no limits",
        "no waypoints",
        "misspelt",
        "odd unit",
        "negative",
        "zero in list",
        "words",
        "odd end",
        "odd curve",
    ]
    for name in refused:
        assert not judge.is_valid(WRONG[name][0]), name


def test_the_papers_files_still_stand_on_their_own():
    for path in (data_folder() / "cases").glob("*.yaml"):
        assert load_case(path).paper != "own"
