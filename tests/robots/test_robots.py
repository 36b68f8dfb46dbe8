"""The arms: forward kinematics against hand calculations and the papers, inverse kinematics against forward."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from study.cases.library import load_case
from study.cases.published import tables
from study.errors import StudyError
from study.robots import BRANCHES, inverse, robot_named, robot_names
from study.robots.helix import BRANCH, helix_configurations, helix_points

ARMS = ["aubo-i5", "puma560", "ur5", "ur5e-ssa", "woodworking"]


def random_configurations(name: str, n: int = 200) -> np.ndarray:
    robot = robot_named(name)
    low, high = (
        np.where(np.isfinite(side), side, sign * np.pi) for side, sign in zip(robot.range, (-1, 1), strict=True)
    )
    return np.random.default_rng(7).uniform(low, high, (n, robot.n_joints))


def gap(first: np.ndarray, second: np.ndarray, prismatic: np.ndarray) -> np.ndarray:
    """Distance of configurations, angles around the circle."""
    return np.where(prismatic, first - second, np.angle(np.exp(1j * (first - second))))


@pytest.mark.parametrize("name", robot_names())
def test_frames_are_rigid_and_start_at_the_base(name: str) -> None:
    robot = robot_named(name)
    q = np.random.default_rng(1).uniform(-1, 1, (5, robot.n_joints))
    frames = robot.frames(q)
    assert frames.shape == (5, robot.n_joints + 1, 4, 4)
    np.testing.assert_array_equal(frames[:, 0], np.broadcast_to(np.eye(4), (5, 4, 4)))
    rotation = frames[..., :3, :3]
    np.testing.assert_allclose(
        rotation @ np.swapaxes(rotation, -1, -2), np.broadcast_to(np.eye(3), rotation.shape), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(rotation), 1.0, atol=1e-12)
    np.testing.assert_array_equal(frames[:, -1], robot.forward(q))


@pytest.mark.parametrize("name", robot_names())
def test_each_joint_turns_about_or_slides_along_its_own_axis(name: str) -> None:
    """Moving one joint leaves its axis in place: the z axis before it (standard) or of its own frame (modified)."""
    robot = robot_named(name)
    q = np.random.default_rng(2).uniform(-1, 1, robot.n_joints)
    for joint in range(robot.n_joints):
        moved = q + 0.3 * np.eye(robot.n_joints)[joint]
        before, after = robot.frames(np.stack([q, moved]))
        frame = joint + 1 if robot.modified else joint
        axis = before[frame, :3, 2]
        np.testing.assert_allclose(after[frame, :3, 2], axis, atol=1e-12)
        shift = after[frame, :3, 3] - before[frame, :3, 3]
        slides = robot.prismatic[joint] and robot.modified
        np.testing.assert_allclose(shift, 0.3 * axis if slides else 0.0, atol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_inverse_undoes_forward_in_every_branch(name: str) -> None:
    robot = robot_named(name)
    q = random_configurations(name)
    poses = robot.forward(q)
    solutions = inverse(robot, poses)
    assert solutions.shape == (len(q), 1 if name == "woodworking" else 8, robot.n_joints)
    exists = ~np.isnan(solutions).any(axis=2)
    found = robot.forward(solutions[exists])
    np.testing.assert_allclose(found, np.repeat(poses, exists.sum(axis=1), axis=0), atol=1e-9)
    distance = np.abs(gap(solutions, q[:, None], robot.prismatic)).max(axis=2)
    assert np.nanmin(distance, axis=1).max() < 1e-7  # the configuration itself is among them


@pytest.mark.parametrize("name", ["aubo-i5", "puma560", "ur5", "ur5e-ssa"])
def test_branches_are_different_and_one_can_be_asked_for(name: str) -> None:
    robot = robot_named(name)
    home = random_configurations(name, 400)
    solutions = inverse(robot, robot.forward(home))
    whole = solutions[~np.isnan(solutions).any(axis=(1, 2))]
    assert len(whole) > 50
    for first in range(8):
        for second in range(first):
            differ = np.abs(gap(whole[:, first], whole[:, second], robot.prismatic)).max(axis=1)
            assert differ.min() > 1e-6
    for index, branch in enumerate(BRANCHES):
        np.testing.assert_allclose(inverse(robot, robot.forward(whole[:, 0]), branch), whole[:, index], atol=1e-6)
        assert (np.sign(np.sin(whole[:, index, 4])) == branch[1]).all()


def test_the_ur_unique_domain_signs() -> None:
    """The elbow's sign is that of sin(theta3), one factor of the determinant in Eq. (2) of the sparrow paper."""
    robot = robot_named("ur5e-ssa")
    solutions = inverse(robot, robot.forward(random_configurations("ur5e-ssa")))
    for index, branch in enumerate(BRANCHES):
        elbow = solutions[:, index, 2]
        assert (np.sign(np.sin(elbow[~np.isnan(elbow)])) == branch[2]).all()


