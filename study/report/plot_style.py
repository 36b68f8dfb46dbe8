"""Plot data of the figures, their styles, the arithmetic of their axes, and SVG fit for a page; no plotting here."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from study.analysis.palette import DARK, LIGHT, SLOTS, rgb
from study.problem import Floats
from study.trajectory import Motion

SHADES = 2 * SLOTS
"""Colours that figures have: those of the palette, and a tint of each for bars beyond them."""

THEME = {
    "#010101": "ink",
    "#020202": "muted",
    "#030303": "grid",
    "#040404": "band",
    "#050505": "paper",
} | {f"#0a0a{k:02x}": f"s{k}" for k in range(1, SHADES + 1)}
"""Placeholder colours that a figure draws with, and the custom property of the style sheet that takes their place."""

PLACEHOLDER = {name: colour for colour, name in THEME.items()}

INK, MUTED, GRID, BAND, PAPER = (PLACEHOLDER[name] for name in ("ink", "muted", "grid", "band", "paper"))
SERIES = tuple(PLACEHOLDER[f"s{k}"] for k in range(1, SHADES + 1))
STROKES = 2 * (
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
MARKERS = 2 * ("o", "s", "^", "D", "X", "v", "P", "<", ">", "*", "h", "d")
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
QUANTITIES = ("position", "velocity", "acceleration", "jerk")
RATE_UNITS = ("", "/s", "/s²", "/s³")
OUT_OF_SIGHT = 0.3
"""Share of a limit; if every method uses less, the plot shows the motion and not the limit."""


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
    """One method in the headline figure: its name, its time over the reference's, and whether the judge accepts it."""

    role: int
    ratio: float
    feasible: bool
    best_ratio: float | None = None
    name: str = ""


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
    slot: int | None = None
    note: str = ""


def color_properties(dark: bool) -> str:
    """Custom properties of the style sheet for the colours of the methods."""
    colors = (rgb(slot, DARK if dark else LIGHT) for slot in range(SHADES))
    return " ".join(f"--s{k}: #{bytes(color).hex()};" for k, color in enumerate(colors, start=1))


LABEL_ROOM = 74
"""Width of a label beside its mark, pixels."""


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


def rate_top(limit: float, peaks: Sequence[float]) -> float:
    """Top of an axis for one rate of one joint: room for the limit where it is in sight, none for a peak that dwarfs the others."""
    highest = max(peaks)
    if not np.isfinite(limit):
        moving = [peak for peak in peaks if peak > 0]
        highest = min(max(moving), 4 * min(moving)) if moving else 1.0
    elif highest >= OUT_OF_SIGHT * limit:
        highest = max(limit, min(highest, 1.5 * limit))
    return 1.12 * highest or 1.0


def sample_times(motion: Motion) -> Floats:
    """Times to draw at; both sides of every knot, where a profile may step, as long as there are few."""
    even = np.linspace(0.0, motion.duration, SAMPLES)
    inner = motion.knots[1:-1] if len(motion.knots) < SAMPLES else np.empty(0)
    return np.sort(np.concatenate([even, inner, inner * (1 - 1e-9)]))


class Notes:
    """Texts that the marks of a figure show under the pointer, and the slots of their methods, which a legend switches."""

    def __init__(self) -> None:
        self._marks: list[str] = []

    def add(self, text: str = "", slot: int | None = None) -> str:
        """Take a mark's note; the id that the mark is to be drawn with."""
        shown = f' data-tip="{escape(text)}"' if text else ""
        self._marks.append("<g" + (f' class="k{slot}"' if slot is not None else "") + shown + ">")
        return f"mark-{len(self._marks) - 1}"

    def put(self, body: str) -> str:
        """Put the notes to the marks of a figure."""
        return re.sub(r'<g id="mark-(\d+)">', lambda match: self._marks[int(match[1])], body)


def themed(raw: str, key: str, title: str, description: str, notes: Notes | None = None) -> Markup:
    """Turn a stand-alone SVG file into an inline figure.

    Parameters
    ----------
    raw : str
        What the plotting library wrote.
    key : str
        Letters and digits; put before every id, so that figures on one page do not share any.
    title, description : str
        What a screen reader says; escaped here.
    notes : Notes, optional
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
    inside = re.sub(r' (?:d|x|y|transform|points)="[^"]*"', lambda match: NUMBER.sub(_short, match[0]), inside)
    inside = inside if notes is None else notes.put(inside)
    return Markup(opening + inside.strip())  # noqa: S704 - title and description are escaped above, the rest is plotted


NUMBER = re.compile(r"-?\d+\.\d{3,}")


def _short(number: re.Match[str]) -> str:
    """A coordinate to a hundredth of a pixel."""
    text = f"{float(number[0]):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _own_ids(body: str, key: str) -> str:
    used = set(re.findall(r'(?:url\(#|href="#)([^)"]+)', body))
    body = re.sub(
        r' id="([^"]+)"',
        lambda match: f' id="{key}-{match[1]}"' if match[1] in used else match[0] * match[1].startswith("mark-"),
        body,
    )
    return re.sub(r'(url\(#|href="#)', rf"\g<1>{key}-", body)
