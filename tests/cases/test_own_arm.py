"""Limits of torque and of the tool in a user's file: what they come to, and every mistake in one sentence."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from study import StudyError
from study.cases.library import load_case
from study.demands import ARM

HEAVY = Path(__file__).parent.parent / "helpers" / "heavy.urdf"
PLAIN = {
    "units": ["rad", "deg", "mm"],
    "joints": ["base", "shoulder", "lift"],
    "waypoints": [[0, 0, 0], [0.5, 20, 100]],
    "robot": "heavy.urdf",
}


def loaded(folder, limits=None, **fields):
    shutil.copy(HEAVY, folder / "heavy.urdf")
    path = folder / "case.yaml"
    content = PLAIN | {"limits": {"velocity": 1.0} | (limits or {})} | fields
    path.write_text(yaml.safe_dump({key: value for key, value in content.items() if value is not None}))
    return load_case(path).problem.arm


def test_a_file_states_torques_and_the_tool(tmp_path):
    arm = loaded(
        tmp_path,
        {"torque": "effort", "tool_speed": 0.25, "tool_acceleration": 2},
        tool={"frame": "tip", "at": [0, 0, 0.1]},
        payload={"mass": 2, "at": [0, 0, 0.05]},
        gravity=[0, 0, -9.81],
        friction={"viscous": 0.5, "coulomb": [1, 2, 0]},
    )
    assert arm.demands == ARM
    assert arm.torque.tolist() == [80.0, 70.0, 60.0]
    assert (arm.tool_speed, arm.tool_acceleration) == (0.25, 2.0)
    mechanism = arm.mechanism
    assert mechanism.masses.tolist() == pytest.approx([4.0, 3.0, 3.9])
    assert mechanism.gravity.tolist() == [0, 0, -9.81]
    assert mechanism.viscous.tolist() == [0.5] * 3
    assert mechanism.coulomb.tolist() == [1.0, 2.0, 0.0]
    plain = loaded(tmp_path, {"tool_speed": 1.0}, tool="tip")
    np.testing.assert_allclose(mechanism.tool[:3, 3] - plain.mechanism.tool[:3, 3], 0.1 * plain.mechanism.tool[:3, 2])
    assert loaded(tmp_path) is None


def test_friction_is_the_model_s_only_where_the_file_says_so(tmp_path):
    torque = {"torque": [80, None, 60]}
    assert not loaded(tmp_path, torque).mechanism.viscous.any()
    assert loaded(tmp_path, torque, friction="model").mechanism.viscous.tolist() == [0.5, 0.2, 0.0]
    assert np.isinf(loaded(tmp_path, torque).torque[1])
    assert loaded(tmp_path, torque, payload=2).mechanism.masses[2] == pytest.approx(3.9)


def test_an_arm_of_the_study_has_its_published_torques(tmp_path):
    points = [[0, 0.8, 2.4, 0, 0.8, 0], [0.4, 1.0, 2.2, 0.1, 0.6, 0.2]]
    fields = {"units": "rad", "joints": None, "waypoints": points, "robot": "puma560"}
    assert loaded(tmp_path, {"torque": "effort"}, **fields).torque[0] == 97.6


@pytest.mark.parametrize(
    ("limits", "fields", "said"),
    [
        ({"torque": 50}, {"robot": None}, "torque under 'limits' need an arm; name one under 'robot'"),
        ({"tool_speed": 1}, {"robot": None}, "tool_speed under 'limits' need an arm"),
        ({}, {"payload": 2}, "payload change nothing without limits of torque"),
        ({"tool_speed": 1}, {"gravity": [0, 0, 0], "friction": "model"}, "gravity and friction change nothing without"),
        ({}, {"tool": "tip"}, "'tool' changes nothing without"),
        ({"torque": [1, 2]}, {}, "limits.torque has 2 numbers for 3 joints"),
        ({"torque": 50}, {"friction": {"viscous": [1, 2]}}, "friction.viscous has 2 numbers for 3 joints"),
        ({"torque": 50}, {"friction": {"viscous": -1}}, "field 'friction.viscous'"),
        ({"torque": 50}, {"payload": {"mass": -1}}, "field 'payload.mass'"),
        ({"torque": 50}, {"payload": {"at": [0, 0, 0]}}, "field 'payload.mass' is missing"),
        ({"torque": "efort"}, {}, "field 'limits.torque'"),
        ({"torque": -5}, {}, "field 'limits.torque'"),
        ({"tool_speed": 0}, {}, "field 'limits.tool_speed'"),
        ({"tool_speed": 1}, {"tool": {"frame": "tipp"}}, "did you mean 'tip'"),
        ({"tool_speed": 1}, {"tool": {"at": [1, 2]}}, "field 'tool.at'"),
        ({"torque": 50}, {"gravity": [0, 0]}, "field 'gravity'"),
        ({"torque": 50, "tool_velocity": 1}, {}, "unknown key 'limits.tool_velocity'"),
        ({"torque": 2}, {}, "gravity alone asks for"),
    ],
)
def test_every_mistake_is_one_sentence(tmp_path, limits, fields, said):
    with pytest.raises(StudyError) as error:
        loaded(tmp_path, limits, **fields)
    assert said in str(error.value)
    assert "case" in str(error.value)
    assert "\n" not in str(error.value)


def test_torques_of_an_arm_without_masses_are_refused(tmp_path):
    points = [[0] * 6, [0.5] * 6]
    fields = {"units": "rad", "joints": None, "waypoints": points, "robot": "aubo-i5"}
    with pytest.raises(StudyError, match=r"the arm's file states none; .* of the study's arms puma560 and ur5"):
        loaded(tmp_path, {"torque": 50}, **fields)
    text = HEAVY.read_text()
    for effort in ("80", "70", "60"):
        text = text.replace(f' effort="{effort}"', "")
    (tmp_path / "weak.urdf").write_text(text)
    with pytest.raises(StudyError, match="'torque: effort' takes the torques"):
        loaded(tmp_path, {"torque": "effort"}, robot="weak.urdf")
