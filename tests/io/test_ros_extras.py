"""ROS bags and xacro files, made here; both need packages of the extra `robots`."""

import numpy as np
import pytest

from study.cases.library import own_case
from study.errors import StudyError
from study.io.limits import read_limits
from study.io.recordings import read_samples

ROWS = [[0.1, 0.5], [0.3, 0.2], [0.7, -0.4]]


def bag(path, topics):
    """Write a bag of ROS 2 with joint states or trajectories: topic to list of rows, or of (names, row)."""
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    header, state, stamp = (
        types[f"{name}"]
        for name in ("std_msgs/msg/Header", "sensor_msgs/msg/JointState", "builtin_interfaces/msg/Time")
    )
    with rosbag2.Writer(path, version=9) as writer:
        for topic, (names, rows) in topics.items():
            kind = "trajectory_msgs/msg/JointTrajectory" if topic == "/plan" else "sensor_msgs/msg/JointState"
            connection = writer.add_connection(topic, kind, typestore=store)
            if topic == "/plan":
                point, span = (
                    types["trajectory_msgs/msg/JointTrajectoryPoint"],
                    types["builtin_interfaces/msg/Duration"],
                )
                empty = np.array([])
                points = [point(np.array(row), empty, empty, empty, span(k, 500)) for k, row in enumerate(rows)]
                messages = [types[kind](header(stamp(0, 0), ""), list(names), points)]
            else:
                messages = [
                    state(
                        header(stamp(5 + k, 250_000_000), ""),
                        list(names),
                        np.array(row),
                        np.array([0.5] * len(row)),
                        np.array([]),
                    )
                    for k, row in enumerate(rows)
                ]
            for k, message in enumerate(messages):
                writer.write(connection, (k + 1) * 10**9, store.serialize_cdr(message, kind))
    return path


def test_joint_states_in_a_bag(tmp_path):
    folder = bag(tmp_path / "run", {"/joint_states": (["right", "left"], [row[::-1] for row in ROWS])})
    for path in (folder, next(folder.glob("*.db3"))):
        samples = read_samples(path)
        assert samples.of(("left", "right"), "bag").positions.tolist() == ROWS
        assert samples.times.tolist() == [0, 1, 2]
        assert samples.velocities.tolist() == [[0.5, 0.5]] * 3


def test_a_plan_in_a_bag_comes_before_states_and_two_topics_are_refused(tmp_path):
    states = (["left"], [[0.0], [1.0]])
    samples = read_samples(bag(tmp_path / "both", {"/joint_states": states, "/plan": (["left", "right"], ROWS)}))
    assert samples.positions.tolist() == ROWS
    assert samples.times.tolist() == pytest.approx([5e-7, 1 + 5e-7, 2 + 5e-7])
    assert any("/joint_states" in note for note in samples.notes)
    with pytest.raises(StudyError, match=r"several topics.*/a, /b"):
        read_samples(bag(tmp_path / "two", {"/a": states, "/b": states}))
    with pytest.raises(StudyError, match="holds no message of"):
        read_samples(bag(tmp_path / "none", {}))


def test_a_bag_of_more_messages_than_memory_holds_is_refused_with_their_number(tmp_path, monkeypatch):
    monkeypatch.setattr("study.io.rosbag.MOST_MESSAGES", 2)
    with pytest.raises(StudyError, match="holds 3 messages of sensor_msgs/msg/JointState, and at most 2 are read; cut"):
        read_samples(bag(tmp_path / "run", {"/joint_states": (["left", "right"], ROWS)}))


def test_a_bag_is_planned_like_any_recording(tmp_path):
    bag(tmp_path / "run", {"/joint_states": (["left", "right"], ROWS)})
    case = own_case(
        {"waypoints": "run", "limits": {"velocity": 1, "acceleration": 2}, "units": "rad"}, tmp_path / "c.yaml"
    )
    assert case.problem.waypoints.tolist() == ROWS
    assert any("rates are not used" in note for note in case.warnings)


XACRO = """<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">
<xacro:property name="fast" value="2.5"/>
<xacro:macro name="axis" params="name parent child"><joint name="${name}" type="revolute"><parent link="${parent}"/>
<child link="${child}"/><limit lower="${-pi}" upper="${pi / 2}" velocity="${fast}"/></joint></xacro:macro>
<xacro:axis name="a" parent="l0" child="l1"/><xacro:axis name="b" parent="l1" child="l2"/></robot>"""


@pytest.mark.parametrize("ending", [".xacro", ".urdf.xacro", ".urdf"])
def test_macros_are_expanded(tmp_path, ending):
    pytest.importorskip("xacro")
    path = tmp_path / f"arm{ending}"
    path.write_text(XACRO)
    joints = read_limits(path).joints
    assert list(joints) == ["a", "b"]
    assert (joints["b"].velocity, joints["b"].lower, joints["b"].upper) == pytest.approx((2.5, -np.pi, np.pi / 2))
    path.write_text(XACRO.replace("${fast}", "${slow}"))
    with pytest.raises(StudyError, match=r"xacro cannot expand it.*slow") as error:
        read_limits(path)
    assert "\n" not in str(error.value)
