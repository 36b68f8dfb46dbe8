"""Flat drawings that do not depend on time: bars of durations and curves of convergence, with their own axes.

The viewer draws a time series only on the timeline that is active, and its bar charts cannot name their bars; what is
to be seen at the first look is therefore drawn with lines and labels. One unit of a drawing is about one pixel.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr

from study.problem import Floats
from study.recording.stream import entity, method_part

Color = tuple[int, int, int]
Bounds = tuple[tuple[float, float], tuple[float, float]]
WHITE: Color = (255, 255, 255)
GREY: Color = (150, 150, 150)
FAINT: Color = (48, 48, 48)
BAR_WIDTH, BAR_PITCH = 640.0, 36.0
SCREEN = 960.0
"""Height that a tab has on a screen of 1920 by 1080; what is laid out for it keeps a unit a pixel there."""
LADDER_ROOM = 310.0
"""Height that the first look has for the ladder."""
PLOT = (1300.0, 640.0)
KEY_PITCH, KEY_COLUMNS = 250.0, 7
FEW_COLUMNS, FEW_PITCH = 3, 340.0
"""Columns of a key of few names, which has room for long ones."""
LETTER = 5.7
HEAD = 34.0
"""Height of a view's title, pixels."""
LINE = 22.0


@dataclass(frozen=True)
class Bar:
    """A bar to draw: its place in an entity path, its text, its length in s, and its colour."""

    name: str
    text: str
    seconds: float
    color: Color


def log_bars(stream: rr.RecordingStream, where: str, bars: Sequence[Bar], pitch: float = BAR_PITCH) -> None:
    """Draw labelled bars below one another, all from zero; `pitch` is what one of them takes of the height."""
    longest = max((bar.seconds for bar in bars), default=1.0)
    for place, bar in enumerate(bars):
        end, y = BAR_WIDTH * bar.seconds / longest, pitch * place
        path = entity(where, bar.name)
        radius = 0.42 * pitch
        strip = rr.LineStrips2D([[[radius, y], [max(end - radius, radius + 1), y]]], colors=bar.color, radii=radius)
        stream.log(path, strip, static=True)
        log_text(stream, path + "/text", (16.0, y), bar.text, WHITE)


def bars_pitch(count: int, room: float = SCREEN) -> float:
    """Distance at which so many bars find room, so that a unit stays a pixel."""
    return min(BAR_PITCH, room / (count + 1))


def bars_bounds(count: int, pitch: float = BAR_PITCH) -> Bounds:
    """Ranges of x and y that a drawing of so many bars fills, with room on the left for texts on smaller screens."""
    return (-60.0, BAR_WIDTH + 10.0), (-pitch, pitch * count)


@dataclass(frozen=True, eq=False)
class Line:
    """A curve to draw: its name, its points (n, 2) as log10 of effort and of gap, and its colour."""

    name: str
    points: Floats
    color: Color


@dataclass(frozen=True)
class EffortAxis:
    """Horizontal axis of a drawing of convergence: its name and the text of a power of ten."""

    name: str
    text: Callable[[float], str]


