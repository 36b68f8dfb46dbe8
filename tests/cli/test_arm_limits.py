"""Limits of torque and of the tool on the command line: what is said, and that nothing is written that may not be driven."""

import pytest
import yaml

from study.cases.library import load_case
from study.cases.recorded import with_room
from tests.conftest import run_here

PENDULUM = """<robot name="pendulum">
  <link name="world"/>
  <link name="rod"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="pivot" type="revolute"><parent link="world"/><child link="rod"/><axis xyz="0 -1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="9"/></joint>
</robot>
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "pendulum.urdf").write_text(PENDULUM)
    return tmp_path


def case(folder, waypoints, **limits):
    content = {
        "units": "rad",
        "joints": ["pivot"],
        "waypoints": [[point] for point in waypoints],
        "robot": "pendulum.urdf",
        "tool": {"at": [0.5, 0, 0]},
        "limits": {"velocity": 3.0, "acceleration": 9.0} | limits,
    }
    (folder / "swing.yaml").write_text(yaml.safe_dump(content))


def test_a_plan_says_the_tool_s_speed_and_how_it_was_met(folder):
    case(folder, [0.0, 1.0], tool_speed=0.25)
    ended = run_here("plan", "swing.yaml", "--planner", "ruckig-stops", cwd=folder)
    assert ended.returncode == 0, ended.stderr
    words = " ".join(ended.stdout.split())
    assert "binding tool speed" in words
    assert "at most 100.00 % of its limit" in words
    assert "the whole motion is slowed down by" in words
    assert "to keep a limit of the tool's speed" in words


def test_nothing_is_written_where_the_arm_cannot_hold_itself(folder):
    case(folder, [-1.2, 1.2], velocity=0.3, torque="effort")
    ended = run_here("plan", "swing.yaml", "--save", "swing.csv", cwd=folder)
    assert ended.returncode == 3
    assert "slowing down does not help" in " ".join((ended.stdout + ended.stderr).split())
    assert not (folder / "swing.csv").exists()


def test_a_motion_beyond_a_torque_fails_the_check(folder):
    case(folder, [-1.2, -0.6], torque=9)
    run_here("plan", "swing.yaml", "--save", "swing.csv", cwd=folder)
    assert (folder / "swing.csv").exists()
    case(folder, [-1.2, -0.6], torque=8.2)
    ended = run_here("check", "swing.csv", "--case", "swing.yaml", cwd=folder)
    assert ended.returncode == 3
    assert "torque of pivot reaches" in " ".join((ended.stdout + ended.stderr).split())


def test_the_room_between_samples_is_a_torque_s_too(folder):
    case(folder, [-1.2, -0.6], torque=9, tool_speed=0.4)
    problem = load_case(str(folder / "swing.yaml")).problem
    roomy = with_room(problem, 1e-3).arm
    assert roomy.torque == pytest.approx(9.009)
    assert roomy.tool_speed == pytest.approx(0.4004)
