"""Limits of the whole arm, which no joint has alone: torques, and the speed and acceleration of the tool."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from study.arrays import Floats, frozen_array
from study.demands import Demand
from study.errors import StudyError, joint_error
from study.limits import LARGEST, OPTIONAL
from study.mechanism import Mechanism, Swing
from study.taylor import Model

TOOL = ("speed", "acceleration")


@dataclass(frozen=True, eq=False)
class ArmLimits:
    """Limits of torque and of the tool; infinity, or None, means no limit.

    Parameters
    ----------
    mechanism : Mechanism
    torque : array of shape (n_joints,), N m or N for a joint that slides, optional
        In either direction.
    tool_speed : float, m/s, optional
        Of the origin of the tool's frame.
    tool_acceleration : float, m/s^2, optional

    Raises
    ------
    StudyError
        If a limit is not positive, none is finite, or torques are limited of an arm without masses.
    """

    mechanism: Mechanism
    torque: Floats = OPTIONAL
    tool_speed: float = np.inf
    tool_acceleration: float = np.inf

    def __post_init__(self) -> None:
        if not isinstance(self.mechanism, Mechanism):
            raise StudyError(f"limits of an arm need a Mechanism, got a {type(self.mechanism).__name__}")
        n = self.mechanism.n_joints
        torque = frozen_array(np.inf if self.torque is None else self.torque, "torque limits")
        if torque.shape not in ((), (n,)):
            raise StudyError(f"torque limits must have one number for each of {n} joints, got {torque.size}")
        object.__setattr__(self, "torque", frozen_array(np.broadcast_to(torque, (n,)), "torque limits"))
        for joint, limit in enumerate(self.torque):
            if not limit >= 1 / LARGEST or LARGEST < limit < np.inf:
                raise joint_error("torque limit of {joint} must be positive, got {0}", joint, limit)
        for name in ("tool_speed", "tool_acceleration"):
            given = getattr(self, name)
            value = frozen_array(np.inf if given is None else given, name.replace("_", " "))
            if value.shape or not value >= 1 / LARGEST:
                raise StudyError(f"{name.replace('_', ' ')} must be one positive number, got {given}")
            object.__setattr__(self, name, float(value))
        if not self.demands:
            raise StudyError("limits of an arm: none of torque, tool speed and tool acceleration is limited")
        if Demand.TORQUE in self.demands and not self.mechanism.heavy:
            raise StudyError("torque limits need an arm with masses; its file states none")

    @property
    def demands(self) -> frozenset[Demand]:
        """Kinds of limits that are given."""
        given = {
            Demand.TORQUE: bool(np.isfinite(self.torque).any()),
            Demand.TOOL_SPEED: bool(np.isfinite(self.tool_speed)),
            Demand.TOOL_ACCELERATION: bool(np.isfinite(self.tool_acceleration)),
        }
        return frozenset(demand for demand, holds in given.items() if holds)

    @property
    def forbids_steps(self) -> bool:
        """Whether velocities may not step: the torque would be infinite, or the tool's acceleration."""
        return bool(self.demands & {Demand.TORQUE, Demand.TOOL_ACCELERATION})

    def names(self, joints: Sequence[str]) -> list[str]:
        """Names of the shares of `shares`, in words for a sentence."""
        return [*(f"torque of {joint}" for joint in joints), "tool speed", "tool acceleration"]

    def shares(self, swing: Swing) -> tuple[Floats, Floats, Floats]:
        """Enclose the largest share of every limit in use, by interval.

        Returns
        -------
        lowest, places, highest : arrays of shape (n_joints + 2, n)
            Torques by joint, the tool's speed and its acceleration: a share that is reached, where in the interval from -1
            to 1 that is, and one that is not exceeded.
        """
        low, high = swing.torque.range()
        squares = [_squared(rate) for rate in (swing.velocity, swing.acceleration)]
        tops = np.sqrt(np.maximum([square.range()[1] for square in squares], 0.0))
        reached = np.concatenate(
            [np.abs(swing.torque.values()), np.array([s.values() for s in squares]).swapaxes(0, 1)], 1
        )
        rests = np.concatenate([swing.torque.rest, [square.rest for square in squares]])
        sure = np.maximum(reached.max(axis=0) - rests, 0.0)
        sure[-2:] = np.sqrt(sure[-2:])
        limits = np.append(self.torque, [self.tool_speed, self.tool_acceleration])[:, None]
        return sure / limits, reached.argmax(axis=0) - 1.0, np.concatenate([np.maximum(high, -low), tops]) / limits

    def held(self, q: Floats) -> Floats:
        """Share of the torque limits that gravity alone uses at positions of shape (n, n_joints), of the same shape."""
        return np.abs(self.mechanism.torque(q, 0 * q, 0 * q)) / self.torque

    def check(self, waypoints: Floats, where: str) -> None:
        """Refuse waypoints, shape (n_waypoints, n_joints), of another arm, or at which the joints cannot hold the arm."""
        if waypoints.shape[1] != self.mechanism.n_joints:
            raise StudyError(
                f"{where}: the arm has {self.mechanism.n_joints} joints, the waypoints have {waypoints.shape[1]}"
            )
        held = self.held(waypoints)
        if (held > 1).any():
            row, joint = map(int, np.argwhere(held > 1)[0])
            said = (
                f"at waypoint {row + 1} gravity alone asks for {held[row, joint]:.3g} of the torque limit of {{joint}}"
            )
            raise joint_error(said, joint, where=where)

    def scaled(self, factor: float) -> ArmLimits:
        """Limits for motions `factor` times as slow: those of the tool slow down, torques stay as they are."""
        return ArmLimits(self.mechanism, self.torque, self.tool_speed / factor, self.tool_acceleration / factor**2)

    def widened(self, share: float) -> ArmLimits:
        """Limits that are wider by a share of themselves."""
        more = 1.0 + share
        return ArmLimits(self.mechanism, self.torque * more, self.tool_speed * more, self.tool_acceleration * more)


def _squared(vector: Model) -> Model:
    """Square of the length of vectors of shape (3, n)."""
    square = vector * vector
    return Model(square.poly.sum(axis=1), square.rest.sum(axis=0))