def log_curves(stream: rr.RecordingStream, where: str, lines: Sequence[Line], effort: EffortAxis) -> None:
    """Draw curves over two logarithmic axes, each named on the right."""
    low = np.min([line.points.min(axis=0) for line in lines], axis=0)
    low[1] = np.floor(low[1])
    high = np.maximum(np.max([line.points.max(axis=0) for line in lines], axis=0), low + 1.0)
    _log_axes(stream, where, low, high, effort)
    corners = [stairs(_on_paper(line.points, low, high)) for line in lines]
    heights = _spread(np.array([points[-1, 1] for points in corners]))
    for line, points, height in zip(lines, corners, heights, strict=True):
        path = entity(where, method_part(line.name))
        stream.log(path, rr.LineStrips2D([points], colors=line.color, radii=1.2), static=True)
        leader = [points[-1], [PLOT[0], points[-1, 1]], [PLOT[0] + 30.0, height]]
        faded = [channel // 2 for channel in line.color]
        stream.log(path + "/leader", rr.LineStrips2D([leader], colors=faded, radii=0.5), static=True)
        log_text(stream, path + "/name", (PLOT[0] + 36.0, height), line.name, line.color)


def curves_bounds(lines: int) -> Bounds:
    """Ranges of x and y that a drawing of so many curves fills."""
    return (-90.0, PLOT[0] + 260.0), (-50.0, max(PLOT[1], LINE * lines) + 70.0)


def log_key(
    stream: rr.RecordingStream, where: str, names: Sequence[tuple[str, Color]], columns: int = KEY_COLUMNS
) -> None:
    """Write rows of names, each in the colour of what it stands for."""
    for place, (name, color) in enumerate(names):
        row, column = divmod(place, columns)
        log_text(stream, entity(where, name), (_pitch(columns) * column, LINE * row), name, color)


def _pitch(columns: int) -> float:
    return FEW_PITCH if columns == FEW_COLUMNS else KEY_PITCH


def key_bounds(count: int, columns: int = KEY_COLUMNS) -> Bounds:
    """Ranges of x and y that so many names fill."""
    return (-20.0, _pitch(columns) * columns), (-0.7 * LINE, LINE * ((count - 1) // columns + 0.7))


def key_height(count: int, columns: int = KEY_COLUMNS) -> float:
    """Share of a tab's height that so many names need, with the head of their view."""
    low, high = key_bounds(count, columns)[1]
    return (high - low + HEAD) / SCREEN


def _on_paper(points: Floats, low: Floats, high: Floats) -> Floats:
    share = (points - low) / (high - low)
    return np.column_stack([share[:, 0] * PLOT[0], (1.0 - share[:, 1]) * PLOT[1]])


def stairs(points: Floats) -> Floats:
    """Keep every value until the next one comes."""
    steps = np.repeat(points, 2, axis=0)
    return np.column_stack([steps[1:, 0], steps[:-1, 1]])


def _spread(heights: Floats) -> Floats:
    """Move label heights apart to at least a line, in their order, and up again from the foot of the drawing."""
    order = np.argsort(heights, kind="stable")
    slots = LINE * np.arange(len(heights))
    down = np.maximum.accumulate(heights[order] - slots)
    foot = max(PLOT[1], float(slots[-1])) - slots[-1]
    placed = np.empty(len(heights))
    placed[order] = np.minimum(down, foot) + slots
    return placed


def _log_axes(stream: rr.RecordingStream, where: str, low: Floats, high: Floats, effort: EffortAxis) -> None:
    """Draw a grid with a line for every power of ten."""
    decades = [np.arange(np.ceil(low[k]), np.floor(high[k]) + 1) for k in range(2)]
    across = [_on_paper(np.array([[low[0], y], [high[0], y]]), low, high) for y in decades[1]]
    up = [_on_paper(np.array([[x, low[1]], [x, high[1]]]), low, high) for x in decades[0]]
    stream.log(entity(where, "_axes"), rr.LineStrips2D([*across, *up], colors=FAINT, radii=0.6), static=True)
    spots = [(-60.0, line[0, 1]) for line in across] + [(line[0, 0] - 20.0, PLOT[1] + 16.0) for line in up]
    texts = [f"{100 * 10.0**y:.6g} %" for y in decades[1]] + [effort.text(10.0**x) for x in decades[0]]
    for k, (spot, text) in enumerate(zip(spots, texts, strict=True)):
        log_text(stream, entity(where, "_axes", str(k)), spot, text, GREY)
    log_text(stream, entity(where, "_axes", "x"), (0.5 * PLOT[0] - 40.0, PLOT[1] + 44.0), effort.name, GREY)
    log_text(stream, entity(where, "_axes", "y"), (-60.0, -30.0), "above the best known time on this curve", GREY)


def log_text(stream: rr.RecordingStream, path: str, left: tuple[float, float], text: str, color: Color) -> None:
    """Write text that begins at a place; the viewer centres labels below a point, so the width is estimated."""
    spot = [left[0] + 0.5 * LETTER * len(text), left[1] - 0.5 * LINE]
    stream.log(path, rr.Points2D([spot], labels=[text], show_labels=True, colors=color, radii=0.0), static=True)
