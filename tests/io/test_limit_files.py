"""Files of limits in every wrapping, limits that other limits tighten, and joints that follow."""

import json

import pytest

from study.cases.library import own_case
from study.errors import StudyError
from study.io.limits import read_limits

JOINT = {"max_velocity": 2.0, "max_acceleration": 4.0}


def put(tmp_path, content, name="l.json"):
    path = tmp_path / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


@pytest.mark.parametrize(
    "content",
    [
        {"a": JOINT, "b": JOINT},
        {"joints": {"a": JOINT, "b": JOINT}},
        {"joint_limits": [{"name": "a", **JOINT}, {"name": "b", **JOINT}]},
        {"joint_limits": {name: {"velocity": 2.0, "acceleration": 4.0} for name in "ab"}},
        {name: {"limit": {"velocity": 2.0, "acceleration": 4.0}} for name in "ab"},
        {"robot_description_planning": {"joint_limits": {"a": JOINT}}, "other": {"joint_limits": {"b": JOINT}}},
        {
            "/**": {
                "ros__parameters": {f"x.joint_limits.{n}.{key}": value for n in "ab" for key, value in JOINT.items()}
            }
        },
    ],
)
def test_every_wrapping_gives_the_same_limits(tmp_path, content):
    read = read_limits(put(tmp_path, content))
    assert {name: (joint.velocity, joint.acceleration) for name, joint in read.joints.items()} == dict.fromkeys(
        "ab", (2.0, 4.0)
    )
    assert read.notes == ()


def test_keys_beside_the_limits_are_named_and_factors_apply_wherever_they_stand(tmp_path):
    outer = {"default_velocity_scaling_factor": 0.5, "default_velocity_scaling_factr": 1, "cartesian_limits": {"v": 1}}
    for content in ({"joint_limits": {"a": JOINT}, **outer}, {"my_limits": {"a": JOINT}, **outer}):
        read = read_limits(put(tmp_path, content))
        assert read.joints["a"].velocity == 1.0
        said = " ".join(read.notes)
        assert "'default_velocity_scaling_factr' is not used; did you mean 'default_velocity_scaling_factor'" in said
        assert "'cartesian_limits' is not used" in said


def test_soft_limits_tighten_the_range_and_empty_ranges_are_refused(tmp_path):
    soft = {"has_soft_limits": True, "soft_lower_limit": -1.0, "soft_upper_limit": 3.0, "k_position": 9}
    hard = {"has_position_limits": True, "min_position": -2.0, "max_position": 2.0}
    read = read_limits(put(tmp_path, {"a": JOINT | hard | soft}))
    assert (read.joints["a"].lower, read.joints["a"].upper) == (-1.0, 2.0)
    assert len(read.notes) == 1
    with pytest.raises(StudyError, match="joint 'a': its range from 5 to 2 is empty"):
        read_limits(put(tmp_path, {"a": JOINT | hard | {"min_position": 5}}))
    read = read_limits(put(tmp_path, {"a": JOINT | hard | {"min_position": 2}}))
    assert read.joints["a"].lower is None
    assert "taken as not stated" in read.notes[0]


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("max_velocity", 0, "'max_velocity' must be above zero, got 0; set 'has_velocity_limits' to false"),
        ("max_jerk", -1, "'max_jerk' must be above zero, got -1"),
        ("min_velocity", 1, "'min_velocity' must be below zero, got 1"),
        ("max_deceleration", 0, "'max_deceleration' must not be zero"),
    ],
)
def test_impossible_limits_name_file_joint_and_key(tmp_path, key, value, sentence):
    with pytest.raises(StudyError, match=f"file 'l.json', joint 'a': {sentence}"):
        read_limits(put(tmp_path, {"a": JOINT | {key: value}}))


ARM = """<robot name="r"><link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/>
<joint name="lead" type="prismatic"><parent link="l0"/><child link="l1"/><limit lower="-1" upper="1" velocity="1"/></joint>
<joint name="jaw" type="prismatic"><parent link="l1"/><child link="l2"/><limit lower="-1" upper="1" velocity="1"/>
<mimic joint="lead" multiplier="-2" offset="0.5"/></joint>
<joint name="tip" type="prismatic"><parent link="l2"/><child link="l3"/><limit lower="-9" upper="9" velocity="1.2"/>
<mimic joint="jaw" multiplier="3"/></joint></robot>"""


def test_followers_tighten_their_master_through_all_files_and_along_chains(tmp_path):
    urdf = put(tmp_path, ARM, "r.urdf")
    read = read_limits(urdf)
    assert read.followers == {"jaw": "lead", "tip": "lead"}
    lead = read.joints["lead"]
    assert (lead.velocity, lead.lower, lead.upper) == (pytest.approx(0.2), -0.25, 0.75)  # tip: 1.2 / 6
    more = put(
        tmp_path,
        {
            "lead": {"max_velocity": 5.0, "max_acceleration": 8.0},
            "jaw": {"max_velocity": 9, "min_acceleration": -2.0, "max_acceleration": 6.0},
        },
    )
    lead = read_limits(urdf, more).joints["lead"]
    assert lead.velocity == pytest.approx(0.2)
    assert (lead.min_acceleration, lead.acceleration) == (-3.0, 1.0)  # -2 * lead lies between -2 and 6


def urdf(tmp_path, *joints):
    bodies = (
        f'<joint name="{name}" type="{kind}"><parent link="l{k}"/><child link="l{k + 1}"/>{inner}</joint>'
        for k, (name, kind, inner) in enumerate(joints)
    )
    return put(tmp_path, f"<robot name='r'>{''.join(bodies)}</robot>", "r.urdf")


@pytest.mark.parametrize(
    ("joint", "sentence"),
    [
        (
            ("a", "revolute", '<limit lower="1" upper="-1" velocity="1"/>'),
            "file 'r.urdf', joint 'a': its range from 1 to -1",
        ),
        (
            ("a", "revolute", '<limit lower="-1" upper="1" velocity="-2"/>'),
            "file 'r.urdf', joint 'a': 'velocity' must not be",
        ),
        (("a", "floating", ""), "no limits for joint 'a': file 'r.urdf', joint 'a' is floating, with several degrees"),
        (("a", "continuous", ""), "a moves without any limit, and the joints that have limits stand still"),
    ],
)
def test_mistakes_in_a_urdf_name_the_urdf_and_the_joint(tmp_path, joint, sentence):
    urdf(tmp_path, joint, ("b", "revolute", '<limit lower="-3" upper="3" velocity="1"/>'))
    content = {
        "units": "rad",
        "joints": ["a", "b"],
        "waypoints": [[0.0, 1.0], [0.5, 1.0]],
        "limits": {"from": "r.urdf"},
    }
    with pytest.raises(StudyError, match=sentence):
        own_case(content, tmp_path / "c.yaml")


def test_followers_without_a_master_or_without_room(tmp_path):
    lone = ("a", "revolute", '<limit lower="0" upper="3" velocity="1"/><mimic joint="gone"/>')
    read = read_limits(urdf(tmp_path, lone))
    assert list(read.joints) == ["a"]
    assert "mimics 'gone'" in read.notes[0]
    tight = ("a", "revolute", '<limit lower="0" upper="3" velocity="1"/><mimic joint="b"/>')
    with pytest.raises(StudyError, match=r"'a' follows 'b', but their ranges in r.urdf leave no room"):
        read_limits(urdf(tmp_path, tight, ("b", "revolute", '<limit lower="4" upper="5" velocity="1"/>')))
