"""Serial chain with Denavit-Hartenberg parameters, and its forward kinematics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from study.errors import StudyError
from study.problem import Floats


@dataclass(frozen=True, eq=False)
class Robot:
    """Serial arm with Denavit-Hartenberg parameters.

    Attributes
    ----------
    name : str
    title : str
        One line for people.
    source : str
        Where its lengths come from.
    modified : bool
        Whether link parameters follow the modified convention: the twist and length of a row come before its joint.
    prismatic : bool array of shape (n_joints,)
    a, alpha, d, theta : arrays of shape (n_joints,), m and rad
        Link length and twist, and the constant parts of offset and angle; a joint's variable is added to `d` where the
        joint slides and to `theta` where it turns.
    range : array of shape (2, n_joints), rad or m
        Lowest and highest position; infinite where none is given.
    solver : str, optional
        Family of the closed-form inverse, a name in `study.robots.SOLVERS`.
    """

    name: str
    title: str
    source: str
    modified: bool
    prismatic: np.ndarray
    a: Floats
    alpha: Floats
    d: Floats
    theta: Floats
    range: Floats
    solver: str | None = None

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self.a)

    def frames(self, q: ArrayLike) -> Floats:
        """Forward kinematics of the base frame and every link's frame.

        Parameters
        ----------
        q : array of shape (n, n_joints), rad or m

        Returns
        -------
        array of shape (n, n_joints + 1, 4, 4)
            Homogeneous transforms into the base frame, lengths in m, the base itself first.

        Raises
        ------
        StudyError
            If the configurations have another number of joints than the arm.
        """
        configurations = np.atleast_2d(np.asarray(q, dtype=float))
        if configurations.ndim != 2 or configurations.shape[1] != self.n_joints:
            raise StudyError(
                f"robot {self.name!r}: configurations must have shape (n, {self.n_joints}), got {np.shape(q)}"
            )
        frames = np.empty((len(configurations), self.n_joints + 1, 4, 4))
        frames[:, 0] = np.eye(4)
        for joint, step in enumerate(np.moveaxis(self._steps(configurations), 1, 0)):
            frames[:, joint + 1] = frames[:, joint] @ step
        return frames

    def forward(self, q: ArrayLike) -> Floats:
        """Forward kinematics of the last frame: transforms of shape (n, 4, 4), lengths in m."""
        return self.frames(q)[:, -1]

    def _steps(self, q: Floats) -> Floats:
        """Transforms from every frame to the next, shape (n, n_joints, 4, 4)."""
        about_z = screw_z(self.theta + np.where(self.prismatic, 0.0, q), self.d + np.where(self.prismatic, q, 0.0))
        about_x = screw_x(self.alpha, self.a)
        return about_x @ about_z if self.modified else about_z @ about_x


def screw_z(angle: Floats, along: Floats) -> Floats:
    """Turn about z and slide along it; shape (..., 4, 4)."""
    return _screw(angle, along, (0, 1), 2)


def screw_x(angle: Floats, along: Floats) -> Floats:
    """Turn about x and slide along it; shape (..., 4, 4)."""
    return _screw(angle, along, (1, 2), 0)


def _screw(angle: Floats, along: Floats, plane: tuple[int, int], axis: int) -> Floats:
    transform = np.broadcast_to(np.eye(4), (*np.shape(angle), 4, 4)).copy()
    first, second = plane
    transform[..., first, first] = transform[..., second, second] = np.cos(angle)
    transform[..., second, first] = np.sin(angle)
    transform[..., first, second] = -np.sin(angle)
    transform[..., axis, 3] = along
    return transform


Solver = Callable[[Robot, Floats, Sequence[tuple[int, int, int]]], Floats]
"""A closed-form inverse: poses of shape (n, 4, 4) and the wanted branches to configurations (n, n_branches, n_joints),
NaN where there is none."""

SINGULAR = 1e-7
"""A sine or relative distance below which a solution is no longer determined."""


def wrapped(angles: Floats) -> Floats:
    """Bring angles into (-pi, pi], rad."""
    return np.pi - np.mod(np.pi - angles, 2.0 * np.pi)
