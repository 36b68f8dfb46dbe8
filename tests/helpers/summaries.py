"""Summaries of methods with chosen durations, without any motion behind them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from study.analysis.featured import Featured
from study.analysis.methods import Kind, MethodSummary
from study.planning import Freedom, RunSettings, Status
from study.store.results import Cell, Result


def run_of(label: str, duration: float | None, seed: int = 0, **changes: Any) -> Result:
    """Result of a run that the judge passed with a duration, s, or that brought no motion."""
    verdict: Any = SimpleNamespace(duration=duration, feasible=True, reasons=(), violation=0.0, worst_ratio=1.0)
    parts: dict[str, Any] = {
        "cell": Cell("c", label.partition(":")[0], label, RunSettings("poly353", seed=seed)),
        "status": Status.FINISHED,
        "message": "",
        "motion": None,
        "verdict": None if duration is None else verdict,
        "durations": None,
        "evaluations": 2000,
        "iterations": 1,
        "history": np.empty((0, 2)),
        "details": {},
        "wall_time": 0.5,
    }
    return Result(**{**parts, **changes})


def method_of(
    kind: Kind,
    median: float,
    freedom: Freedom = Freedom.CURVE,
    best: float | None = None,
    label: str = "x",
    **changes: Any,
) -> MethodSummary:
    """Summary of three feasible runs with this median and best duration, s; `changes` are those of the runs."""
    first = median if best is None else best
    durations = (first, median, 2 * median - first)
    runs = tuple(run_of(label, duration, seed, **changes) for seed, duration in enumerate(durations))
    return MethodSummary("c", label, kind, freedom, results=runs)


def picked(
    search: MethodSummary | None,
    optimiser: MethodSummary | None,
    free: MethodSummary | None = None,
    fixed: MethodSummary | None = None,
    **others: Any,
) -> Featured:
    """Featured methods of a case without a published motion; `others` are further fields, such as `modern`."""
    return Featured(search, optimiser, free, fixed, None, **others)
