"""Golden sine algorithm (Gold-SA).

The coefficients x1 and x2 follow a golden-section search that takes one step after *every evaluation*, while positions
move once per generation: all candidates of a generation see the same incumbent and the same x1 and x2. The circulated
original works in the same two passes, so evaluating a generation in one call changes nothing; `tell` then walks through
the values in the order of the candidates, each compared with the best before it. The initial population takes no step.

References
----------
Woodworking paper, Eqs. (25)-(28), which shows the initial a and b only; Tanyildizi and Demir 2017.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from study.choices import Options
from study.problem import Floats
from study.search.bounds import BoundsRule, bounded_positions
from study.search.reading import PaperReading
from study.search.state import Box, State, evolved, uniform_population

TAU = (math.sqrt(5.0) - 1.0) / 2.0  # eq. (28)


@dataclass(frozen=True)
class Sections:
    """Interval (a, b) and the golden-section coefficients x1 and x2 in it."""

    a: float
    b: float
    x1: float
    x2: float

    @classmethod
    def of(cls, a: float, b: float) -> Sections:
        """Divide an interval as the original does."""
        return cls(a, b, x1=a + (1 - TAU) * (b - a), x2=a + TAU * (b - a))

    @classmethod
    def printed(cls, a: float, b: float) -> Sections:
        """Divide an interval as the woodworking paper prints it: x1 and x2 have changed places."""
        return cls(a, b, x1=a * (1 - TAU) + b * TAU, x2=a * TAU + b * (1 - TAU))  # eq. (26), (27)

    def after(self, values: Floats, best: float, rng: np.random.Generator) -> Sections:
        """Take one golden-section step per evaluation, in order; a collapsed interval is drawn anew around 0.

        A new best value shrinks the interval from the right, any other value from the left.

        Parameters
        ----------
        values : array of shape (n_candidates,)
        best : float
            Best value before them.
        rng : numpy.random.Generator
        """
        before = np.minimum.accumulate(np.concatenate([[best], values[:-1]]))
        a, b, x1, x2 = self.a, self.b, self.x1, self.x2
        for better in (values < before).tolist():
            if better:
                b, x2 = x2, x1
                x1 = a + (1 - TAU) * (b - a)
            else:
                a, x1 = x1, x2
                x2 = a + TAU * (b - a)
            if x1 == x2:
                fresh = Sections.of(-np.pi * rng.random(), np.pi * rng.random())
                a, b, x1, x2 = fresh.a, fresh.b, fresh.x1, fresh.x2
        return Sections(a, b, x1, x2)


def golden_angles(
    shape: tuple[int, ...], per_dimension: bool, linked: bool, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Draw R1 in (0, 2 pi) and R2 in (0, pi) of Eq. (25), one pair per candidate or per coordinate.

    Parameters
    ----------
    shape : tuple of two ints
        Shape of the population.
    per_dimension : bool
        One pair for every coordinate instead of every candidate.
    linked : bool
        Take R2 = R1 / 2, as the circulated original does.
    rng : numpy.random.Generator
    """
    pairs = shape if per_dimension else (shape[0], 1)
    r1 = 2 * np.pi * rng.random(pairs)
    return r1, r1 / 2 if linked else np.pi * rng.random(pairs)


@dataclass(frozen=True, eq=False)
class GoldState(State):
    """A population and the golden-section coefficients."""

    sections: Sections

    def stepped(self, values: Floats, rng: np.random.Generator) -> Sections:
        """Step the sections through the values, in order; the first population takes no step."""
        return self.sections.after(values, self.incumbent_value, rng) if self.generation else self.sections


@dataclass(frozen=True)
class GoldSA(Options):
    """Golden sine algorithm.

    Attributes
    ----------
    interval : tuple of two floats
        Initial a and b; the paper's Section 2.4.3.
    reading : PaperReading
        `standard`: x1 and x2 step after every evaluation (the original). `as-printed`: they keep the values of
        Eqs. (26), (27), since no update is printed.
    per_dimension : bool
        R1 and R2 per coordinate; per candidate in the original.
    linked : bool
        R2 = R1 / 2, as in the circulated original; the paper names two random numbers.
    bounds : BoundsRule
        A rule of `study.search.bounds`; `clip` in the original.

    Raises
    ------
    StudyError
        If there is no such reading.
    """

    interval: tuple[float, float] = (-np.pi, np.pi)
    reading: PaperReading = PaperReading.STANDARD
    per_dimension: bool = False
    linked: bool = False
    bounds: BoundsRule = BoundsRule.CLIP

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> GoldState:
        """Spread candidates uniformly."""
        x = uniform_population(box, population, rng)
        sections = Sections.printed if self.reading is PaperReading.AS_PRINTED else Sections.of
        return GoldState.new(box, x, generations, sections=sections(*self.interval))

    def ask(self, state: GoldState, rng: np.random.Generator) -> GoldState:
        """Move every candidate."""
        x, p, s = state.candidates, state.incumbent, state.sections
        r1, r2 = golden_angles(x.shape, self.per_dimension, self.linked, rng)
        x = x * np.abs(np.sin(r1)) - r2 * np.sin(r1) * np.abs(s.x1 * p - s.x2 * x)  # eq. (25)
        return evolved(state, candidates=bounded_positions(self.bounds, state.box, x))

    def tell(self, state: GoldState, values: Floats, rng: np.random.Generator) -> GoldState:
        """Remember the best and step the golden sections."""
        sections = state.sections if self.reading is PaperReading.AS_PRINTED else state.stepped(values, rng)
        return state.told(values, sections=sections)
