"""Other packages' own limits of torque on one path: the natural spline by the roots of the chords, on the same gridpoints.

TOPP-RA's package and COPP are given the inverse dynamics that the study has; Drake builds its own from the bodies.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from study.arm import ArmLimits
from study.bench.measuring import timed
from study.bench.peers import installed
from study.bench.planner_parts import Part, Told
from study.judge import judge
from study.mechanism import Mechanism
from study.planning import usual_settings
from study.problem import Floats, JointLimits, Problem
from study.registry import planner_named
from study.robots.masses import heavy_arm, without_friction
from study.runs.execute import asked
from study.slowing import slow_down
from study.splines import at_constant_acceleration, spline_of, stations_of
from study.trajectory import Motion

POWER, SMALLEST = 0.5, 1e-3
"""Power of the chords that the path's parameter grows by; mass, kg, that Drake is given for a body without one."""


def problems() -> Iterator[Problem]:
    """A UR5 with 5 kg and a PUMA 560, of which only torques and generous rates are limited."""
    ur, puma = heavy_arm("ur5"), heavy_arm("puma560")
    degrees = np.array([[0, -90, 60, -60, -90, 0], [45, -80, 70, -80, -90, 20], [90, -100, 80, -70, -90, 0]])
    loaded = without_friction(ur.mechanism).carrying(5.0, (0.0, 0.0, 0.15))
    fast = JointLimits(np.full(6, 6.0), np.full(6, 80.0))
    yield Problem("UR5 with 5 kg", np.radians(degrees), fast, arm=ArmLimits(loaded, ur.effort))
    bent = np.array([[0, 0.8, 2.6, 0, 0.5, 0], [0.6, 1.1, 2.2, 0.3, 0.2, 0.4], [1.2, 0.6, 2.8, -0.2, 0.6, 0.1]])
    yield Problem("PUMA 560", bent, fast, arm=ArmLimits(without_friction(puma.mechanism), puma.effort))


def torque_peers(seed: int, told: Told) -> Part:
    """Durations on the same path under torques, ours and the peers', as they come and once the judge passes them."""
    rows = []
    for problem in problems():
        for name, (package, solve) in PEERS.items():
            if not installed(package) or (name == "drake" and _massless(problem)):
                continue
            told(f"{problem.name}, {name}")
            law, seconds = timed(lambda solve=solve, problem=problem: solve(problem), 1)  # type: ignore[misc]
            rows.append(_row(problem, name, at_constant_acceleration(problem, law), seconds))
        for name in ("toppra", "free-path"):
            told(f"{problem.name}, {name}")
            plan, seconds = timed(lambda name=name, problem=problem: _ours(name, problem), 1)  # type: ignore[misc]
            if plan.motion is not None:
                rows.append(_row(problem, f"{name} (ours)", plan.motion, seconds))
    head = ("problem", "planner", "duration s", "torque used", "s once it is kept", "CPU s")
    said = "All but `free-path` drive the same path; what a peer exceeds between its gridpoints, the whole motion is slowed down for."
    return Part("Limits of torque: other packages on the same path", head, tuple(rows), (said,))


def _ours(name: str, problem: Problem) -> Any:
    return asked(planner_named(name), problem, replace(usual_settings(problem), curve="cubic-spline"))


def _row(problem: Problem, name: str, motion: Motion, seconds: float) -> tuple[str, ...]:
    verdict, arm = judge(problem, motion), problem.arm
    stretch = verdict.stretch
    if arm is not None:
        stretch *= slow_down(arm, motion.scaled(stretch))
    used = f"{100 * verdict.arm_shares[1].max():.2f} %"
    return problem.name, name, f"{motion.duration:.4f}", used, f"{motion.duration * stretch:.4f}", f"{seconds:.2f}"


Answer = tuple[Any, Floats, Floats]


def with_toppra(problem: Problem) -> Answer:
    """Ask the package `toppra`, with its own constraint of torque."""
    toppra, constraint = importlib.import_module("toppra"), importlib.import_module("toppra.constraint")
    algorithm: Any = importlib.import_module("toppra.algorithm")
    spline, arm, torque = spline_of(problem, POWER, "natural"), _arm(problem), _torque(problem)
    velocity, acceleration = problem.limits.rates[:2]
    limits = [
        constraint.JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
        constraint.SecondOrderConstraint.joint_torque_constraint(
            lambda q, v, a: arm.torque(q, v, a)[0], np.stack([-torque, torque], axis=1), np.zeros(problem.n_joints)
        ),
    ]
    path, points = toppra.SplineInterpolator(spline.x, problem.waypoints, bc_type="natural"), stations_of(spline.x)
    _, speeds, _ = algorithm.TOPPRA(limits, path, gridpoints=points).compute_parameterization(0.0, 0.0)
    return spline, points, speeds


