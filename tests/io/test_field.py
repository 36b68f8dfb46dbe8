"""Recordings and robot files as other programs write them: the right values, and one note for everything not used."""

import json

import numpy as np
import pytest
import yaml

from study.cases.library import own_case
from study.errors import StudyError
from study.io.export import write_motion
from study.io.limits import read_limits
from study.io.recordings import read_samples
from study.io.sampling import Sampling
from study.io.urdf import read_urdf
from study.trajectory import Trajectory

ROWS = [[0.1, 0.5], [0.3, 0.2], [0.7, -0.4]]
LIMITS = {"velocity": 1.0, "acceleration": 2.0}


def put(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text if isinstance(text, str) else json.dumps(text))
    return path


def case_of(tmp_path, **content):
    return own_case({"units": "rad", "limits": LIMITS, **content}, tmp_path / "mine.yaml")


@pytest.mark.parametrize(
    "name", ["timestamp", "%time", "# time", "#time", "time_s", "t_s", "sec", "header.stamp.sec", "stamp"]
)
def test_recorders_names_of_the_time(tmp_path, name):
    scale = 10**9 if name == "%time" else 1
    lines = [f"{(k + 5) * scale},{a},{b}" for k, (a, b) in enumerate(ROWS)]
    samples = read_samples(put(tmp_path, "r.csv", "\n".join([f"{name},left,right", *lines])))
    assert samples.names == ("left", "right")
    assert samples.positions.tolist() == ROWS
    assert np.diff(samples.times) == pytest.approx(1.0)


def test_seconds_and_nanoseconds_make_one_time(tmp_path):
    text = "sec,nanosec,a\n7,900000000,0\n8,100000000,1\n8,400000000,2\n"
    assert np.diff(read_samples(put(tmp_path, "r.csv", text)).times) == pytest.approx([0.2, 0.3])


def test_a_universal_robots_recording(tmp_path):
    head = "timestamp,actual_q_0,actual_q_1,target_q_0,actual_qd_0,actual_qd_1,actual_current_0"
    samples = read_samples(put(tmp_path, "rtde.csv", f"{head}\n0.0,1,2,9,3,4,5\n0.1,1.1,2.1,9,3,4,5\n"))
    assert samples.positions.tolist() == [[1, 2], [1.1, 2.1]]
    assert samples.velocities.tolist() == [[3, 4], [3, 4]]
    assert "target_q_0" in samples.notes[0]
    assert "actual_current_0" in samples.notes[0]


def test_joint_states_as_ros2_topic_echo_prints_them(tmp_path):
    state = {"name": ["b", "a"], "velocity": [], "effort": []}
    texts = [
        yaml.safe_dump({"header": {"stamp": {"sec": k, "nanosec": 500}}, **state, "position": row[::-1]})
        for k, row in enumerate(ROWS)
    ]
    samples = read_samples(put(tmp_path, "echo.yaml", "---\n".join(texts) + "---\n"))
    assert samples.of(("a", "b"), "file").positions.tolist() == ROWS
    assert samples.times.tolist() == [0, 1, 2]


@pytest.mark.parametrize("keys", [("goal", "trajectory"), ("msg",), ("trajectory", 0, "joint_trajectory")])
def test_a_trajectory_at_any_depth(tmp_path, keys):
    points = [{"positions": row, "time_from_start": {"sec": k}} for k, row in enumerate(ROWS)]
    content = {"joint_names": ["a", "b"], "points": points}
    for key in reversed(keys):
        content = [content] if key == 0 else {key: content}
    assert read_samples(put(tmp_path, "m.json", content)).positions.tolist() == ROWS


def test_arrays(tmp_path):
    np.save(tmp_path / "q.npy", np.array(ROWS))
    np.savez(tmp_path / "q.npz", qpos=ROWS, t=[0, 1, 2], names=["a", "b"], images=np.zeros(3))
    assert read_samples(tmp_path / "q.npy").positions.tolist() == ROWS
    samples = read_samples(tmp_path / "q.npz")
    assert (samples.names, samples.times.tolist()) == (("a", "b"), [0, 1, 2])
    assert "'images'" in samples.notes[0]


