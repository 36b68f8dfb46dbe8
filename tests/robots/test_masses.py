"""Arms with masses from files: against published numbers, forward kinematics and Drake, which reads the file by itself."""

from pathlib import Path

import numpy as np
import pytest

from study import StudyError
from study.robots import robot_named, robot_names
from study.robots.masses import heavy_arm, without_friction
from study.robots.urdf import urdf_robot

HEAVY = Path(__file__).parent.parent / "helpers" / "heavy.urdf"
ZERO = np.zeros((1, 6))


def test_the_puma_has_the_torques_and_masses_that_its_toolbox_prints():
    """P. Corke, Robotics, Vision and Control, 2nd ed., section 9.2: gravload and inertia of the PUMA 560 at qn."""
    arm = heavy_arm("puma560").mechanism
    at = np.array([[0, np.pi / 4, np.pi, 0, np.pi / 4, 0]])
    held = arm.torque(at, ZERO, ZERO) * 9.81 / 9.80665
    np.testing.assert_allclose(held[0], [0, 31.6399, 6.0351, 0, 0.0283, 0], atol=1e-4)
    inertia = arm.torque(np.tile(at, (6, 1)), np.zeros((6, 6)), np.eye(6)) - arm.torque(at, ZERO, ZERO)
    np.testing.assert_allclose(np.diag(inertia), [3.6594, 4.4137, 0.9378, 0.1925, 0.1713, 0.1941], atol=1e-4)
    np.testing.assert_allclose(inertia[0, 1:4], [-0.4044, 0.1006, -0.0025], atol=1e-4)


@pytest.mark.parametrize("name", robot_names())
def test_the_tool_of_every_arm_moves_as_its_kinematics_say(name):
    q, velocity = np.random.default_rng(0).normal(size=(2, 3, robot_named(name).n_joints))
    _moves_as(robot_named(name), heavy_arm(name).mechanism, q, velocity)


def test_the_tool_of_a_urdf_moves_as_its_kinematics_say():
    q, velocity = np.random.default_rng(0).normal(size=(2, 3, 3))
    _moves_as(urdf_robot(HEAVY), heavy_arm(str(HEAVY)).mechanism, q, velocity)


def _moves_as(robot, mechanism, q, velocity, step=1e-6):
    ahead, behind = (robot.forward(q + sign * step * velocity)[:, :3, 3] for sign in (1, -1))
    speed = np.linalg.norm(ahead - behind, axis=1) / (2 * step)
    exact = np.linalg.norm(mechanism.tool_rates(q, velocity, 0 * q)[0], axis=1)
    np.testing.assert_allclose(exact, speed, rtol=1e-7)


def test_a_urdf_states_efforts_friction_and_bodies_on_fixed_joints():
    arm = heavy_arm(str(HEAVY))
    assert arm.effort.tolist() == [80.0, 70.0, 60.0]
    assert arm.mechanism.viscous.tolist() == [0.5, 0.2, 0.0]
    assert arm.mechanism.coulomb.tolist() == [1.5, 0.0, 0.0]
    assert arm.mechanism.masses.tolist() == pytest.approx([4.0, 3.0, 1.9])


def test_drake_reads_the_same_torques_from_the_file():
    tree = pytest.importorskip("pydrake.multibody.tree", exc_type=ImportError)
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(HEAVY))
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -9.80665])
    plant.Finalize()
    context, arm = plant.CreateDefaultContext(), heavy_arm(str(HEAVY), frame="tip").mechanism
    tip = plant.GetFrameByName("tip")
    assert plant.num_positions() == 3
    for q, v, a in np.random.default_rng(4).normal(size=(5, 3, 3)):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        forces = tree.MultibodyForces_[float](plant)
        plant.CalcForceElementsContribution(context, forces)
        torque = plant.CalcInverseDynamics(context, a, forces)
        smooth = arm.torque(q, v, a)[0] - arm.coulomb * np.sign(v)
        np.testing.assert_allclose(smooth, torque, rtol=1e-9, atol=1e-9)
        speed = tip.CalcSpatialVelocityInWorld(context).translational()
        assert np.linalg.norm(arm.tool_rates(q, v, a)[0]) == pytest.approx(np.linalg.norm(speed), rel=1e-10)


def test_pinocchio_reads_the_same_torques_from_the_file():
    pinocchio = pytest.importorskip("pinocchio", exc_type=ImportError)
    model, arm = pinocchio.buildModelFromUrdf(str(HEAVY)), without_friction(heavy_arm(str(HEAVY)).mechanism)
    model.gravity.linear = arm.gravity
    data = model.createData()
    for q, v, a in np.random.default_rng(5).normal(size=(9, 3, 3)):
        wrapped = np.array([np.cos(q[0]), np.sin(q[0]), *q[1:]])  # of a joint without end
        np.testing.assert_allclose(arm.torque(q, v, a)[0], pinocchio.rnea(model, data, wrapped, v, a), atol=1e-12)


@pytest.mark.parametrize(
    ("name", "frame", "said"),
    [
        (str(HEAVY), "tipp", "did you mean 'tip'"),
        (str(HEAVY), "column", "does not move with the last joint, 'lift'"),
        ("ur5", "tool0", "names no frames"),
    ],
)
def test_a_frame_that_is_not_the_tool_s_is_refused(name, frame, said):
    with pytest.raises(StudyError, match=said):
        heavy_arm(name, frame=frame)


def test_a_negative_mass_is_refused(tmp_path):
    path = tmp_path / "light.urdf"
    path.write_text(HEAVY.read_text().replace('value="1.5"', 'value="-1.5"'))
    with pytest.raises(StudyError, match="link 'slide': its mass must not be negative"):
        heavy_arm(str(path))
