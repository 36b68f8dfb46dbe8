import numpy as np
import pytest

from study.errors import StudyError
from study.io.limits import read_limits
from study.io.one_joint import OneJoint
from study.io.urdf import read_urdf
from study.robots import robot_named
from study.robots.chain import screw_x, screw_z
from study.robots.urdf import urdf_robot
from tests.helpers.robot_files import MOVEIT, URDF


@pytest.fixture
def urdf(tmp_path):
    path = tmp_path / "bench.urdf"
    path.write_text(URDF)
    return path


def test_moveit_limits_follow_their_switches(tmp_path):
    path = tmp_path / "joint_limits.yaml"
    path.write_text(MOVEIT)
    assert read_limits(path).joints == {
        "panda_joint1": OneJoint(velocity=0.2175, acceleration=3.75),
        "joint <2>": OneJoint(velocity=0.1, lower=-0.5, upper=2.0),
    }


@pytest.mark.parametrize(
    ("text", "sentence"),
    {
        "switch without value": (
            "joint_limits: {a: {has_velocity_limits: true}}",
            "'has_velocity_limits' is true, but 'max_velocity' is missing",
        ),
        "word": ("joint_limits: {a: {max_velocity: fast}}", "'max_velocity' must be a number, got 'fast'"),
        "infinite": ("joint_limits: {a: {max_velocity: .inf}}", "must be finite"),
        "other file": ("joints: {}", "holds no limits"),
        "list": ("- 1", "holds no limits"),
        "scalar joint": ("joint_limits: {a: 3}", "expected fields such as 'max_velocity'"),
    }.values(),
)
def test_what_is_wrong_with_moveit_limits_is_one_sentence(tmp_path, text, sentence):
    path = tmp_path / "joint_limits.yaml"
    path.write_text(text)
    with pytest.raises(StudyError) as error:
        read_limits(path)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


def test_urdf_limits(urdf):
    assert read_limits(urdf).joints == {
        "turn": OneJoint(velocity=3.14, lower=-1.5, upper=2.5, sliding=False, endless=False),
        "slide": OneJoint(velocity=0.25, lower=0.0, upper=0.6, sliding=True, endless=False),
        "spin": OneJoint(velocity=6.0, sliding=False, endless=True),
    }


def test_urdf_frames_by_hand(urdf):
    arm = urdf_robot(urdf)
    assert arm.prismatic.tolist() == [False, True, False]
    frames = arm.frames([[0.0, 0.0, 0.0], [np.pi / 2, 0.5, 0.3]])
    np.testing.assert_allclose(frames[0, :, :3, 3], [[0, 0, 0], [0, 0, 0.5], [0, 0.2, 0.5], [0, 0.2, 0.5]], atol=1e-12)
    # mount and turn make half a turn about z: x points to -x; the slide's own x axis points down after its quarter turn
    np.testing.assert_allclose(frames[1, 2, :3, 3], [-0.2, 0, 0.0], atol=1e-12)


def test_a_dh_arm_written_as_urdf_has_the_same_frames(tmp_path):
    arm = robot_named("ur5")
    joints, parent = [], "base"
    for k in range(arm.n_joints):
        before = np.eye(4) if k == 0 else screw_z(0.0, arm.d[k - 1]) @ screw_x(arm.alpha[k - 1], arm.a[k - 1])
        pitch = -np.arcsin(before[2, 0])
        roll, yaw = np.arctan2(before[2, 1], before[2, 2]), np.arctan2(before[1, 0], before[0, 0])
        xyz, rpy = " ".join(map(repr, before[:3, 3].tolist())), f"{float(roll)!r} {float(pitch)!r} {float(yaw)!r}"
        joints.append(
            f'<joint name="j{k}" type="continuous"><origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/>'
            f'<parent link="{parent}"/><child link="l{k}"/></joint>'
        )
        parent = f"l{k}"
    path = tmp_path / "ur5.urdf"
    path.write_text(f"<robot name='ur5'>{''.join(joints)}</robot>")
    q = np.random.default_rng(0).uniform(-3, 3, (20, 6))
    last = screw_z(0.0, arm.d[5]) @ screw_x(arm.alpha[5], arm.a[5])
    np.testing.assert_allclose(urdf_robot(path).forward(q - 0) @ last, arm.forward(q - arm.theta), atol=1e-12)


def test_named_joints_pick_a_chain(urdf):
    assert [joint.name for joint in read_urdf(urdf).chain(["turn", "spin"])] == ["mount", "turn", "slide", "spin"]
    assert urdf_robot(urdf, ("turn", "slide")).n_joints == 2
    assert robot_named(str(urdf), ("strange",)).n_joints == 3
    with pytest.raises(StudyError, match="no joint in URDF 'bench': 'trun'; did you mean 'turn'"):
        read_urdf(urdf).chain(["trun"])
    with pytest.raises(StudyError, match="do not follow each other"):
        read_urdf(urdf).chain(["slide", "turn"])


@pytest.mark.parametrize(
    ("text", "sentence"),
    {
        "not xml": ("<robot", "not valid XML"),
        "other xml": ("<html/>", "not URDF: its outermost element is 'html'"),
        "entities": ('<!DOCTYPE x [<!ENTITY a "b">]><robot/>', "declares a DOCTYPE"),
        "no joints": ("<robot name='r'/>", "has no joints"),
        "nameless": ("<robot><joint type='fixed'/></robot>", "needs a name and a type"),
        "no links": ("<robot><joint name='a' type='fixed'/></robot>", "needs a parent link and a child link"),
        "xacro": (
            "<robot xmlns:xacro='http://ros.org/wiki/xacro'><xacro:include filename='a'/></robot>",
            "or expand it first",
        ),
        "bad number": (
            "<robot><joint name='a' type='revolute'><parent link='x'/><child link='y'/><limit velocity='pi'/></joint></robot>",
            "'velocity' must be a finite number, got 'pi'",
        ),
        "bad origin": (
            "<robot><joint name='a' type='fixed'><parent link='x'/><child link='y'/><origin xyz='1 2'/></joint></robot>",
            "'xyz' must be three numbers up to 1e+12, got '1 2'",
        ),
        "no axis": (
            "<robot><joint name='a' type='revolute'><parent link='x'/><child link='y'/><axis xyz='0 0 0'/></joint></robot>",
            "its axis has no length",
        ),
    }.values(),
)
def test_what_is_wrong_with_urdf_is_one_sentence(tmp_path, text, sentence):
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    with pytest.raises(StudyError) as error:
        read_limits(path)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


def test_links_in_a_loop_are_refused(tmp_path):
    path = tmp_path / "loop.urdf"
    joint = "<joint name='{}' type='continuous'><parent link='{}'/><child link='{}'/></joint>"
    path.write_text(f"<robot>{joint.format('a', 'x', 'y')}{joint.format('b', 'y', 'x')}</robot>")
    with pytest.raises(StudyError, match="form a loop"):
        urdf_robot(path)
