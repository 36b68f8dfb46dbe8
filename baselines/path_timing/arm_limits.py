"""Limits of torque and of the tool along a path, as TOPP-RA's linear constraints on path acceleration and speed.

Along q(s) with path acceleration u and squared path speed x a torque is a u + b x + c, and so is, without c, the tool's
acceleration; its speed squared is x times that of a run at unit path speed. The tool's acceleration lies in the plane
of its two parts, where a polygon inside the circle of the limit stands for it. Friction by speed takes its speed from
the timing before; dry friction where a joint turns round counts in both directions. What gridpoints miss the judge
finds, and the limits are tightened by as much.

References
----------
H. Pham, Q.-C. Pham, A new approach to time-optimal path parameterization based on reachability analysis, IEEE
Transactions on Robotics 34(3), 2018, section III.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from toppra import constraint
from toppra.constraint.linear_constraint import canlinear_colloc_to_interpolate

from study.arm import ArmLimits
from study.arm_findings import enclosed
from study.mechanism import Mechanism
from study.problem import Floats
from study.tolerances import TOLERANCE
from study.trajectory import Trajectory

SIDES = 48
"""Sides of the polygon in the circle; it gives up 0.2 % of the limit at most."""

TRIES, MORE = 4, 1e-4
"""Timings along one path, each with limits tightened by the excess of the one before and a little more."""

SpeedLaw = tuple[Trajectory, Floats]
"""A motion along a path, and its path speeds at the gridpoints."""


class ArmConstraint(constraint.LinearConstraint):  # type: ignore[misc]  # toppra has no types
    """Limits of an arm as TOPP-RA wants to see them.

    Parameters
    ----------
    limits : ArmLimits
    speeds : array of shape (n_gridpoints,), optional
        Path speeds at which friction by speed is taken.
    """

    def __init__(self, limits: ArmLimits, speeds: Floats | None = None) -> None:
        super().__init__()
        self.identical = True
        self._limits, self._speeds = limits, speeds

    def compute_constraint_params(self, path: Callable[..., Floats], gridpoints: Floats) -> tuple[object, ...]:
        """Coefficients at the gridpoints, and of each one at the end of its step too."""
        limits, arm = self._limits, smooth(self._limits.mechanism)
        q, slope, bend = (path(gridpoints, order) for order in range(3))
        held = arm.torque(q, 0 * q, 0 * q)
        bounded = np.isfinite(limits.torque)
        first, second = arm.torque(q, 0 * q, slope) - held, arm.torque(q, slope, bend) - held
        rubbing = friction(limits.mechanism, slope, self._speeds)
        both = [(sign * first, sign * second, sign * (held + rub)) for sign, rub in zip((1, -1), rubbing, strict=True)]
        a, b, c = (np.concatenate([row[k][:, bounded] for row in both], axis=1) for k in range(3))
        tool = (arm.tool_rates(q, 0 * q, slope)[1], arm.tool_rates(q, slope, bend)[1])
        if np.isfinite(limits.tool_acceleration):
            around = _in_plane(*tool)
            a, b = (np.concatenate([part, more], axis=1) for part, more in zip((a, b), around, strict=True))
            c = np.concatenate([c, np.zeros_like(around[0])], axis=1)
        bound = np.tile(limits.torque[bounded], 2)
        bound = np.append(bound, np.full(a.shape[1] - len(bound), limits.tool_acceleration * np.cos(np.pi / SIDES)))
        speed = (arm.tool_rates(q, slope, 0 * q)[0] ** 2).sum(axis=1)
        with np.errstate(divide="ignore"):
            most = np.minimum(limits.tool_speed**2 / speed, 1e18)
        squares = np.stack([np.zeros_like(most), most], axis=1)
        if not len(bound):
            return None, None, None, None, None, None, squares
        rows = np.eye(len(bound))
        twice = canlinear_colloc_to_interpolate(a, b, c, rows, bound, None, None, gridpoints, identical=True)
        return (*twice[:5], None, squares)


def _in_plane(first: Floats, second: Floats) -> tuple[Floats, Floats]:
    """Parts of two vectors, shape (n, 3), along the normals of a polygon in their plane, both of shape (n, SIDES)."""
    tiny = np.finfo(float).tiny
    x = second / np.maximum(np.linalg.norm(second, axis=1, keepdims=True), tiny)
    x = np.where(np.linalg.norm(x, axis=1, keepdims=True) > 0.5, x, [1.0, 0.0, 0.0])
    across = first - (first * x).sum(axis=1, keepdims=True) * x
    y = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), tiny)
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    parts = [
        np.outer((each * x).sum(axis=1), np.cos(angle)) + np.outer((each * y).sum(axis=1), np.sin(angle))
        for each in (first, second)
    ]
    return parts[0], parts[1]


def smooth(mechanism: Mechanism) -> Mechanism:
    """The same arm without friction."""
    nothing = np.zeros(mechanism.n_joints)
    return replace(mechanism, viscous=nothing, coulomb=nothing)


def friction(mechanism: Mechanism, slope: Floats, speeds: Floats | None) -> tuple[Floats, Floats]:
    """Highest and lowest friction near gridpoints, both of shape (n_gridpoints, n_joints), N m or N."""
    turning = mechanism.viscous * (0.0 if speeds is None else slope * speeds[:, None])
    signs = np.sign(slope)
    near = np.stack([np.append(signs[:1], signs[:-1], axis=0), signs, np.append(signs[1:], signs[-1:], axis=0)])
    return turning + mechanism.coulomb * near.max(axis=0), turning + mechanism.coulomb * near.min(axis=0)


def held(limits: ArmLimits, drive: Callable[[ArmConstraint], SpeedLaw | None]) -> Trajectory | None:
    """Time a path within limits of an arm; the last timing where none is proved to keep them, None where there is none.

    Parameters
    ----------
    limits : ArmLimits
    drive : callable
        Times the path within a constraint.
    """
    motion: Trajectory | None = None
    tightened, speeds = limits, None
    settling = 2 if limits.mechanism.viscous.any() else 0
    for attempt in range(settling + TRIES):
        law = drive(ArmConstraint(tightened, speeds))
        if law is None:
            return motion
        motion, speeds = law
        shares = enclosed(limits, motion).highest
        if shares.max() <= 1 + TOLERANCE:
            return motion
        if attempt < settling:
            continue
        over = np.where(shares > 1, shares * (1 + MORE), 1.0)
        tightened = ArmLimits(
            limits.mechanism,
            tightened.torque / over[:-2],
            tightened.tool_speed / over[-2],
            tightened.tool_acceleration / over[-1],
        )
    return motion
