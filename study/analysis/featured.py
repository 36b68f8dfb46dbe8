"""Methods that stand for their kind: the ones that figures, sentences and the index speak of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from study.analysis.methods import Kind, MethodSummary, Standing
from study.planning import Freedom
from study.runs.selections import SOLVERS, YARDSTICKS

ROLE_NAMES = {
    "search": "best metaheuristic",
    "optimiser": "deterministic, same curve",
    "free": "deterministic, free path",
    "fixed": "deterministic, fixed path",
    "published": "published",
}
"""Roles are the fields of `Featured`; the place is the number of the style in figures and legends."""

LEVEL = 1e-4
"""Times closer than this share count as level."""


@dataclass(frozen=True)
class Featured:
    """Best method of every role on one case, None where there is none; infeasible only for want of a feasible one.

    Attributes
    ----------
    search : MethodSummary, optional
        Lowest median of all metaheuristics on the case's curve.
    optimiser : MethodSummary, optional
        Fastest deterministic method on the case's curve.
    free, fixed : MethodSummary, optional
        Fastest deterministic method with a free path, and on a fixed one.
    published : MethodSummary, optional
        Shortest total that the paper prints; one with segment durations, which can be judged, if there is any.
    velocity_only : bool
        Whether a joint has no acceleration limit, so that a motion off the curve may change its speed in an instant.
    """

    search: MethodSummary | None
    optimiser: MethodSummary | None
    free: MethodSummary | None
    fixed: MethodSummary | None
    published: MethodSummary | None
    velocity_only: bool = False

    def present(self) -> list[tuple[int, str, MethodSummary]]:
        """Style number, role and method of every role that is filled."""
        filled = [(style, role, getattr(self, role)) for style, role in enumerate(ROLE_NAMES)]
        return [(style, role, method) for style, role, method in filled if method is not None]

    @property
    def reference(self) -> MethodSummary | None:
        """Method that others are measured against: the optimum on the same curve, or else the best search."""
        candidates = [method for method in (self.optimiser, self.search) if method is not None and method.feasible]
        return candidates[0] if candidates else None


def is_metaheuristic(method: MethodSummary) -> bool:
    """Tell the methods that the papers propose from trivial and local searches."""
    return method.kind is Kind.SEARCH and method.planner not in (*YARDSTICKS, *SOLVERS)


def featured(methods: Sequence[MethodSummary], velocity_only: bool = False) -> Featured:
    """Pick the method of every role; methods are ranked, so the first of a kind is its best."""
    plain = [m for m in methods if m.kind is Kind.DETERMINISTIC and m.standing is not Standing.INAPPLICABLE]
    return Featured(
        search=_first(method for method in methods if is_metaheuristic(method) and method.freedom is Freedom.CURVE),
        optimiser=_cheapest_of_level([method for method in plain if method.freedom is Freedom.CURVE]),
        free=_cheapest_of_level([method for method in plain if method.freedom is Freedom.FREE]),
        fixed=_cheapest_of_level([method for method in plain if method.freedom is Freedom.PATH]),
        published=min(
            (method for method in methods if method.kind is Kind.PUBLISHED and method.joint is None),
            key=lambda method: (method.motion is None, np.inf if method.duration is None else method.duration),
            default=None,
        ),
        velocity_only=velocity_only,
    )


def _cheapest_of_level(methods: Sequence[MethodSummary]) -> MethodSummary | None:
    """First method, or one that is level with it and needs fewer evaluations, then by name.

    Wall times would decide otherwise from run to run.
    """
    first = _first(methods)
    if first is None or first.median is None:
        return first
    most = first.median * (1 + LEVEL / 10)
    level = [method for method in methods if method.median is not None and method.median <= most]
    return min(level, key=lambda method: (method.evaluations, method.label))


def _first(methods: Iterable[MethodSummary]) -> MethodSummary | None:
    return next(iter(methods), None)