# ---- against the papers -----------------------------------------------------------------------------


def test_helix_points_are_the_printed_ones() -> None:
    printed = tables("ur5-tadf-ssa")["Table 2"]
    rows = sorted({int(cell.row) for cell in printed.cells})
    expected = np.array([[printed.value(str(row), axis) for axis in "xyz"] for row in rows])
    np.testing.assert_allclose(1e3 * helix_points()[np.array(rows) - 1], expected, atol=5.1e-4)


def test_helix_configurations_are_the_printed_ones() -> None:
    printed = tables("ur5-tadf-ssa")["Table 3"]
    rows = sorted({int(cell.row) for cell in printed.cells})
    assert len(rows) == 7
    expected = np.array([[printed.value(str(row), f"theta{j}") for j in range(1, 7)] for row in rows])
    rebuilt = helix_configurations(robot_named("ur5e-ssa"))[np.array(rows) - 1]
    np.testing.assert_allclose(rebuilt, expected, atol=5e-5)


def test_the_branch_that_the_sparrow_paper_names_is_not_the_one_it_prints() -> None:
    robot = robot_named("ur5e-ssa")
    poses = robot.forward(helix_configurations(robot))
    named, printed = inverse(robot, poses, (1, -1, 1)), inverse(robot, poses, BRANCH)
    assert (named[:, 2] > 0).all()
    assert (printed[:, 2] < 0).all()


def test_the_printed_helix_positions_are_those_of_frame_5() -> None:
    robot = robot_named("ur5e-ssa")
    frames = robot.frames(helix_configurations(robot))
    np.testing.assert_allclose(frames[:, 5, :3, 3], helix_points(), atol=1e-12)
    assert np.abs(frames[:, 6, :3, 3] - helix_points()).max() > 0.09


@pytest.mark.parametrize(("point", "tolerance"), [("W1", 0.006), ("W2", 0.06)])
def test_aubo_gripping_points(point: str, tolerance: float) -> None:
    """Table 2 through Table 1 gives Table 3, to its last printed digit, mm."""
    paper = tables("aubo-dynamic-adaptive-pso")
    q = np.radians([paper["Table 2"].value(point, f"theta{j} (deg)") for j in range(1, 7)])
    position = 1e3 * robot_named("aubo-i5").forward(q)[0, :3, 3]
    expected = [paper["Table 3"].value(point, f"{axis} (mm)") for axis in "XYZ"]
    np.testing.assert_allclose(position, expected, atol=tolerance)


def test_aubo_initial_endpoint_is_misprinted() -> None:
    position = 1e3 * robot_named("aubo-i5").forward(np.zeros(6))[0, :3, 3]
    np.testing.assert_allclose(position, [0, -215.5, 1008.0], atol=1e-9)


