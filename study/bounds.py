"""Lower bounds on the duration: interface of a bound, and its answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from study.errors import StudyError
from study.planning import Freedom, Planner, RunSettings, description, lacking
from study.problem import Demand, Problem


@dataclass(frozen=True)
class LowerBound:
    """Proved time that no motion of one kind undercuts.

    Attributes
    ----------
    value : float, s
    freedom : Freedom
        Kind of motion: any motion through the waypoints, or those on the settings' curve alone.
    message : str
        A remark.
    details : mapping of str to float
        Numbers worth keeping.

    Raises
    ------
    StudyError
        If the value is negative or not finite.
    """

    value: float
    freedom: Freedom
    message: str = ""
    details: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 0 <= self.value < np.inf:
            raise StudyError(f"a lower bound must be a finite time of at least 0 s, got {self.value:g} s")


class Bound(Protocol):
    """A proof of how short a motion can be at best; it has no motion to show, describes itself, and knows no chance."""

    @property
    def about(self) -> str:
        """One line that says how the proof works."""

    @property
    def freedom(self) -> Freedom:
        """Kind of motion that it holds for; `CURVE` takes the curve from the settings."""

    @property
    def knows(self) -> frozenset[Demand]:
        """Demands of a problem under which the proof holds."""

    def bound(self, problem: Problem, settings: RunSettings) -> LowerBound:
        """Prove a bound within the settings' time limit; some bound, be it 0, always holds."""


Method = Planner | Bound
"""Anything that stands in the tables under a registered name."""


def kind_of(method: Method) -> str:
    """Name the kind of a method, as tables show it."""
    if not isinstance(method, Planner):
        return "bound"
    return "search" if method.stochastic else "deterministic"


def is_stochastic(method: Method) -> bool:
    """Tell whether the seed matters, so that the runner repeats the method."""
    return isinstance(method, Planner) and method.stochastic


def undescribed_bound(bound: object) -> str:
    """Say in one sentence which part of the description of a bound is missing or wrong; empty where none is."""
    ways = {"a method `bound(problem, settings)`": not callable(getattr(bound, "bound", None))}
    return lacking("bound", ways | description(bound))