def test_a_lerobot_episode(tmp_path):
    pa = pytest.importorskip("pyarrow")
    import pyarrow.parquet as pq

    columns = {"observation.state": ROWS, "timestamp": [0.0, 0.1, 0.2], "episode_index": [0, 0, 0]}
    pq.write_table(pa.table(columns), tmp_path / "e.parquet")
    samples = read_samples(tmp_path / "e.parquet")
    assert samples.positions.tolist() == ROWS
    assert samples.times.tolist() == [0.0, 0.1, 0.2]
    pq.write_table(pa.table(columns | {"episode_index": [0, 0, 1]}), tmp_path / "e.parquet")
    with pytest.raises(StudyError, match="several episodes"):
        read_samples(tmp_path / "e.parquet")


def test_named_states_are_waypoints(tmp_path):
    state = "<group_state name='{}' group='arm'><joint name='a' value='{}'/><joint name='b' value='{}'/></group_state>"
    text = "".join(state.format(name, *row) for name, row in zip(("home", "up", "far"), ROWS, strict=True))
    put(tmp_path, "r.srdf", f"<robot name='r'>{text}</robot>")
    assert read_samples(tmp_path / "r.srdf#far,home").positions.tolist() == [ROWS[2], ROWS[0]]
    with pytest.raises(StudyError, match="did you mean 'home'"):
        read_samples(tmp_path / "r.srdf#hom")


JOINT = {"has_velocity_limits": True, "max_velocity": 2.0, "has_acceleration_limits": True, "max_acceleration": 4.0}


@pytest.mark.parametrize(
    "keys", [(), ("robot_description_planning",), ("/**", "ros__parameters", "robot_description_planning")]
)
def test_moveit_limits_in_every_wrapping(tmp_path, keys):
    content = {"joint_limits": {"a": JOINT}}
    for key in reversed(keys):
        content = {key: content}
    assert read_limits(put(tmp_path, "l.json", content)).joints["a"].velocity == 2.0


def test_limits_in_degrees_and_in_frankas_form(tmp_path):
    text = "joint_limits:\n  a: {max_velocity: !degrees 180.0}\n"
    assert read_limits(put(tmp_path, "l.yaml", text)).joints["a"].velocity == pytest.approx(np.pi)
    read = read_limits(
        put(tmp_path, "f.json", {"joint1": {"limit": {"lower": -2, "upper": 2, "velocity": 2.1, "effort": 87}}})
    )
    assert (read.joints["joint1"].velocity, read.joints["joint1"].lower) == (2.1, -2)


def test_scaling_and_deceleration_are_applied_and_misspelt_keys_named(tmp_path):
    content = {
        "default_velocity_scaling_factor": 0.5,
        "joint_limits": {"a": {**JOINT, "max_deceleration": -1.0, "max_acceleraton": 3.0, "min_velocity": -1.5}},
    }
    read = read_limits(put(tmp_path, "l.json", content))
    joint = read.joints["a"]
    assert (joint.velocity, joint.min_velocity, joint.acceleration) == (1.0, -0.75, 1.0)
    said = " ".join(read.notes)
    for part in (
        "multiplied by 'default_velocity_scaling_factor', 0.5",
        "'max_deceleration' 1",
        "did you mean 'max_acceleration'",
    ):
        assert part in said


ROBOT = """<robot name="r">
<link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/>
<joint name="spin" type="continuous"><parent link="l0"/><child link="l1"/><limit velocity="0" effort="1"/></joint>
<joint name="lift" type="prismatic"><parent link="l1"/><child link="l2"/><limit lower="-inf" upper="2" velocity="1"/>
<safety_controller soft_lower_limit="0" soft_upper_limit="1.5" k_velocity="1"/></joint>
<joint name="jaw" type="prismatic"><parent link="l2"/><child link="l3"/><limit lower="0" upper="0.4" velocity="0.5"/>
<mimic joint="lift" multiplier="2" offset="0.1"/></joint>
<joint name="base" type="floating"><parent link="l3"/><child link="l4"/></joint>
</robot>"""


def test_odd_urdf_joints_are_taken_and_said(tmp_path):
    path = put(tmp_path, "r.urdf", ROBOT)
    read = read_limits(path)
    assert read.joints["spin"].velocity is None
    assert read.joints["spin"].endless
    assert (read.joints["lift"].velocity, read.joints["lift"].upper) == (0.25, pytest.approx(0.15))
    assert read.followers == {"jaw": "lift"}
    said = " ".join(read.notes)
    for part in ("'spin': velocity 0", "safety controller's, 1.5", "'jaw' follows 'lift'", "'base' is floating"):
        assert part in said
    with pytest.raises(StudyError, match="'base' is floating"):
        read_urdf(path).chain(["base"])


