"""Torques and rates of a tool by another derivation than the recursion: all bodies in the base frame, and virtual work.

The torque of a joint is the work, per turn, of the forces and moments that move every body beyond it. Nothing is
passed from joint to joint but the places of the axes.
"""

from __future__ import annotations

import numpy as np

from study.arm import ArmLimits
from study.mechanism import Mechanism
from study.problem import Floats


def arm_shares(limits: ArmLimits, q: Floats, velocity: Floats, acceleration: Floats) -> Floats:
    """Shares of the limits of an arm at instants.

    Parameters
    ----------
    limits : ArmLimits
    q, velocity, acceleration : arrays of shape (n, n_joints)

    Returns
    -------
    array of shape (n, n_joints + 2)
        Torques by joint, the tool's speed and its acceleration.
    """
    torque, tool_velocity, tool_acceleration = second_dynamics(limits.mechanism, q, velocity, acceleration)
    speed, rate = (np.linalg.norm(each, axis=1) for each in (tool_velocity, tool_acceleration))
    tool = np.column_stack([speed / limits.tool_speed, rate / limits.tool_acceleration])
    return np.concatenate([np.abs(torque) / limits.torque, tool], axis=1)


def second_dynamics(arm: Mechanism, q: Floats, velocity: Floats, acceleration: Floats) -> tuple[Floats, Floats, Floats]:
    """Torques of shape (n, n_joints), and velocity and acceleration of the tool's origin in the base frame, (n, 3)."""
    world = _World(arm, q, velocity, acceleration)
    last = arm.n_joints - 1
    torque = arm.rotors * acceleration + arm.viscous * velocity + arm.coulomb * np.sign(velocity)
    for body in range(arm.n_joints):
        turn, place = world.turns[body], world.point(body, arm.centres[body])
        _, rate = world.rates(body, place)
        force = arm.masses[body] * (rate - arm.gravity)
        inertia = turn @ arm.inertias[body] @ np.swapaxes(turn, 1, 2)
        spin, twist = world.spins[body + 1], world.twists[body + 1]
        moment = _times(inertia, twist) + np.cross(spin, _times(inertia, spin))
        for joint in range(body + 1):
            axis = world.axes[joint]
            if arm.sliding[joint]:
                torque[:, joint] += (axis * force).sum(axis=1)
            else:
                arm_of_force = np.cross(place - world.origins[joint], force)
                torque[:, joint] += (axis * (arm_of_force + moment)).sum(axis=1)
    return torque, *world.rates(last, world.point(last, arm.tool[:3, 3]))


class _World:
    """Everything in the base frame: axes and origins of the joints, attitudes of the bodies, how they turn."""

    def __init__(self, arm: Mechanism, q: Floats, velocity: Floats, acceleration: Floats) -> None:
        self.velocity, self.acceleration, self.sliding = velocity, acceleration, arm.sliding.astype(bool)
        pose = np.tile(np.eye(4), (len(q), 1, 1))
        self.axes, self.origins, self.turns, self.places = [], [], [], []
        zero = np.zeros((len(q), 3))
        self.spins, self.twists = [zero], [zero]
        for joint in range(arm.n_joints):
            pose = pose @ arm.origins[joint]
            self.axes.append(pose[:, :3, 2])
            self.origins.append(pose[:, :3, 3])
            pose = pose @ _moved(q[:, joint], bool(self.sliding[joint]))
            self.turns.append(pose[:, :3, :3])
            self.places.append(pose[:, :3, 3])
            turning = 0.0 if self.sliding[joint] else 1.0
            along = turning * self.axes[joint] * velocity[:, joint, None]
            further = turning * self.axes[joint] * acceleration[:, joint, None]
            self.twists.append(self.twists[joint] + further + np.cross(self.spins[joint], along))
            self.spins.append(self.spins[joint] + along)

    def point(self, body: int, place: Floats) -> Floats:
        """Place of a point of a body, shape (n, 3)."""
        return self.places[body] + self.turns[body] @ place

    def rates(self, body: int, place: Floats) -> tuple[Floats, Floats]:
        """Velocity and acceleration of the point of a body that is at a place, each a sum over the joints before it."""
        speed = self._along(body, place, -1)
        rate = np.zeros_like(speed)
        for joint in range(body + 1):
            axis, moved = self.axes[joint], self.velocity[:, joint, None]
            change = np.cross(self.spins[joint], axis)
            if self.sliding[joint]:
                rate += axis * self.acceleration[:, joint, None] + change * moved
                continue
            reach = place - self.origins[joint]
            rate += np.cross(axis, reach) * self.acceleration[:, joint, None] + np.cross(change, reach) * moved
            rate += np.cross(axis, self._along(body, place, joint)) * moved
        return speed, rate

    def _along(self, body: int, place: Floats, joint: int) -> Floats:
        """Velocity of a point relative to the origin of a joint's axis, as seen from the base; of -1 the base's."""
        result = np.zeros_like(place)
        reference = None if joint < 0 else self.origins[joint]
        for k in range(body + 1):
            moved, axis = self.velocity[:, k, None], self.axes[k]
            result += (axis if self.sliding[k] else np.cross(axis, place - self.origins[k])) * moved
            if reference is not None and k < joint:
                result -= (axis if self.sliding[k] else np.cross(axis, reference - self.origins[k])) * moved
        return result


def _moved(q: Floats, sliding: bool) -> Floats:
    result = np.tile(np.eye(4), (len(q), 1, 1))
    if sliding:
        result[:, 2, 3] = q
        return result
    result[:, 0, 0] = result[:, 1, 1] = np.cos(q)
    result[:, 1, 0] = np.sin(q)
    result[:, 0, 1] = -np.sin(q)
    return result


def _times(matrices: Floats, vectors: Floats) -> Floats:
    return np.einsum("nij,nj->ni", matrices, vectors)
