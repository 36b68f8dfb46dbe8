"""Shared by the tests: recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from rerun.chunk import RrdReader

from study.cases.library import Case
from study.curves import curve_named
from study.formulation import stretch
from study.judge import judge
from study.planning import RunSettings, Status
from study.problem import Floats
from study.store.results import Cell, Result
from study.trajectory import Motion, Trajectory


def result(
    case: Case, label: str, motion: Motion | None, seed: int = 0, history: Floats | None = None, message: str = ""
) -> Result:
    """A finished cell of a planner that is not installed; the judge's verdict is real."""
    settings = RunSettings(curve=case.curve, seed=seed)
    return Result(
        cell=Cell(case.name, "tester", label, settings),
        status=Status.FAILED if motion is None else Status.FINISHED,
        message=message,
        motion=motion,
        verdict=None if motion is None else judge(case.problem, motion),
        durations=None,
        evaluations=0 if history is None else int(history[-1, 0]),
        iterations=1,
        history=np.empty((0, 2)) if history is None else history,
        details={},
        wall_time=0.1,
    )


def on_curve(case: Case, durations: Floats, feasible: bool = True) -> Motion:
    """A motion on the case's curve, stretched until it just keeps the limits, or so short that it breaks them."""
    curve = curve_named(case.curve)
    factor = float(stretch(case.problem, curve, durations[None])[0])
    return curve.motion(case.problem.waypoints, durations * (factor if feasible else 0.9 * factor))


def stepping(case: Case) -> Trajectory:
    """Straight lines with steps in velocity, so that values on both sides of a knot differ."""
    steps = np.diff(case.problem.waypoints, axis=0)
    durations = 3.0 * np.abs(steps / case.problem.limits.velocity).max(axis=1)
    return Trajectory.from_pieces(
        durations, np.stack([case.problem.waypoints[:-1], steps / durations[:, None]], axis=1)
    )


def some_results(case: Case) -> list[Result]:
    even = np.ones(case.problem.n_segments)
    history = np.array([[10.0, np.inf], [20.0, 90.0], [30.0, 30.0], [50.0, 9.0]])
    uneven = on_curve(case, even + 0.3 * np.arange(len(even)))
    return [
        result(case, "pso:scaled,shared", on_curve(case, even), 0, history),
        result(case, "pso:scaled,shared", uneven, 1, history * [1.0, 1.1]),
        result(case, "hasty", on_curve(case, even, feasible=False)),
        result(case, "steps", stepping(case)),
        result(case, "helpless", None, message="gave | up"),
    ]


def chunks(path: Path, where: str, component: str) -> list[Any]:
    store = RrdReader(str(path)).store()
    return [c.to_record_batch() for c in store.stream().filter(content=where, components=component).to_chunks()]


def series(path: Path, where: str, timeline: str = "t") -> tuple[np.ndarray, np.ndarray]:
    """Times in whole units of the timeline and values, as they stand in the file."""
    (batch,) = chunks(path, where, "Scalars:scalars")
    times = batch.column(timeline).cast(pa.int64()).to_numpy()
    return times, batch.column("Scalars:scalars").flatten().to_numpy().reshape(len(times), -1)


def columns(path: Path) -> dict[tuple[str, str], Any]:
    """All column values of all entities, without the identities of rows and chunks."""
    found: dict[tuple[str, str], Any] = {}
    for chunk in RrdReader(str(path)).store().stream().to_chunks():
        batch = chunk.to_record_batch()
        for name in set(batch.schema.names) - {"rerun.controls.RowId"}:
            found[chunk.entity_path, name] = (
                batch.column(name).to_pylist()
                if name not in ("t",)
                else batch.column(name).cast(pa.int64()).to_pylist()
            )
    return found
