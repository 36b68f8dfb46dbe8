"""Parts of the bench that measure the planner alone, each a table and sentences: `study bench --part NAME`."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace

from study.bench import planner_parts
from study.bench.arms import Answer, arm_rows
from study.bench.arms import summary as on_arms
from study.bench.planner_parts import Part, Told
from study.bench.torque import torque
from study.bench.torque_peers import torque_peers
from study.engine import VARIABLE, chosen
from study.errors import unknown


def measured(name: str, seed: int, told: Told) -> Part:
    """Measure a part, with compiled code from the start where numba is installed: nobody plans once to measure.

    Raises
    ------
    StudyError
        If there is no such part.
    """
    if name not in PARTS:
        raise unknown("part of the bench", name, PARTS)
    engine = os.environ.setdefault(VARIABLE, chosen())
    part = PARTS[name](seed, told)
    return replace(part, sentences=(*part.sentences, f"engine: {engine}; the variable {VARIABLE} chooses another"))


def arms(seed: int, told: Told) -> Part:
    """Both tiers and other packages on problems of real arms."""
    rows = arm_rows(seed, told)
    head = ("problem", "fast", "best", "best peer", "best / peer", "fast ms", "best ms", "peer ms", "path timing ms")
    lines = []
    for row in rows:
        peer, timing = f"{_seconds(row.peer)} {row.peer.name}", row.timing
        beside = "" if timing is None else f"{_cost(timing)} {timing.name}"
        costs = _cost(row.fast), _cost(row.best), _cost(row.peer)
        lines.append((row.problem, _seconds(row.fast), _seconds(row.best), peer, f"{row.ratio:.4f}", *costs, beside))
    return Part(f"Real arms, seed {seed}: durations, s, and processor time", head, tuple(lines), tuple(on_arms(rows)))


def _seconds(answer: Answer) -> str:
    return f"{answer.duration:.4f}"


def _cost(answer: Answer) -> str:
    return f"{answer.seconds * 1e3:.1f}"


PARTS: dict[str, Callable[[int, Told], Part]] = {
    "arms": arms,
    "dense": planner_parts.dense,
    "online": planner_parts.online,
    "pieces": planner_parts.pieces,
    "nlp": planner_parts.nlp,
    "ruckig": planner_parts.long_moves,
    "torque": torque,
    "torque-peers": torque_peers,
}
"""Parts by name."""
