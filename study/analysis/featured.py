"""Methods that stand for their kind: the ones that figures, sentences and the index speak of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from study.analysis.methods import Kind, MethodSummary, Standing
from study.planning import Freedom
from study.registry import is_foreign
from study.runs.selections import OF_NO_PAPER, SOLVERS, YARDSTICKS

ROLE_NAMES = {
    "search": "best of the papers' searches",
    "optimiser": "deterministic, same curve",
    "free": "deterministic, free path",
    "fixed": "deterministic, fixed path",
    "published": "published",
    "modern": "best modern search",
    "own": "the paper's own method",
}
"""Roles are the fields of `Featured`; the place is the number of the style in figures and legends."""

SEARCHES = ("own", "search", "modern")
"""Roles of searches, in the order in which tables and sentences name them."""

IN_ORDER = ("published", *SEARCHES, "optimiser", "fixed", "free")
"""Roles in the order of tables."""

LEVEL = 1e-4
"""Times closer than this share count as level."""


@dataclass(frozen=True)
class Featured:
    """Best method of every role on one case, None where there is none; infeasible only for want of a feasible one.

    Attributes
    ----------
    search : MethodSummary, optional
        Lowest median over all seeds of the searches that the papers propose or compare with, on the case's curve.
    optimiser : MethodSummary, optional
        Fastest deterministic method on the case's curve.
    free, fixed : MethodSummary, optional
        Fastest deterministic method with a free path, and on a fixed one.
    published : MethodSummary, optional
        Shortest total that the paper prints; one with segment durations, which can be judged, if there is any.
    modern : MethodSummary, optional
        The same of the searches of no paper, such as CMA-ES and L-SHADE.
    own : MethodSummary, optional
        The method that the case's own paper proposes, run as the paper runs it.
    velocity_only : bool
        Whether a joint has no acceleration limit, so that a motion off the curve may change its speed in an instant.
    flattery : float, optional
        Largest share by which the time of a search changes if one half of the seeds chooses it and the other tells its
        time; None with one seed.
    """

    search: MethodSummary | None
    optimiser: MethodSummary | None
    free: MethodSummary | None
    fixed: MethodSummary | None
    published: MethodSummary | None
    modern: MethodSummary | None = None
    own: MethodSummary | None = None
    velocity_only: bool = False
    flattery: float | None = None

    def present(self) -> list[tuple[int, str, MethodSummary]]:
        """Style number, role and method of every role that is filled."""
        filled = [(style, role, getattr(self, role)) for style, role in enumerate(ROLE_NAMES)]
        return [(style, role, method) for style, role, method in filled if method is not None]

    def distinct(self) -> list[tuple[int, str, MethodSummary]]:
        """Give the roles whose motions fit into one plot: without the paper's own method, and every method once."""
        several = [each for each in self.present() if each[1] != "own"]
        labels = [method.label for _, _, method in several]
        return [each for place, each in enumerate(several) if each[2].label not in labels[:place]]

    def on_the_curve(self) -> list[tuple[str, MethodSummary]]:
        """Name of the role and method of the searches and of the optimum, which answer the study's question."""
        roles = (*SEARCHES, "optimiser")
        return [(ROLE_NAMES[role], method) for role in roles if (method := getattr(self, role)) is not None]

    @property
    def reference(self) -> MethodSummary | None:
        """Method that others are measured against: the optimum on the same curve, or else the best search."""
        known = [method for method in (self.optimiser, self.search, self.modern) if method is not None]
        return next((method for method in known if method.feasible), None)

    def behind(self, method: MethodSummary) -> float | None:
        """Median over that of the reference, minus one; None for the reference itself, and where one has no feasible run."""
        known = self.reference
        if known is None or method is known or not (method.median and known.median):
            return None
        return method.median / known.median - 1.0


def is_metaheuristic(method: MethodSummary) -> bool:
    """Tell metaheuristics from trivial and local searches."""
    return method.kind is Kind.SEARCH and method.planner not in (*YARDSTICKS, *SOLVERS)


def is_modern(method: MethodSummary) -> bool:
    """Tell searches of no paper from those that the papers propose or compare with."""
    return is_metaheuristic(method) and (method.planner in OF_NO_PAPER or is_foreign(method.planner))


def group_of(method: MethodSummary, own: MethodSummary | None) -> str:
    """Group that a method belongs to: the paper's own, the papers' searches, modern ones, other searches, or its kind."""
    if method.kind is not Kind.SEARCH:
        return method.kind
    if own is not None and method.label == own.label:
        return ROLE_NAMES["own"]
    if is_modern(method):
        return "modern search"
    return "papers' search" if is_metaheuristic(method) else "trivial or local search"


def featured(methods: Sequence[MethodSummary], velocity_only: bool = False, own: str = "") -> Featured:
    """Pick the method of every role; methods are ranked, so the first of a kind is its best.

    Parameters
    ----------
    methods : sequence of MethodSummary
    velocity_only : bool
    own : str
        Label of the method of the case's own paper.
    """
    plain = [m for m in methods if m.kind is Kind.DETERMINISTIC and m.standing is not Standing.INAPPLICABLE]
    searches = [method for method in methods if is_metaheuristic(method) and method.freedom is Freedom.CURVE]
    groups = [[method for method in searches if is_modern(method) is modern] for modern in (False, True)]
    changes = [change for group in groups if (change := _choice_changes(group)) is not None]
    return Featured(
        search=_first(groups[0]),
        modern=_first(groups[1]),
        own=_first(method for method in searches if method.label == own),
        flattery=max(changes, default=None),
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


def _choice_changes(group: Sequence[MethodSummary]) -> float | None:
    """Share by which the best time changes if every second seed chooses the method and the other seeds tell its time.

    Each half chooses once and tells once; None where a half has no feasible run.
    """
    told: list[float] = []
    for half in (0, 1):
        chosen = min(group, key=lambda method: _median(method.durations_of(half)), default=None)
        told += chosen.durations_of(1 - half) if chosen else ()
    if not told or not group[0].median or len(group[0].results) < 2:
        return None
    return abs(float(np.median(told)) / group[0].median - 1.0)


def _median(durations: Sequence[float]) -> float:
    return float(np.median(durations)) if durations else np.inf


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
