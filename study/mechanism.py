"""An arm with masses: the torque that a motion asks of every joint, and how fast its tool moves.

Every joint turns about or slides along the z axis of its own frame, which is fixed to the joint before it. The same recursion
serves single instants and whole intervals of time: its numbers are the models of `study.taylor`.

References
----------
J. Y. S. Luh, M. W. Walker, R. P. C. Paul, On-line computational scheme for mechanical manipulators, J. Dyn. Syst. Meas.
Control 102(2), 1980: the recursive Newton-Euler method.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from study.arrays import Floats, frozen_array
from study.errors import StudyError
from study.taylor import Model, cross, sine_cosine, stacked

STANDARD_GRAVITY = (0.0, 0.0, -9.80665)
"""Free fall where z points up, m/s^2."""


class Swing(NamedTuple):
    """Demands of a motion on the arm, as models: torque of shape (n_joints, n), N m or N, and the tool's rates (3, n)."""

    torque: Model
    velocity: Model
    acceleration: Model


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Bodies on a chain of joints, each body in the frame of the joint that carries it, which moves with the joint.

    Attributes
    ----------
    origins : array of shape (n_joints, 4, 4), m
        From the frame of the joint before, the base's for the first, to the joint's at position zero.
    sliding : array of shape (n_joints,)
        1 for a joint that slides along z, 0 for one that turns about it.
    masses : array of shape (n_joints,), kg
    centres : array of shape (n_joints, 3), m
        Centres of mass.
    inertias : array of shape (n_joints, 3, 3), kg m^2
        About the centres of mass.
    rotors : array of shape (n_joints,), kg m^2 or kg
        Inertia of the drive as felt at the joint.
    viscous : array of shape (n_joints,), N m s/rad or N s/m
    coulomb : array of shape (n_joints,), N m or N
        Friction by speed, and against the direction whatever the speed.
    gravity : array of shape (3,), m/s^2
        In the base frame.
    tool : array of shape (4, 4), m
        From the last joint's frame to the tool's.

    Raises
    ------
    StudyError
        If shapes disagree, a mass or a friction is negative, or a number is infinite.
    """

    origins: Floats
    sliding: Floats
    masses: Floats
    centres: Floats
    inertias: Floats
    rotors: Floats
    viscous: Floats
    coulomb: Floats
    gravity: Floats = field(default_factory=lambda: np.array(STANDARD_GRAVITY))
    tool: Floats = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        n = len(self.origins)
        shapes = {"origins": (n, 4, 4), "centres": (n, 3), "inertias": (n, 3, 3), "gravity": (3,), "tool": (4, 4)}
        for name in (part.name for part in fields(self)):
            array = frozen_array(getattr(self, name), f"mechanism: {name}")
            if array.shape != shapes.get(name, (n,)) or not np.isfinite(array).all():
                raise StudyError(
                    f"mechanism: {name} must be finite, of shape {shapes.get(name, (n,))}, got {array.shape}"
                )
            if name in ("masses", "rotors", "viscous", "coulomb") and (array < 0).any():
                raise StudyError(f"mechanism: {name} of joint {int(np.argmax(array < 0)) + 1} must not be negative")
            object.__setattr__(self, name, array)

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self.origins)

    @property
    def heavy(self) -> bool:
        """Whether any part has a mass, so that torques mean something."""
        return bool(self.masses.any() or self.rotors.any() or self.inertias.any())

    def carrying(self, mass: float, place: ArrayLike = (0.0, 0.0, 0.0)) -> Mechanism:
        """Hang a point mass, kg, at a place in the tool's frame, m."""
        at = self.tool[:3, :3] @ np.asarray(place, dtype=float) + self.tool[:3, 3]
        total = self.masses[-1] + mass
        centre = (self.masses[-1] * self.centres[-1] + mass * at) / (total or 1.0)
        inertia = self.inertias[-1].copy()
        for part, where in ((self.masses[-1], self.centres[-1]), (mass, at)):
            inertia += steiner(part, where - centre)
        last = [np.append(kept[:-1], new[None], axis=0) for kept, new in
                ((self.masses, np.array(total)), (self.centres, centre), (self.inertias, inertia))]  # fmt: skip
        return replace(self, masses=last[0], centres=last[1], inertias=last[2])

    def torque(self, q: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> Floats:
        """Inverse dynamics at instants: arrays of shape (n, n_joints) to torques of the same shape, N m or N."""
        rates = [np.atleast_2d(np.asarray(rate, dtype=float)) for rate in (q, velocity, acceleration)]
        swing = self.swing(*(Model(rate.T[None], np.zeros(rate.T.shape)) for rate in np.broadcast_arrays(*rates)))
        return swing.torque.poly[0].T

    def tool_rates(self, q: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> tuple[Floats, Floats]:
        """Velocity and acceleration of the tool's origin at instants, in its own axes, each of shape (n, 3)."""
        rates = [np.atleast_2d(np.asarray(rate, dtype=float)) for rate in (q, velocity, acceleration)]
        swing = self.swing(*(Model(rate.T[None], np.zeros(rate.T.shape)) for rate in np.broadcast_arrays(*rates)))
        return swing.velocity.poly[0].T, swing.acceleration.poly[0].T

    def swing(self, q: Model, velocity: Model, acceleration: Model) -> Swing:
        """Inverse dynamics and the tool's rates over intervals of time.

        Parameters
        ----------
        q, velocity, acceleration : Model of shape (n_joints, n)
            Positions and their derivatives by time.
        """
        nothing = q[[0, 0, 0]] * 0.0
        gravity = Model(nothing.poly.copy(), nothing.rest)
        gravity.poly[0] = self.gravity[:, None]
        frame = _Frame(nothing, nothing, nothing, nothing, gravity)
        turns, forces, moments = [], [], []
        for joint in range(self.n_joints):
            frame, turn = self._outward(frame, joint, q[joint], velocity[joint], acceleration[joint])
            force, moment = self._body(frame, joint)
            turns.append(turn)
            forces.append(force)
            moments.append(moment)
        speed, rate = frame.at(self.tool[:3, 3])
        torque = self._inward(turns, forces, moments, q)
        drives = torque + acceleration * self.rotors[:, None] + velocity * self.viscous[:, None]
        return Swing(drives + against(velocity) * self.coulomb[:, None], speed, rate)

    def _outward(
        self, frame: _Frame, joint: int, q: Model, velocity: Model, acceleration: Model
    ) -> tuple[_Frame, tuple[Model, Model] | None]:
        """Rates of a joint's frame in its own axes, and sine and cosine of its angle where it turns."""
        origin = self.origins[joint]
        speed, rate = frame.at(origin[:3, 3])
        spin, twist, speed, rate, gravity = (
            each.mapped(origin[:3, :3].T) for each in (frame.spin, frame.twist, speed, rate, frame.gravity)
        )
        if self.sliding[joint]:
            out = _upwards(q)
            carried, along = cross(spin, out), cross(spin, _upwards(velocity))
            rate = rate + cross(twist, out) + cross(spin, carried) + along * 2.0 + _upwards(acceleration)
            return _Frame(spin, twist, speed + carried + _upwards(velocity), rate, gravity), None
        sine, cosine = sine_cosine(q)
        spin, twist, speed, rate, gravity = (
            _turned(each, sine * -1.0, cosine) for each in (spin, twist, speed, rate, gravity)
        )
        twist = twist + cross(spin, _upwards(velocity)) + _upwards(acceleration)
        return _Frame(spin + _upwards(velocity), twist, speed, rate, gravity), (sine, cosine)

    def _body(self, frame: _Frame, joint: int) -> tuple[Model, Model]:
        """Force and moment about the frame's origin that move a body against its weight."""
        centre, inertia = self.centres[joint], self.inertias[joint]
        force = (frame.at(centre)[1] - frame.gravity) * float(self.masses[joint])
        moment = frame.twist.mapped(inertia) + cross(frame.spin, frame.spin.mapped(inertia))
        return force, moment + force.mapped(skew(centre))

    def _inward(
        self, turns: list[tuple[Model, Model] | None], forces: list[Model], moments: list[Model], q: Model
    ) -> Model:
        """Torques or forces along the joints' axes, shape (n_joints, n), from the tool back to the base."""
        force, moment = forces[-1] * 0.0, moments[-1] * 0.0
        result = []
        for joint in reversed(range(self.n_joints)):
            force, moment = force + forces[joint], moment + moments[joint]
            result.append((force if self.sliding[joint] else moment)[2])
            turn, origin = turns[joint], self.origins[joint]
            if turn is None:
                moment = moment + cross(_upwards(q[joint]), force)
            else:
                force, moment = (_turned(each, *turn) for each in (force, moment))
            force, moment = (each.mapped(origin[:3, :3]) for each in (force, moment))
            moment = moment + force.mapped(skew(origin[:3, 3]))
        return stacked(result[::-1])


class _Frame(NamedTuple):
    """Rates of a frame in its own axes, shape (3, n): of turning, its change, of the origin, its change, and gravity."""

    spin: Model
    twist: Model
    speed: Model
    rate: Model
    gravity: Model

    def at(self, place: Floats) -> tuple[Model, Model]:
        """Velocity and acceleration of a point that is fixed in the frame."""
        arm = -skew(place)
        turning = self.spin.mapped(arm)
        return self.speed + turning, self.rate + self.twist.mapped(arm) + cross(self.spin, turning)


def skew(vector: Floats) -> Floats:
    """Matrix of the vector product from the left."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def steiner(mass: float, away: Floats) -> Floats:
    """Inertia of a point mass at a distance, shape (3, 3), kg m^2."""
    return mass * skew(away) @ skew(away).T


def _upwards(length: Model) -> Model:
    return stacked([length * 0.0, length * 0.0, length])


def _turned(vector: Model, sine: Model, cosine: Model) -> Model:
    """Turn vectors about z."""
    x, y, z = vector[0], vector[1], vector[2]
    return stacked([x * cosine - y * sine, x * sine + y * cosine, z])


STANDS = 1e-9
"""Share of a joint's largest speed below which its direction is rounding."""


def against(velocity: Model) -> Model:
    """Sign of velocities of shape (n_joints, n), and a rest of 1 where a joint turns round inside the interval.

    Where it only starts or ends there, the sign is that of its motion; where it stands, 0.
    """
    low, high = velocity.range()
    least = STANDS * np.maximum(np.abs(low), np.abs(high)).max(axis=1, keepdims=True, initial=0.0)
    backwards, forwards = (low < -least).astype(float), (high > least).astype(float)
    poly = np.zeros_like(velocity.poly)
    poly[0] = forwards - backwards
    return Model(poly, forwards * backwards)
