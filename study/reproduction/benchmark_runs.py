"""Run one cell of a benchmark table: a search on a function, from every seed."""

from __future__ import annotations

import re
import time
import zlib
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from study.planning import Meter
from study.reproduction.convergence import arrived_at, settled
from study.reproduction.jobs import Record, RecordJob
from study.search.loop import minimise
from study.search.state import Box, Search
from study.testfunctions import Benchmark, benchmarks_of, formulas

POINTS = 80
RENAMED = ("velocity=VelocityUpdate(", "flight=Flight(")
"""Text of a search, now and when the committed verdicts were made; as without enumerations, the stream stays the same."""

WITHOUT_FLOOR = "without floor"


@dataclass(frozen=True)
class BenchmarkJob(RecordJob):
    """One search on one benchmark function.

    Attributes
    ----------
    paper : str
    function : str
        Label such as `F5`.
    form : str
        Reading of the function: `standard`, `as-printed`, or `without floor` for the step function.
    search : Search
    population, generations, seeds : int
    start : float, optional
        Half width of the box in which the search starts, where it is not the function's own.
    """

    paper: str
    function: str
    form: str
    search: Search[Any]
    population: int
    generations: int
    seeds: int
    start: float | None = None
    kind: ClassVar[str] = "benchmark"
    weight: ClassVar[float] = 3.0

    @property
    def subject(self) -> str:
        """Label of the function."""
        return self.function

    @property
    def benchmark(self) -> Benchmark:
        """The function itself."""
        if self.form != WITHOUT_FLOOR:
            return next(f for f in benchmarks_of(self.paper, self.form) if f.label == self.function)
        function = next(f for f in benchmarks_of(self.paper) if f.label == self.function)
        bare = formulas.step_without_floor
        minimiser = np.full(function.n_dimensions, -0.5)
        return replace(function, name="step-without-floor", formula=bare, minimiser=minimiser)

    def _stream(self) -> int:
        """Number of the random stream, by paper, function and search."""
        text = re.sub(r"<\w+\.\w+: ('[^']*')>", r"\1", repr((self.paper, self.function, self.search)))
        return zlib.crc32(text.replace(*RENAMED).encode())

    def run(self) -> Record:
        """Final values, generations until convergence and seconds of every seed, and the median curve."""
        function = self.benchmark
        box = Box(function.lower, function.upper)
        if self.start is not None:
            box = Box(*(np.full(function.n_dimensions, side * self.start) for side in (-1.0, 1.0)))
        finals, seconds, curves = [], [], []
        for seed in range(self.seeds):
            rng = np.random.default_rng([seed, self._stream()])
            meter = Meter(function.objective(rng), self.population * self.generations)
            begun = time.perf_counter()
            minimise(self.search, meter, box, self.population, rng)
            seconds.append(time.perf_counter() - begun)
            finals.append(meter.incumbent_value)
            curves.append(meter.history[:, 1])
        shown = thinned(self.generations)
        return {
            "finals": finals,
            "settled": settled(curves),
            "arrived": [arrived_at(curve) for curve in curves],
            "seconds": seconds,
            "generations": (shown + 1).tolist(),
            "curve": np.median(curves, axis=0)[shown].tolist(),
        }


def thinned(length: int) -> np.ndarray:
    """Indices of at most `POINTS` generations, denser at the start, the last one among them."""
    return np.unique(np.round(np.geomspace(1, length, POINTS)).astype(int)) - 1
