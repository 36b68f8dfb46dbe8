"""Which methods stand for their kind: the ones that figures, sentences and the index speak of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from study.analysis.methods import CURVE, FIXED_PATH, FREE_PATH
from study.analysis.rows import Entry

ROLES = ("search", "optimiser", "free", "fixed", "published")
"""Kinds of methods; the place is the number of the style in figures and legends."""

LEVEL = 1e-4
"""Times closer than this share count as level."""

PLAIN_SEARCHES = ("random-search", "lbfgsb")
"""Planners that take a seed but are no metaheuristics: blind sampling, and local descent from random starts."""

ROLE_NAMES = {
    "search": "best metaheuristic",
    "optimiser": "deterministic, same curve",
    "free": "deterministic, free path",
    "fixed": "deterministic, fixed path",
    "published": "published",
}


@dataclass(frozen=True)
class Featured:
    """The best entry of every kind on one case, None where there is none; infeasible only for want of a feasible one.

    Attributes
    ----------
    search : Entry, optional
        Lowest median of all searches on the case's curve.
    optimiser : Entry, optional
        Fastest deterministic method on the case's curve.
    free, fixed : Entry, optional
        Fastest deterministic method with a free path, and on a fixed one.
    published : Entry, optional
        Shortest total that the paper prints; one with segment durations, which can be judged, if there is any.
    velocity_only : bool
        Whether a joint has no acceleration limit, so that a motion off the curve may change its speed in an instant.
    """

    search: Entry | None
    optimiser: Entry | None
    free: Entry | None
    fixed: Entry | None
    published: Entry | None
    velocity_only: bool = False

    def present(self) -> list[tuple[int, str, Entry]]:
        """Style number, role and entry of every kind that there is."""
        pairs = [(style, role, getattr(self, role)) for style, role in enumerate(ROLES)]
        return [(style, role, entry) for style, role, entry in pairs if entry is not None]

    @property
    def reference(self) -> Entry | None:
        """What others are measured against: the deterministic optimum on the same curve, or else the best search."""
        candidates = [entry for entry in (self.optimiser, self.search) if entry is not None and entry.row.feasible]
        return candidates[0] if candidates else None


def is_metaheuristic(entry: Entry) -> bool:
    """Whether an entry stands for the methods that the papers propose."""
    return entry.row.kind == "search" and entry.planner not in PLAIN_SEARCHES


def featured(entries: Sequence[Entry], velocity_only: bool = False) -> Featured:
    """Pick the entry of every kind; entries are ranked, so the first of a kind is its best."""
    plain = [entry for entry in entries if entry.row.kind == "deterministic" and entry.standing != "inapplicable"]
    return Featured(
        search=_first(entry for entry in entries if is_metaheuristic(entry) and entry.path == CURVE),
        optimiser=_cheapest_of_level([entry for entry in plain if entry.path == CURVE]),
        free=_cheapest_of_level([entry for entry in plain if entry.path == FREE_PATH]),
        fixed=_cheapest_of_level([entry for entry in plain if entry.path == FIXED_PATH]),
        published=min(
            (entry for entry in entries if entry.row.kind == "published" and entry.row.joint is None),
            key=lambda entry: (entry.motion is None, np.inf if entry.duration is None else entry.duration),
            default=None,
        ),
        velocity_only=velocity_only,
    )


def _cheapest_of_level(entries: Sequence[Entry]) -> Entry | None:
    """First entry, or one that is level with it and needs fewer evaluations, then by name.

    Wall times would decide otherwise from run to run.
    """
    first = _first(entries)
    if first is None or first.row.median is None:
        return first
    level = [
        one for one in entries if one.row.median is not None and one.row.median <= first.row.median * (1 + LEVEL / 10)
    ]
    return min(level, key=lambda one: (one.row.evaluations, one.label))


def _first(entries: Iterable[Entry]) -> Entry | None:
    return next(iter(entries), None)
