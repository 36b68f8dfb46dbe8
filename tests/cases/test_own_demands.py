"""Demands in a case file of one's own: each comes to the part of a problem that it names, in rad and m."""

from copy import deepcopy

import jsonschema
import numpy as np
import pytest
import yaml

from study import EndCondition, StudyError
from study.cases.library import load_case
from study.cases.own_file import OwnCase, schema
from study.datafiles import checked
from study.problem import Demand, StraightPath, Tube

PLAIN = """
units: [deg, mm]
waypoints: [[0, 0], [90, 500], [45, 100], [0, 200]]
limits: {velocity: [90, 500], acceleration: [180, 900]}
"""


@pytest.fixture
def load(tmp_path):
    def read(more):
        path = tmp_path / "mine.yaml"
        path.write_text(PLAIN + more)
        assert jsonschema.Draft202012Validator(schema()).is_valid(yaml.safe_load(PLAIN + more))
        return load_case(path).problem

    return read


def test_limits_by_direction(tmp_path, load):
    path = tmp_path / "asymmetric.yaml"
    path.write_text(PLAIN.replace("[180, 900]", "{lower: [-90, null], upper: 180}"))
    limits = load_case(path).problem.limits
    assert limits.acceleration == pytest.approx([np.pi, 0.18])
    assert limits.min_acceleration == pytest.approx([-np.pi / 2, -np.inf])
    assert limits.lowest_rates[0] == pytest.approx(-limits.velocity)


def test_ends(load):
    moving = load("start: {velocity: [45, -100]}\nfinish: free\n")
    assert moving.start.velocity == pytest.approx([np.pi / 4, -0.1])
    assert moving.start.acceleration is None
    assert moving.finish is EndCondition.FREE
    assert load("start: rest\nfinish: rest\n").end is EndCondition.REST


def test_stops_and_dwells(load):
    problem = load("stops: [2]\ndwells: {3: 0.5}\n")
    assert (problem.stops, problem.dwells) == ((1,), {2: 0.5})


def test_limits_of_segments_meet_where_they_overlap(load):
    problem = load(
        """
segments:
  - {from: 1, to: 3, velocity: 45}
  - {from: 2, to: 4, velocity: [30, null], jerk: {lower: -100, upper: 200}, position: {lower: -10, upper: 600}}
"""
    )
    first, second, third = (problem.segment_limits[k] for k in range(3))
    assert first.velocity == pytest.approx([np.pi / 4, 0.045])
    assert second.velocity == pytest.approx([np.pi / 6, 0.045])
    assert third.velocity == pytest.approx([np.pi / 6, np.inf])
    assert third.min_jerk == pytest.approx(np.array([-100, -100]) * [np.pi / 180, 1e-3])
    assert third.upper == pytest.approx([600 * np.pi / 180, 0.6])


@pytest.mark.parametrize(
    ("text", "tolerance"),
    [
        ("18", [[np.pi / 10, 0.018]] * 4),
        ("[0, 18, 0, 0]", [[0, 0], [np.pi / 10, 0.018], [0, 0], [0, 0]]),
        ("[0, [18, 5], 0, 0]", [[0, 0], [np.pi / 10, 0.005], [0, 0], [0, 0]]),
    ],
)
def test_tolerance(load, text, tolerance):
    assert load(f"tolerance: {text}\n").tolerance == pytest.approx(np.array(tolerance))


def test_paths(load):
    assert load("path: free\n").path is None
    assert load("path: straight\n").path.of(2).tolist() == [0, 0]
    blended, tube = load("path: {straight: 9}\n").path, load("path: {tube: [9, 10]}\n").path
    assert isinstance(blended, StraightPath)
    assert blended.of(2) == pytest.approx([np.pi / 20, 0.009])
    assert isinstance(tube, Tube)
    assert tube.of(2) == pytest.approx([np.pi / 20, 0.01])


def test_durations_cycles_and_speed(load):
    assert load("duration: 9\n").timing.exactly == 9
    timing = load("duration: {at_least: 8}\ncycle: 0.004\n").timing
    assert (timing.exactly, timing.at_least, timing.cycle) == (None, 8, 0.004)
    half = load("speed: 0.5\n")
    assert half.limits.rates[:2] == pytest.approx(load("").limits.rates[:2] / [[2], [4]])
    assert Demand.CYCLE in load("cycle: 0.004\n").demands


