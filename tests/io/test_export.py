import csv
import json

import numpy as np
import pytest
import yaml

from study import EndCondition, JointLimits, Problem, StudyError, judge
from study.curves import curve_named
from study.io.exact import read_exact
from study.io.export import write_motion
from study.io.recordings import read_samples
from study.io.sampled import joined
from study.io.sampling import Sampling, sample_times, usual_rate

NAMES = ('elbow "left", 1', "<wrist>")


@pytest.fixture
def problem():
    waypoints = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])
    limits = JointLimits(np.array([1.0, 0.8]), np.array([2.0, 1.5]), np.array([20.0, 15.0]))
    return Problem("named", waypoints, limits, EndCondition.FREE, joint_names=NAMES)


@pytest.fixture(params=["cubic-spline", "poly353", "bspline"])
def motion(request, problem):
    return curve_named(request.param).motion(problem.waypoints, np.array([0.7, 1 / 3, np.pi / 3]) * 3)


def test_exact_json_gives_the_motion_back_to_the_last_bit(tmp_path, problem, motion):
    back = read_exact(write_motion(motion, problem, tmp_path / "m.exact.json"))
    assert type(back) is type(motion)
    times = np.linspace(0, motion.duration, 101)
    for order in range(4):
        assert back(times, order).tobytes() == motion(times, order).tobytes()
    assert back.waypoint_times.tobytes() == motion.waypoint_times.tobytes()
    assert judge(problem, back).duration == judge(problem, motion).duration


def test_exact_json_keeps_the_oddest_floats(tmp_path, problem):
    rng = np.random.default_rng(0)
    odd = np.array([5e-324, -0.0, 1e308, np.nextafter(1.0, 2.0), 1 / 3])
    curve = curve_named("cubic-spline").motion(problem.waypoints, np.ones(3))
    coefficients = rng.choice(odd, curve.coefficients.shape)
    weird = type(curve)(curve.knots, coefficients, curve.waypoint_times)
    back = read_exact(write_motion(weird, problem, tmp_path / "m.exact.json"))
    assert back.coefficients.tobytes() == weird.coefficients.tobytes()


def test_csv_has_the_end_point_and_every_digit(tmp_path, problem, motion):
    path = write_motion(motion, problem, tmp_path / "m.csv", Sampling(30))
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header[1:3] == list(NAMES)
    table = np.array(rows, dtype=float)
    assert table[0, 0] == 0
    assert table[-1, 0] == motion.duration
    assert np.diff(table[:, 0])[:-1] == pytest.approx(1 / 30)
    assert 0 < np.diff(table[:, 0])[-1] <= 1 / 30 * (1 + 1e-9)
    for order in range(3):
        exact = motion(table[:, 0], order)
        np.testing.assert_allclose(table[:, 1 + 2 * order : 3 + 2 * order], exact, rtol=0, atol=1e-15)


def test_csv_is_what_study_check_reads(tmp_path, problem):
    motion = curve_named("poly353").motion(problem.waypoints, np.full(3, 2.0))
    path = write_motion(motion, problem, tmp_path / "m.csv", Sampling(500))
    verdict = judge(problem, joined(read_samples(path), problem, "the file").trajectory)
    assert verdict.duration == pytest.approx(6.0)
    assert verdict.ratios == pytest.approx(judge(problem, motion).ratios, rel=1e-2)


@pytest.mark.parametrize("ending", ["yaml", "json"])
def test_the_message_is_read_back(tmp_path, problem, motion, ending):
    path = write_motion(motion, problem, tmp_path / f"m.{ending}", Sampling(20))
    content = (json.loads if ending == "json" else yaml.safe_load)(path.read_text())
    assert content["joint_names"] == list(NAMES)
    times = np.array([p["time_from_start"]["sec"] + p["time_from_start"]["nanosec"] / 1e9 for p in content["points"]])
    assert times[-1] == pytest.approx(motion.duration, abs=1e-9)
    assert all(isinstance(p["time_from_start"]["nanosec"], int) for p in content["points"])
    for order, key in enumerate(("positions", "velocities", "accelerations")):
        given = np.array([p[key] for p in content["points"]], dtype=float)
        np.testing.assert_allclose(given, motion(times, order), rtol=0, atol=1e-15)
        assert all(isinstance(value, float) for p in content["points"] for value in p[key])
    assert read_samples(path).names == NAMES


