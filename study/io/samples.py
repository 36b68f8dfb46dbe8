"""Joint positions as a file gives them, with everything else that it says and what of it was not used."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from study.errors import StudyError
from study.problem import Floats

NANOSECONDS = 1_000_000_000
"""In a second."""

NUMBERED = re.compile(
    r"((actual|target|field|joints?|positions?|pos|q|qpos|axis|a|j)[ ._/]*)*[\[(]?\d+[\])]?", re.IGNORECASE
)
"""Names of columns that number the joints."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Rows of joint positions.

    Attributes
    ----------
    positions : array of shape (n_rows, n_joints), in the file's units
    names : tuple of str
        Of the joints; empty where the file gives none.
    si : bool
        Whether the file's format says that positions are rad and m.
    times : array of shape (n_rows,), s, optional
    velocities, accelerations : array of shape (n_rows, n_joints), optional
        In the file's units per second and second squared.
    notes : tuple of str
        One sentence for everything that was left out or taken in a way that could be taken otherwise.
    units : tuple of str
        Of the joints, rad, deg, m or mm, where the names of the file's columns say them; empty where they do not.
    """

    positions: Floats
    names: tuple[str, ...] = ()
    si: bool = False
    times: Floats | None = None
    velocities: Floats | None = None
    accelerations: Floats | None = None
    notes: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    @property
    def rates(self) -> list[Floats]:
        """Velocities and accelerations, as far as the file gives them in this order."""
        given = [self.velocities, self.accelerations if self.velocities is not None else None]
        return [rate for rate in given if rate is not None]

    @property
    def nanoseconds(self) -> NDArray[np.int64]:
        """Times to the nearest nanosecond, shape (n_rows,); `divmod(time, NANOSECONDS)` gives a ROS stamp's `sec` and `nanosec`.

        Raises
        ------
        StudyError
            If there are no times.
        """
        if self.times is None:
            raise StudyError("these samples have no times")
        return np.rint(self.times * NANOSECONDS).astype(np.int64)

    def of(self, names: Sequence[str], where: str) -> Samples:
        """Columns in the order of some joints; without names in the file, one column for each joint.

        Raises
        ------
        StudyError
            If a joint has no column, or the number of columns is another.
        """
        if not self.names:
            if self.positions.shape[1] != len(names):
                raise StudyError(f"{where} has {self.positions.shape[1]} columns of positions for {len(names)} joints")
            return self
        for name in names:
            if name not in self.names:
                raise StudyError(f"{where}: its columns are {', '.join(self.names)}; there is none for {name!r}")
        order = [self.names.index(name) for name in names]
        velocities, accelerations = (
            None if rate is None else rate[:, order] for rate in (self.velocities, self.accelerations)
        )
        return replace(
            self,
            positions=self.positions[:, order],
            names=tuple(names),
            velocities=velocities,
            accelerations=accelerations,
            units=tuple(self.units[k] for k in order) if self.units else (),
        )

    def numbered(self, known: Collection[str]) -> Samples:
        """The same without names, with a note, where the columns are only numbered and no joint has such a name."""
        if not self.names or set(self.names) & set(known) or not all(NUMBERED.fullmatch(name) for name in self.names):
            return self
        first, last = self.names[0], self.names[-1]
        return replace(self, names=()).noting(
            f"columns {first!r} to {last!r} are numbered, not named, and were taken in their order"
        )

    def noting(self, *notes: str) -> Samples:
        """The same with further notes."""
        return replace(self, notes=(*self.notes, *notes))

    def scaled(self, factors: Floats) -> Samples:
        """The same in rad and m; factors of shape (n_joints,) from the file's units, which messages need not."""
        if self.si:
            return self
        velocities, accelerations = (
            None if rate is None else rate * factors for rate in (self.velocities, self.accelerations)
        )
        return replace(
            self, positions=self.positions * factors, si=True, velocities=velocities, accelerations=accelerations
        )