def test_woodworking_pose_is_equation_2() -> None:
    robot = robot_named("woodworking")
    d1, d2, t3, t4 = q = np.array([0.4, 0.9, 0.7, -1.1])
    s3, c3, s4, c4 = np.sin(t3), np.cos(t3), np.sin(t4), np.cos(t4)
    expected = [  # r21 read as sin(theta4)
        [-s3 * c4, s3 * s4, c3, d2 + 0.2865 * c3],
        [s4, c4, 0, 0.672],
        [-c3 * c4, c3 * s4, -s3, d1 - 0.2865 * s3],
        [0, 0, 0, 1],
    ]
    np.testing.assert_allclose(robot.forward(q)[0], expected, atol=1e-12)


def test_woodworking_waypoints_come_back() -> None:
    robot = robot_named("woodworking")
    waypoints = load_case("woodworking").problem.waypoints
    np.testing.assert_allclose(inverse(robot, robot.forward(waypoints))[:, 0], waypoints, atol=1e-9)


def test_puma_zero_and_ready_positions() -> None:
    """Hand calculation from the link lengths: at zero the forearm points up behind an upper arm along x."""
    robot = robot_named("puma560")
    np.testing.assert_allclose(robot.forward(np.zeros(6))[0, :3, 3], [0.4521, -0.15005, 0.4318], atol=1e-12)
    ready = np.array([0, np.pi / 2, -np.pi / 2, 0, 0, 0])
    np.testing.assert_allclose(robot.forward(ready)[0, :3, 3], [0.0203, -0.15005, 0.8636], atol=1e-12)


# ---- what cannot be done ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ARMS)
def test_out_of_reach(name: str) -> None:
    far = robot_named(name).forward(random_configurations(name, 2))
    far[1, :3, 3] += 5.0
    with pytest.raises(StudyError, match="pose 2 is singular or cannot be reached"):
        inverse(robot_named(name), far)


@pytest.mark.parametrize("name", ["aubo-i5", "puma560", "ur5", "ur5e-ssa"])
def test_a_straight_wrist_is_singular_in_its_own_branches(name: str) -> None:
    robot = robot_named(name)
    straight = random_configurations(name, 1)
    straight[0, 4] = 0.0
    bent = straight + 0.05 * np.eye(6)[4]
    distance = np.abs(gap(inverse(robot, robot.forward(bent)), bent, robot.prismatic)).max(axis=2)
    k1, _, k3 = BRANCHES[int(np.nanargmin(distance))]
    for k2 in (1, -1):
        with pytest.raises(StudyError, match="pose 1 is singular"):
            inverse(robot, robot.forward(straight), (k1, k2, k3))


@pytest.mark.parametrize("name", ["aubo-i5", "puma560", "ur5", "ur5e-ssa"])
def test_wrist_above_the_shoulder_is_singular(name: str) -> None:
    robot = robot_named(name)
    pose = robot.forward(random_configurations(name, 1))
    wrist_offset = robot.d[5] * pose[0, :3, 2]
    offset = robot.d[1:4].sum() if name != "puma560" else robot.d[1:3].sum()
    pose[0, :3, 3] = wrist_offset + np.array(
        [0.5 * offset, 0.0, 0.3]
    )  # inside the cylinder that the wrist cannot enter
    with pytest.raises(StudyError, match="cannot be reached"):
        inverse(robot, pose)


def test_errors_name_the_robot_and_the_shape() -> None:
    with pytest.raises(StudyError, match="did you mean 'puma560'"):
        robot_named("puma")
    robot = robot_named("ur5")
    with pytest.raises(StudyError, match=r"shape \(n, 6\), got \(1, 5\)"):
        robot.forward(np.zeros((1, 5)))
    with pytest.raises(StudyError, match=r"shape \(n, 4, 4\)"):
        inverse(robot, np.eye(4))
    with pytest.raises(StudyError, match="three signs"):
        inverse(robot, robot.forward(np.ones(6)), (1, 1, 0))
    with pytest.raises(StudyError, match="no closed-form inverse"):
        inverse(replace(robot, solver=None), np.eye(4)[None])
