"""Run a stored search again from its seed and look on: what its populations were is not stored, because it need not be."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from study.cases.library import Case
from study.errors import StudyError
from study.planners.segment_times import SegmentTimePlanner, plan_segment_times
from study.problem import Floats
from study.registry import planner_named
from study.search.loop import minimise
from study.search.state import Box, Search
from study.store.results import Result


@dataclass(frozen=True, eq=False)
class Replay:
    """Every population of a search.

    Attributes
    ----------
    parts : tuple of str
        Joints that were searched alone, or one empty name where all were searched together.
    populations : tuple, one for every part, of tuple of array of shape (n_candidates, n_segments), s
        The durations that every generation proposed.
    values : tuple, one for every part, of tuple of array of shape (n_candidates,), s
        Their objective values.
    """

    parts: tuple[str, ...]
    populations: tuple[tuple[Floats, ...], ...]
    values: tuple[tuple[Floats, ...], ...]

    @property
    def generations(self) -> int:
        """Length of the longest part."""
        return max(len(part) for part in self.populations)

    def at(self, part: int, generation: int) -> Floats:
        """Population of a part at a generation, counted from 0; the last one where the part ended earlier."""
        return self.populations[part][min(generation, len(self.populations[part]) - 1)]

    def best(self, part: int, generation: int) -> Floats:
        """Best candidate of a part up to a generation, shape (n_segments,)."""
        values = [value.min() for value in self.values[part][: generation + 1]]
        first = int(np.argmin(values))
        return self.populations[part][first][int(self.values[part][first].argmin())]


@dataclass(frozen=True)
class _Watched:
    """A search that notes down every population it is told about."""

    search: Search[Any]
    populations: list[Floats] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> Any:
        return self.search.init(box, population, generations, rng)

    def ask(self, state: Any, rng: np.random.Generator) -> Any:
        return self.search.ask(state, rng)

    def tell(self, state: Any, values: Floats, rng: np.random.Generator) -> Any:
        self.populations.append(state.candidates.copy())
        self.values.append(values.copy())
        return self.search.tell(state, values, rng)


def replayed(case: Case, result: Result) -> Replay | None:
    """Search again exactly as a stored result was found; takes as long as the search took.

    Returns
    -------
    Replay or None
        None for a planner that has no populations, and where the search no longer ends at the stored durations to the
        last bit, because it or the case was changed since.
    """
    try:
        planner = planner_named(result.cell.planner)
    except StudyError:
        return None
    if not isinstance(planner, SegmentTimePlanner) or result.durations is None:
        return None
    watched: list[_Watched] = []

    def drive(*run: Any) -> object:
        watched.append(_Watched(planner.search))
        return partial(minimise, watched[-1])(*run)

    plan = plan_segment_times(drive, case.problem, result.cell.settings)
    if plan.durations is None or not np.array_equal(plan.durations, result.durations):
        return None
    together = result.cell.settings.synchronisation == "shared"
    return Replay(
        ("",) if together else tuple(case.problem.joint_names),
        tuple(tuple(each.populations) for each in watched),
        tuple(tuple(each.values) for each in watched),
    )