WRONG = {
    "stops: [1]": "stop 0 is none of the places allowed",
    "stops: 2": "field 'stops'",
    "dwells: {2: -1}": "field 'dwells",
    "segments: [{from: 3, to: 3, velocity: 1}]": "must run from a waypoint to a later one of the 4, got 3 to 3",
    "segments: [{from: 1, to: 2, speed: 1}]": "unknown key",
    "segments: [{from: 1, to: 2, velocity: [1, 2, 3]}]": "3 velocity limits for 2 joints",
    "tolerance: [1, 2]": "tolerance must be one number, one for each of 4 waypoints",
    "tolerance: [1, 2, 3, [1, 2, 3]]": "tolerance of waypoint 4 must have one number for each of 2 joints, got 3",
    "tolerance: -1": "field 'tolerance'",
    "path: round": "field 'path'",
    "path: {}": "give exactly one of 'straight' and 'tube'",
    "path: {tube: 0}": "the radius of a Tube must be positive",
    "duration: {exactly: 3, at_least: 4}": "contradicts",
    "duration: soon": "field 'duration'",
    "speed: 2": "field 'speed'",
    "start: {velocity: [1]}": "end velocity must have one number for each of 2 joints, got 1",
    "start: {velocity: [900, 0]}": "end velocity of joint 1, 900 deg/s, is beyond its limits -90 deg/s and 90 deg/s",
    "finish: moving": "field 'finish': input should be 'free', 'rest' or 'smooth'",
}


@pytest.mark.parametrize(("more", "sentence"), WRONG.items(), ids=WRONG)
def test_an_impossible_demand_is_one_sentence(tmp_path, more, sentence):
    path = tmp_path / "mine.yaml"
    path.write_text(PLAIN + more + "\n")
    with pytest.raises(StudyError) as error:
        load_case(path)
    assert sentence in str(error.value)
    assert "mine" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_of_another_version_is_refused_in_one_sentence(tmp_path):
    path = tmp_path / "later.yaml"
    path.write_text("version: 2\n" + PLAIN)
    with pytest.raises(StudyError, match="field 'version': this program reads case files of version 1"):
        load_case(path)
    path.write_text("version: 1\n" + PLAIN)
    assert load_case(path).problem.n_waypoints >= 2


EVERYTHING = {
    "version": 1, "units": "rad", "waypoints": [[0, 0], [1, 1], [2, 2.5]], "tolerance": [0.1, [0.1, 0.2], 0], "path": {"tube": 0.1},
    "limits": {"velocity": 1.0, "acceleration": [2, 3], "jerk": {"lower": -5.0, "upper": [5, 6]}, "position": {"lower": -5, "upper": [5, 5]},
               "torque": [9, 8], "tool_speed": 1.5, "tool_acceleration": 3},
    "tool": {"at": [0, 0, 1.5]}, "payload": {"mass": 2, "at": [0, 0, 0.5]}, "gravity": [0, 0, -9.81], "friction": {"viscous": 1.5, "coulomb": [1, 2]},
    "segments": [{"from": 1, "to": 2, "velocity": {"lower": -1, "upper": 1}}], "start": {"velocity": [0, 1]}, "finish": "rest",
    "stops": [2], "dwells": {2: 0.5}, "duration": {"exactly": 3}, "cycle": 0.1, "speed": 0.5, "arm_radius": 0.1,
    "obstacles": [{"lower": [0, 0, 0], "upper": [1, 1, 1]}], "duration_bounds": {"lower": 0.1, "upper": 5},
}  # fmt: skip


def numbers(part, place=()):
    """Places of all numbers in nested lists and mappings."""
    if isinstance(part, dict | list):
        for key, inner in part.items() if isinstance(part, dict) else enumerate(part):
            yield from numbers(inner, (*place, key))
    elif isinstance(part, int | float):
        yield place


@pytest.mark.parametrize("place", list(numbers(EVERYTHING)), ids=str)
def test_true_is_no_number_wherever_a_case_has_one(place):
    content = deepcopy(EVERYTHING)
    part = content
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = True
    with pytest.raises(StudyError, match=r"must be a number|input should be"):
        checked(OwnCase, content, "file 'x.yaml'")


def test_the_case_with_every_kind_of_number_is_accepted():
    assert checked(OwnCase, EVERYTHING, "file 'x.yaml'").speed == 0.5