def with_copp(problem: Problem) -> Answer:
    """Ask COPP's TOPP2-RA, with its own limits of torque."""
    copp: Any = importlib.import_module("copp_py")
    spline, arm, torque = spline_of(problem, POWER, "natural"), _arm(problem), _torque(problem)
    points = stations_of(spline.x)
    robot = copp.Robot(problem.n_joints, capacity=len(points))
    robot.set_inverse_dynamics(lambda q, v, a: arm.torque(q, v, a)[0])
    robot.append_s(points)
    robot.set_q(spline(points), spline(points, 1), spline(points, 2), 0, dddq=spline(points, 3))
    adders = (robot.add_velocity_limits, robot.add_acceleration_limits, robot.add_torque_limits)
    for add, limit in zip(adders, (*problem.limits.rates[:2], torque), strict=True):
        add(limit, -limit, start_idx_s=0, length=len(points))
    second = copp.solver.topp2_ra
    given = second.Problem(robot.constraints, idx_s_interval=(0, len(points) - 1), a_boundary=(0.0, 0.0))
    squares = np.asarray(second.solve(given, second.Options()))
    return spline, points, np.sqrt(np.maximum(squares, 0.0))


def with_drake(problem: Problem) -> Answer:
    """Ask Drake's Toppra, with bodies and limits of its own."""
    optimization: Any = importlib.import_module("pydrake.multibody.optimization")
    trajectories: Any = importlib.import_module("pydrake.trajectories")
    spline, torque = spline_of(problem, POWER, "natural"), _torque(problem)
    points, (velocity, acceleration) = stations_of(spline.x), problem.limits.rates[:2]
    path = trajectories.PiecewisePolynomial.CubicWithContinuousSecondDerivatives(
        spline.x, problem.waypoints.T, spline(spline.x[0], 1), spline(spline.x[-1], 1)
    )
    plant = _plant(_arm(problem))  # which the solver does not keep alive
    solver = optimization.Toppra(path, plant, points)
    solver.AddJointVelocityLimit(-velocity, velocity)
    solver.AddJointAccelerationLimit(-acceleration, acceleration)
    solver.AddJointTorqueLimit(-torque, torque)
    times = solver.SolvePathParameterization()
    return spline, points, np.array([times.EvalDerivative(t, 1)[0, 0] for t in _inverted(times, points)])


def _inverted(times: Any, points: Floats) -> Floats:
    """Times at which Drake's s(t) passes the gridpoints; its pieces run from one to the next."""
    breaks = np.array(times.get_segment_times())
    return breaks if len(breaks) == len(points) else np.interp(points, [times.value(t)[0, 0] for t in breaks], breaks)


def _plant(arm: Mechanism) -> Any:
    """The same bodies and joints as a plant of Drake's."""
    tree: Any = importlib.import_module("pydrake.multibody.tree")
    math: Any = importlib.import_module("pydrake.math")
    plant: Any = importlib.import_module("pydrake.multibody.plant").MultibodyPlant(0.0)
    plant.mutable_gravity_field().set_gravity_vector(arm.gravity)
    parent = plant.world_body()
    for joint in range(arm.n_joints):
        inertia, mass = arm.inertias[joint], max(float(arm.masses[joint]), SMALLEST)
        moments = [inertia[k] for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        central = tree.RotationalInertia(*moments)
        spatial = tree.SpatialInertia.MakeFromCentralInertia(mass, arm.centres[joint], central)
        body = plant.AddRigidBody(f"body {joint}", spatial)
        place = math.RigidTransform(arm.origins[joint])
        kind = tree.PrismaticJoint if arm.sliding[joint] else tree.RevoluteJoint
        frames = plant.AddFrame(tree.FixedOffsetFrame(f"frame {joint}", parent.body_frame(), place)), body.body_frame()
        plant.AddJoint(kind(f"joint {joint}", *frames, [0, 0, 1]))
        parent = body
    plant.Finalize()
    return plant


def _massless(problem: Problem) -> bool:
    """Whether Drake cannot hold the arm: a body without mass, or drives with inertia of their own."""
    return bool((_arm(problem).masses == 0).any() or _arm(problem).rotors.any())


def _arm(problem: Problem) -> Mechanism:
    if problem.arm is None:
        raise ValueError("the problem limits no torque")
    return problem.arm.mechanism


def _torque(problem: Problem) -> Floats:
    if problem.arm is None:
        raise ValueError("the problem limits no torque")
    return problem.arm.torque


PEERS: dict[str, tuple[str, Callable[[Problem], Answer]]] = {
    "toppra's package": ("toppra", with_toppra),
    "copp": ("copp_py", with_copp),
    "drake": ("pydrake", with_drake),
}
"""Packages by name: what must be installed, and how it is asked."""