def test_equal_and_nearly_equal_neighbours_are_one_waypoint_and_demands_move_along(tmp_path):
    rows = [[0.0, 0.0], [1.0, 1.0], [1.0, 1.0 + 1e-13], [1.0, 1.0], [0.5, 0.2], [0.0, 0.1]]
    case = case_of(tmp_path, waypoints=rows, stops=[5])
    assert case.problem.n_waypoints == 4
    assert case.problem.stops == (2,)
    assert "waypoints 2 and 3 are the same place" in case.warnings[0]


def test_an_endless_joint_takes_the_short_way_unless_forbidden(tmp_path):
    put(tmp_path, "r.urdf", ROBOT)
    content = {"joints": ["spin"], "waypoints": [[3.1], [-3.1]], "limits": {"from": "r.urdf", **LIMITS}}
    case = case_of(tmp_path, **content)
    assert np.ptp(case.problem.waypoints) == pytest.approx(2 * np.pi - 6.2)
    assert any("short way" in note for note in case.warnings)
    assert np.ptp(case_of(tmp_path, **content, unwrap=False).problem.waypoints) == pytest.approx(6.2)


def test_rounding_at_the_end_of_a_range_is_not_outside_and_more_is_said_in_the_files_units(tmp_path):
    content = {"units": "deg", "joints": ["elbow"], "limits": LIMITS | {"position": {"lower": -90, "upper": 90}}}
    case = case_of(tmp_path, **content, waypoints=[[0.0], [90.0001]])
    assert case.problem.waypoints.max() == case.problem.limits.upper[0]
    assert "onto it" in case.warnings[0]
    with pytest.raises(
        StudyError, match=r"waypoint 2 puts joint 'elbow' at 95 deg, outside its range \[-90 deg, 90 deg\]"
    ):
        case_of(tmp_path, **content, waypoints=[[0.0], [95.0]])


def test_a_moving_joint_without_limits_is_named_with_the_name_that_was_meant(tmp_path):
    put(tmp_path, "l.json", {"joint_limits": {"elbow": JOINT, "wrist": JOINT}})
    limits = {"from": "l.json", "velocity": [None, None], "acceleration": 1.0}
    case = case_of(tmp_path, joints=["elbwo", "wrist"], waypoints=ROWS, limits=limits)
    assert (
        "joint 'elbwo' moves but has no limit of velocity; in the files of limits, did you mean 'elbow'?"
        in case.warnings
    )


def test_a_noisy_recording_is_thinned_within_the_tolerance(tmp_path):
    s = np.linspace(0, 1, 80)
    smooth = np.column_stack([np.sin(2 * s), s**2])
    rows = (smooth + np.random.default_rng(3).normal(0, 3e-4, smooth.shape)).tolist()
    case = case_of(tmp_path, waypoints=rows, tolerance=0.001)
    assert case.problem.n_waypoints < 40
    assert "were left out" in case.warnings[0]
    assert case_of(tmp_path, waypoints=rows).problem.n_waypoints == 80


def test_a_motion_given_in_a_message_is_not_dropped_in_silence(tmp_path):
    points = [{"positions": row, "velocities": [0.8, 0.0], "time_from_start": {"sec": k}} for k, row in enumerate(ROWS)]
    put(tmp_path, "m.json", {"joint_names": ["a", "b"], "points": points})
    assert "give 'start' or 'finish'" in case_of(tmp_path, waypoints="m.json").warnings[0]


@pytest.mark.parametrize("form", [".csv", ".yaml", ".json", ".npz"])
@pytest.mark.parametrize("sampling", [Sampling(), Sampling(rate=7), Sampling(points=9)])
def test_every_form_gives_its_samples_back(tmp_path, tiny_problem, form, sampling):
    coefficients = np.random.default_rng(5).normal(size=(3, 6, 2))
    motion = Trajectory(np.array([0.0, 0.3, 0.9, 1.7]), coefficients, np.array([0.0, 0.3, 0.9, 1.7]))
    back = read_samples(write_motion(motion, tiny_problem, tmp_path / f"m{form}", sampling))
    assert back.names == tiny_problem.joint_names
    np.testing.assert_allclose(back.positions, motion(back.times), rtol=0, atol=1e-13)
    assert back.times[-1] == pytest.approx(1.7, abs=1e-9)
    assert sampling.points is None or len(back.times) == sampling.points
