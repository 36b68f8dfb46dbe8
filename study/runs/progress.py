"""Progress reports of a running search; results and their number of evaluations are the same with and without."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from study.formulation import Objective, Penalty, Scaled
from study.planning import Meter
from study.problem import Floats

PERIOD = 0.25
"""Least time between two reports of one search, s."""


@dataclass(frozen=True, eq=False)
class Progress:
    """Progress of a search.

    Attributes
    ----------
    evaluations : int
        Of all joints so far.
    durations : array of shape (n_segments,), s
        What would be driven if the search ended now; of joints searched alone the longest of every segment.
    candidates : tuple of array of shape (n_candidates, n_segments), s
        The candidates evaluated last, for every joint begun so far where each is searched alone.
    """

    evaluations: int
    durations: Floats
    candidates: tuple[Floats, ...]


@dataclass
class _Reporter:
    """Gather what the meters of one run see, and tell it now and then."""

    tell: Callable[[Progress], None]
    seen: dict[Meter, tuple[Objective, Floats, Floats]] = field(default_factory=dict)
    last: float = -np.inf

    def __call__(self, meter: Meter, candidates: Floats) -> None:
        if meter.incumbent is None or not isinstance(meter.objective, Penalty | Scaled):
            return
        self.seen[meter] = meter.objective, meter.incumbent, candidates
        if time.monotonic() - self.last >= PERIOD:
            self.tell(self._progress())
            self.last = time.monotonic()

    def _progress(self) -> Progress:
        driven = [objective.durations(incumbent[None])[0] for objective, incumbent, _ in self.seen.values()]
        candidates = tuple(candidates.copy() for _, _, candidates in self.seen.values())
        return Progress(sum(meter.evaluations for meter in self.seen), np.max(driven, axis=0), candidates)


def reporter(tell: Callable[[Progress], None] | None) -> Callable[[Meter, Floats], None] | None:
    """Let every search of a run report a few times a second; nothing is done, and no time taken, without `tell`."""
    return None if tell is None else _Reporter(tell)
