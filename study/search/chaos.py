"""Chaotic maps of the papers, their sequences, and initial populations made of them.

References
----------
Woodworking paper, Eq. (23); PUMA560 paper, Section 3.3.1; improved sparrow paper, Eqs. (16), (17).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from study.choices import Choice
from study.errors import unknown
from study.problem import Floats
from study.search.state import Box

N_BINS = 10


def logistic(x: Floats, a: float = 4.0) -> Floats:
    """One step of the logistic map (PUMA560 paper, Section 3.3.1); a = 4 is its full chaos."""
    return a * x * (1 - x)


def circle(x: Floats, a: float = 0.5, b: float = 0.2) -> Floats:
    """One step of the circle map (woodworking paper, Eq. (23))."""
    return np.mod(x + b - a / (2 * np.pi) * np.sin(2 * np.pi * x), 1)


def singer(x: Floats, a: float = 1.07) -> Floats:
    """One step of Singer's map (PUMA560 paper, Section 3.3.1); a = 1.07 is ours, the paper gives [0.9, 1.08].

    The paper's last coefficient, 13.3028275, is kept; elsewhere 13.302875 is found.
    """
    return a * (7.86 * x - 23.31 * x**2 + 28.75 * x**3 - 13.3028275 * x**4)


def tent(x: Floats) -> Floats:
    """One step of the tent map (sparrow paper, Eq. (16)); in binary arithmetic every orbit ends at exactly 0."""
    return np.where(x <= 0.5, 2 * x, 2 * (1 - x))


def sine_tent_cosine(x: Floats, r: float = 0.7) -> Floats:
    """One step of the composite map (PUMA560 paper, Section 3.3.1), with the paper's r."""
    tents = 2 * (1 - r) * np.where(x < 0.5, x, 1 - x)
    return np.cos(np.pi * (r * np.sin(np.pi * x) + tents - 0.5))


@dataclass(frozen=True)
class ChaosMap:
    """Chaotic map of [0, 1] to itself.

    Attributes
    ----------
    step : callable array -> array
    perturbed : bool
        Add a random number in [0, 1) divided by the sequence's length after each step, and wrap into [0, 1); this is
        how the sparrow paper, Eq. (17), keeps the tent map alive.
    """

    step: Callable[[Floats], Floats]
    perturbed: bool = False

    def sequences(self, start: Floats, length: int, rng: np.random.Generator) -> Floats:
        """Iterate independent sequences.

        Parameters
        ----------
        start : array of shape (n_sequences,)
            First numbers, in [0, 1]; they are part of the sequences.
        length : int
        rng : numpy.random.Generator
            Used by perturbed maps only.

        Returns
        -------
        array of shape (length, n_sequences)
        """
        numbers = np.empty((length, *start.shape))
        numbers[:1] = start
        for i in range(1, length):
            numbers[i] = self.step(numbers[i - 1])
            if self.perturbed:
                numbers[i] = np.mod(numbers[i] + rng.random(start.shape) / length, 1)  # sparrow paper, eq. (17)
        return numbers


MAPS: dict[str, ChaosMap] = {
    "logistic": ChaosMap(logistic),
    "circle": ChaosMap(circle),
    "singer": ChaosMap(singer),
    "tent": ChaosMap(tent),
    "perturbed-tent": ChaosMap(tent, perturbed=True),
    "sine-tent-cosine": ChaosMap(sine_tent_cosine),
}


def map_named(name: str) -> ChaosMap:
    """Chaotic map of a name.

    Raises
    ------
    StudyError
        If there is no such map.
    """
    if name not in MAPS:
        raise unknown("chaotic map", name, MAPS)
    return MAPS[name]


class Direction(Choice):
    """Direction of the chaotic sequences in an initial population."""

    DIMENSIONS = "dimensions"
    POPULATION = "population"


def chaotic_population(
    chaos: ChaosMap,
    box: Box,
    population: int,
    rng: np.random.Generator,
    along: Direction = Direction.POPULATION,
    rescale: bool = False,
) -> Floats:
    """Spread an initial population by chaotic sequences that start at random numbers.

    Parameters
    ----------
    chaos : ChaosMap
    box : Box
    population : int
    rng : numpy.random.Generator
    along : Direction
        `population`: one sequence per dimension, each candidate one step (woodworking and PUMA560 papers).
        `dimensions`: one sequence per candidate, each dimension one step (sparrow paper).
    rescale : bool
        Stretch every sequence so that its least number becomes 0 and its greatest 1, one way to read the x_min and
        x_max of the sparrow paper's Eq. (17).

    Returns
    -------
    array of shape (population, n_dimensions)

    Raises
    ------
    StudyError
        If there is no such direction.
    """
    shape = population, len(box.lower)
    along = Direction(along)
    length, n_sequences = shape if along is Direction.POPULATION else shape[::-1]
    numbers = chaos.sequences(rng.random(n_sequences), length, rng)
    if rescale:
        numbers = rescaled(numbers)
    return box.at(numbers if along is Direction.POPULATION else numbers.T)


def rescaled(numbers: Floats) -> Floats:
    """Stretch sequences, shape (length, n_sequences), to fill [0, 1]; a constant sequence becomes 0."""
    least = numbers.min(axis=0)
    spread = numbers.max(axis=0) - least
    return (numbers - least) / np.where(spread > 0, spread, 1.0)


def uniformity(values: Floats) -> float:
    """Chi-square of numbers in [0, 1] against the uniform distribution: ten equal bins, nine degrees of freedom.

    A value above 16.9 rejects uniformity at the 5 % level (for independent numbers, which an orbit is not).
    """
    counts, _ = np.histogram(values, bins=N_BINS, range=(0.0, 1.0))
    expected = np.size(values) / N_BINS
    return float(((counts - expected) ** 2).sum() / expected)
