"""Benchmark functions and their shifted and rotated forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from study.errors import StudyError
from study.problem import Floats

Formula = Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class Benchmark:
    """Benchmark function to be minimised in a box.

    Attributes
    ----------
    name : str
    label : str
        The paper's label, such as `F5`.
    formula : callable (n_points, n_dimensions) -> (n_points,)
    lower, upper : arrays of shape (n_dimensions,)
    minimum : float, optional
        Least value, without noise; None where there is none.
    minimiser : array of shape (n_dimensions,), optional
        One point where it is taken.
    noise : float
        Width of the uniform noise in [0, noise) added to every value.
    """

    name: str
    label: str
    formula: Formula
    lower: Floats
    upper: Floats
    minimum: float | None
    minimiser: Floats | None
    noise: float = 0.0

    @property
    def n_dimensions(self) -> int:
        """Number of dimensions."""
        return len(self.lower)

    def __call__(self, points: Floats, rng: np.random.Generator | None = None) -> Floats:
        """Evaluate a population.

        Parameters
        ----------
        points : array of shape (n_points, n_dimensions)
        rng : numpy.random.Generator, optional
            Source of the noise; a function with noise needs it.

        Returns
        -------
        array of shape (n_points,)

        Raises
        ------
        StudyError
            If the points have another dimension, or noise is wanted and no generator given.
        """
        points = np.asarray(points, dtype=float)
        if points.ndim != 2 or points.shape[1] != self.n_dimensions:
            raise StudyError(
                f"benchmark {self.name!r}: points must have shape (n_points, {self.n_dimensions}), got {points.shape}"
            )
        values = self.formula(points)
        if not self.noise:
            return values
        if rng is None:
            raise StudyError(f"benchmark {self.name!r} is noisy; pass a numpy Generator for its noise")
        return values + self.noise * rng.random(len(points))

    def objective(self, rng: np.random.Generator) -> Formula:
        """Function of the points alone, with its noise from a generator, for a meter to wrap."""
        return lambda points: self(points, rng)


def shifted(function: Benchmark, shift: Floats) -> Benchmark:
    """Move a function, so that a search gains nothing from the origin or from equal coordinates.

    Parameters
    ----------
    function : Benchmark
    shift : array of shape (n_dimensions,)
        How far its minimiser moves; differ it per coordinate, since a constant shift hides a bias to the diagonal.

    Raises
    ------
    StudyError
        If the shift has another length or carries the minimiser out of the box.
    """
    shift = np.asarray(shift, dtype=float)
    if shift.shape != function.lower.shape:
        raise StudyError(
            f"benchmark {function.name!r}: the shift needs {function.n_dimensions} numbers, got shape {shift.shape}"
        )
    minimiser = None if function.minimiser is None else function.minimiser + shift
    if minimiser is not None and ((minimiser < function.lower) | (minimiser > function.upper)).any():
        raise StudyError(
            f"benchmark {function.name!r}: the shift carries the minimiser out of the box; take a smaller one"
        )
    return replace(
        function,
        name=f"{function.name}, shifted",
        formula=lambda points: function.formula(points - shift),
        minimiser=minimiser,
    )


def rotated(function: Benchmark, matrix: Floats) -> Benchmark:
    """Turn a function about its minimiser, or about the centre of the box where it has none.

    Parameters
    ----------
    function : Benchmark
    matrix : array of shape (n_dimensions, n_dimensions)
        Orthogonal.

    Raises
    ------
    StudyError
        If the matrix has another shape or is not orthogonal.
    """
    matrix = np.asarray(matrix, dtype=float)
    n = function.n_dimensions
    if matrix.shape != (n, n) or not np.allclose(matrix @ matrix.T, np.eye(n), atol=1e-9):
        raise StudyError(
            f"benchmark {function.name!r}: a rotation needs an orthogonal {n} x {n} matrix, got {matrix.shape}"
        )
    pivot = 0.5 * (function.lower + function.upper) if function.minimiser is None else function.minimiser
    return replace(
        function,
        name=f"{function.name}, rotated",
        formula=lambda points: function.formula((points - pivot) @ matrix.T + pivot),
    )


def random_rotation(n_dimensions: int, rng: np.random.Generator) -> Floats:
    """Draw an orthogonal matrix uniformly, from the QR factors of a normal matrix."""
    q, r = np.linalg.qr(rng.standard_normal((n_dimensions, n_dimensions)))
    return q * np.sign(np.diag(r))
