"""Plot data of the figures, their styles, the arithmetic of their axes, and SVG fit for a page; no plotting here."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from study.analysis.palette import DARK, LIGHT, SLOTS
from study.problem import Floats
from study.trajectory import Motion

THEME = {
    "#010101": "ink",
    "#020202": "muted",
    "#030303": "grid",
    "#040404": "band",
    "#050505": "paper",
} | {f"#0a0a{k:02x}": f"s{k}" for k in range(1, SLOTS + 1)}
"""Placeholder colours that a figure draws with, and the custom property of the style sheet that takes their place."""

PLACEHOLDER = {name: colour for colour, name in THEME.items()}

INK, MUTED, GRID, BAND, PAPER = (PLACEHOLDER[name] for name in ("ink", "muted", "grid", "band", "paper"))
SERIES = tuple(PLACEHOLDER[f"s{k}"] for k in range(1, SLOTS + 1))
STROKES = (
    "",
    "8 3",
    "8 3 2 3",
    "2 2.5",
    "4 2 1.5 2 1.5 2",
    "13 4",
    "1.5 4",
    "5 2",
    "11 2 3 2",
    "3 3",
    "6 5",
    "14 3 1.5 3",
)
"""Dashes of a method's line by its slot, in pixels; a line without dashes is whole."""

DASHES: tuple[Any, ...] = tuple((0, tuple(float(n) / 1.6 for n in each.split())) if each else "-" for each in STROKES)
MARKERS = ("o", "s", "^", "D", "X", "v", "P", "<", ">", "*", "h", "d")
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


def color_properties(dark: bool) -> str:
    """Custom properties of the style sheet for the colours of the methods."""
    return " ".join(f"--s{k}: {color};" for k, color in enumerate(DARK if dark else LIGHT, start=1))


LANES = (0.0, 0.26, -0.16, 0.26, 0.42, 0.13, -0.16)
"""Height of every role above its case's line, so that level methods do not hide one another."""

LABEL_ROOM = 74
"""Width of a label beside its mark, pixels."""


def crowded(row: HeadlineRow, mark: Mark, limits: tuple[float, float], width: float) -> bool:
    """Tell if another mark stands in the place of a label to the right of this mark."""
    ratios = [other.ratio for other in row.marks if LANES[other.role] == LANES[mark.role] and other is not mark]
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


def themed(raw: str, key: str, title: str, description: str) -> Markup:
    """Turn a stand-alone SVG file into an inline figure.

    Parameters
    ----------
    raw : str
        What the plotting library wrote.
    key : str
        Letters and digits; put before every id, so that figures on one page do not share any.
    title, description : str
        What a screen reader says; escaped here.
    """
    body = raw[raw.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>\s*", "", body, flags=re.DOTALL)
    body = re.sub(r"<!--.*?-->\s*", "", body, flags=re.DOTALL)
    body = re.sub("|".join(THEME), lambda match: f"var(--{THEME[match[0]]})", body)
    body = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", body)
    view = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', body)
    width, height = (view[1], view[2]) if view else ("400", "300")
    opening = (
        f'<svg xmlns:xlink="http://www.w3.org/1999/xlink" xmlns="http://www.w3.org/2000/svg" '
        f'viewBox="0 0 {width} {height}" role="img" aria-labelledby="{key}-title {key}-desc" style="max-width:{float(width) * 1.25:.0f}px">'
        f'<title id="{key}-title">{escape(title)}</title><desc id="{key}-desc">{escape(description)}</desc>'
    )
    inside = _own_ids(body[body.index(">") + 1 :], key)
    return Markup(opening + inside.strip())  # noqa: S704 - title and description are escaped above, the rest is plotted


def _own_ids(body: str, key: str) -> str:
    used = set(re.findall(r'(?:url\(#|href="#)([^)"]+)', body))
    body = re.sub(r' id="([^"]+)"', lambda match: f' id="{key}-{match[1]}"' if match[1] in used else "", body)
    return re.sub(r'(url\(#|href="#)', rf"\g<1>{key}-", body)
