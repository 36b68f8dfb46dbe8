"""What the figures are made from, their styles and the arithmetic of their axes; no plotting here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.problem import Floats
from study.report.svg import PLACEHOLDER
from study.trajectory import Motion

INK, MUTED, GRID, BAND, PAPER = (PLACEHOLDER[name] for name in ("ink", "muted", "grid", "band", "paper"))
SERIES = tuple(PLACEHOLDER[f"s{k}"] for k in range(1, 7))
DASHES: tuple[Any, ...] = (
    "-",
    (0, (6, 2)),
    (0, (6, 2, 1.5, 2)),
    (0, (1.5, 1.5)),
    (0, (3, 1.5, 1, 1.5, 1, 1.5)),
    (0, (9, 3)),
)
MARKERS = ("o", "s", "^", "D", "X", "v")
RC: Any = {
    "svg.hashsalt": "time-optimal-study",
    "svg.fonttype": "none",
    "text.parse_math": False,
    "font.size": 12.0,
    "axes.titlesize": 12.0,
    "axes.labelsize": 12.0,
    "xtick.labelsize": 11.0,
    "ytick.labelsize": 11.0,
    "hatch.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "axes.axisbelow": True,
} | dict.fromkeys(
    ("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color", "axes.titlecolor"), INK
)
SAMPLES = 220


@dataclass(frozen=True, eq=False)
class Series:
    """A method's motion under the name and style it has in the legend."""

    label: str
    style: int
    motion: Motion


@dataclass(frozen=True, eq=False)
class Convergence:
    """Best feasible total time so far over the seeds of one search; arrays of shape (n_points,), s, NaN before any."""

    label: str
    style: int
    evaluations: Floats
    median: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True)
class Mark:
    """One method in the headline figure: its time over the reference's, and whether the judge accepts it."""

    role: int
    ratio: float
    feasible: bool
    best_ratio: float | None = None


@dataclass(frozen=True)
class HeadlineRow:
    """One case of the headline figure."""

    title: str
    marks: tuple[Mark, ...]


@dataclass(frozen=True)
class Bar:
    """One rung of the ladder figure: a time with what stands over its bar and at its end."""

    label: str
    value: str
    seconds: float
    hatch: str
    solid: bool


LANES = (-0.15, 0.0, -0.15, 0.16, 0.38)
"""Height of every role above its case's line, so that level methods do not hide one another."""

LABEL_ROOM = 74
"""What a label takes beside its mark, pixels."""


def crowded(row: HeadlineRow, mark: Mark, limits: tuple[float, float], width: float) -> bool:
    """Whether another mark stands where a label to the right of this one would go."""
    ratios = [one.ratio for one in row.marks if LANES[one.role] == LANES[mark.role] and one is not mark]
    scale = width / np.log(limits[1] / limits[0])
    return any(0 < np.log(ratio / mark.ratio) * scale < LABEL_ROOM for ratio in ratios)


def headline_range(rows: Sequence[HeadlineRow], width: float) -> tuple[float, float]:
    """Range of ratios with room for a label on either side."""
    ratios = [1.0, *(mark.ratio for row in rows for mark in row.marks)]
    low, high = np.log(min(ratios)), np.log(max(ratios))
    room = 74 / max(width - 148, 1) * max(high - low, 0.1)
    return float(np.exp(low - room)), float(np.exp(high + room))


TICKS = (1.0, 0.5, 2.0, 0.25, 5.0, 0.1, 20.0, 0.75, 3.0, 1.5, 10.0)
"""Ratios worth a tick, the most welcome first."""


def spaced_ticks(limits: tuple[float, float], width: float) -> list[float]:
    """Take ticks in their order of welcome as long as their labels have 52 pixels each."""
    apart = 52 / width * np.log(limits[1] / limits[0])
    shown: list[float] = []
    for ratio in TICKS:
        if limits[0] < ratio < limits[1] and all(abs(np.log(ratio / other)) > apart for other in shown):
            shown.append(ratio)
    return sorted(shown)


def sample_times(motion: Motion) -> Floats:
    """Times to draw at; both sides of every knot, where a profile may step, as long as there are few."""
    even = np.linspace(0.0, motion.duration, SAMPLES)
    inner = motion.knots[1:-1] if len(motion.knots) < SAMPLES else np.empty(0)
    return np.sort(np.concatenate([even, inner, inner * (1 - 1e-9)]))
