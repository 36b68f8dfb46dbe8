"""Joints of a URDF file that follow others: they move with them, in forward kinematics and in the recording's 3D view."""

import json

import numpy as np
import pyarrow as pa
import pytest

from study.analysis.case_summary import summarise_case
from study.cases.library import load_case
from study.recording import record_case
from study.recording.contents import NANOSECOND
from study.robots import robot_named
from study.robots.urdf import urdf_robot
from tests.helpers.recordings import chunks, on_curve, result


def joint(name, kind, parent, child, xyz, axis, mimic=""):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}"/>'
        f'<axis xyz="{axis}"/><limit lower="-2" upper="2" velocity="2"/>{mimic}</joint>'
    )


PARALLEL = (
    joint("lower", "revolute", "base", "l1", "0 0 0", "0 0 1")
    + joint("keeper", "revolute", "l1", "l2", "1 0 0", "0 0 1", '<mimic joint="lower" multiplier="-1" offset="0.5"/>')
    + joint("reach", "prismatic", "l2", "l3", "0.5 0 0", "1 0 0")
)
FINGERS = (
    joint("left", "prismatic", "l3", "f1", "0 0.1 0", "0 1 0", '<mimic joint="reach" multiplier="0.25" offset="0.01"/>')
    + joint("right", "prismatic", "l3", "f2", "0 -0.1 0", "0 1 0", '<mimic joint="left" multiplier="-1"/>')
    + joint("idle", "revolute", "l3", "f3", "0 0 0", "0 0 1", '<mimic joint="stopped" multiplier="3" offset="0.2"/>')
    + joint("stopped", "revolute", "l3", "f4", "0 0 0", "0 0 1")
)
MESHES = "".join(
    f'<link name="{link}"><visual><geometry><mesh filename="m.obj"/></geometry></visual></link>'
    for link in ("f1", "f2", "f3", "l2")
)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "arm.urdf").write_text(f"<robot name='arm'>{PARALLEL}{FINGERS}{MESHES}</robot>")
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    robot_named.cache_clear()
    return tmp_path


def test_a_follower_on_the_arm_turns_with_its_master(folder):
    arm = urdf_robot(folder / "arm.urdf", ("lower", "reach"))
    q = np.array([[0.3, 0.2], [-1.0, 0.0]])
    expected = np.column_stack([np.cos(q[:, 0]), np.sin(q[:, 0])]) + (0.5 + q[:, 1:]) * [np.cos(0.5), np.sin(0.5)]
    np.testing.assert_allclose(arm.forward(q)[:, :2, 3], expected, atol=1e-12)


def test_fingers_carry_their_meshes_along(folder):
    arm = urdf_robot(folder / "arm.urdf", ("lower", "reach"))
    assert arm.missing == ""
    q = np.array([[0.3, 0.4], [0.0, 0.0]])
    frames = arm.mesh_frames(q)
    hand = np.linalg.inv(arm.forward(q))
    left, right, idle, middle = (frames[:, shape.frame] @ shape.place for shape in arm.shapes)
    np.testing.assert_allclose((hand @ left)[:, 1, 3], [0.1 + 0.01 + 0.1, 0.11], atol=1e-12)
    np.testing.assert_allclose((hand @ right)[:, 1, 3], [-0.1 - 0.01 - 0.1, -0.11], atol=1e-12)
    np.testing.assert_allclose((hand @ idle)[:, 1, 0], np.sin(0.2), atol=1e-12)
    np.testing.assert_allclose(middle[:, :2, 3], np.column_stack([np.cos(q[:, 0]), np.sin(q[:, 0])]), atol=1e-12)


def test_the_recording_moves_the_fingers(folder, tmp_path):
    content = {
        "units": ["rad", "m"],
        "joints": ["lower", "reach"],
        "robot": "arm.urdf",
        "waypoints": [[0.0, 0.0], [0.5, 0.3], [1.0, 0.1]],
        "limits": {"velocity": 1.0, "acceleration": 3.0},
    }
    (folder / "c.json").write_text(json.dumps(content))
    case = load_case(folder / "c.json")
    motion = on_curve(case, np.array([1.0, 1.0]))
    path = record_case(summarise_case(case, [result(case, "one", motion)]), tmp_path / "a.rrd", samples=20)
    arm = robot_named(str(case.robot), ("lower", "reach"))
    finger = arm.shapes[1].frame
    (batch,) = chunks(path, "/meshes/1", "InstancePoses3D:translations")
    times = batch.column("t").cast(pa.int64()).to_numpy() * NANOSECOND
    moved = batch.column("InstancePoses3D:translations").flatten().flatten().to_numpy().reshape(-1, 3)
    expected = (arm.mesh_frames(motion(times))[:, finger] @ arm.shapes[1].place)[:, :3, 3]
    np.testing.assert_allclose(moved, expected, atol=1e-6)
    assert np.ptp(moved, axis=0).max() > 0.1