def test_a_time_just_below_a_second_does_not_overflow_its_nanoseconds(tmp_path, problem):
    motion = curve_named("cubic-spline").motion(problem.waypoints, np.full(3, 1 - 1e-11))
    points = json.loads(write_motion(motion, problem, tmp_path / "m.json", Sampling(1)).read_text())["points"]
    assert all(0 <= p["time_from_start"]["nanosec"] < 10**9 for p in points)


def test_npz_holds_samples_and_what_makes_the_motion(tmp_path, problem, motion):
    with np.load(write_motion(motion, problem, tmp_path / "m.npz"), allow_pickle=False) as arrays:
        assert (arrays["jerk"] == motion(arrays["time"], 3)).all()
        assert arrays["joint_names"].tolist() == list(NAMES)
        assert (arrays["waypoint_times"] == motion.waypoint_times).all()
        exact = {"coefficients"} if hasattr(motion, "coefficients") else {"time_coefficients", "position_coefficients"}
        assert exact <= set(arrays)


@pytest.mark.parametrize(
    ("duration", "rate"), [(1.0, 10.0), (0.3, 10.0), (1e-6, 100.0), (7200.0, 100.0), (0.7, 1e3 / 3)]
)
def test_samples_increase_and_end_with_the_end_point(duration, rate):
    times = sample_times(duration, rate)
    assert times[0] == 0
    assert times[-1] == duration
    assert (np.diff(times) > 0).all()
    assert np.diff(times).max() <= (1 + 1e-9) / rate


@pytest.mark.parametrize(
    ("duration", "rate"),
    [(2.9, 100), (1000, 100), (1001, 10), (4e4, 1), (3e9, 1e-5), (0.05, 1e3), (4e-6, 1e7), (1e-12, 1e9)],
)
def test_without_a_wish_there_are_neither_two_samples_nor_a_million(duration, rate):
    assert usual_rate(duration) == pytest.approx(rate)


@pytest.mark.parametrize(
    ("name", "rate", "sentence"),
    [
        ("m.mat", 100, "must end in one of .csv, .yaml"),
        ("m.csv", 0, "samples per second, must be a positive number, got 0"),
        ("m.csv", np.nan, "must be a positive number, got nan"),
        ("m.csv", 1e12, "lower the rate"),
    ],
)
def test_impossible_wishes_are_one_sentence(tmp_path, problem, motion, name, rate, sentence):
    with pytest.raises(StudyError, match=sentence):
        write_motion(motion, problem, tmp_path / name, Sampling(rate))


def test_a_place_that_cannot_be_written_is_one_sentence(tmp_path, problem, motion):
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="cannot write"):
        write_motion(motion, problem, tmp_path / "file" / "m.csv")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("{", "not valid JSON at line 1"),
        ("[]", "not an exact trajectory"),
        ('{"format": "time-optimal-study trajectory 1", "kind": "polynomial"}', "field 'knots' is missing"),
        (
            '{"format": "time-optimal-study trajectory 1", "kind": "polynomial", "knots": [0, 1], "coefficients": [], "waypoint_times": []}',
            "coefficients must have shape",
        ),
        (
            '{"format": "time-optimal-study trajectory 1", "kind": "polynomial", "knots": ["x"], "coefficients": [], "waypoint_times": []}',
            "could not convert",
        ),
    ],
)
def test_a_broken_exact_file_is_one_sentence(tmp_path, text, sentence):
    path = tmp_path / "m.exact.json"
    path.write_text(text)
    with pytest.raises(StudyError, match=sentence):
        read_exact(path)
