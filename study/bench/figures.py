"""The figure of growth as inline SVG; lines differ by dash and marker, so that they read in black and white."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.axes import Axes

from study.bench.growth import LABELS, Point
from study.report.figures import sized, svg
from study.report.plot_style import DASHES, GRID, MARKERS, RC, SERIES

AXES = {"waypoints": "waypoints", "joints": "joints", "population": "candidates in one call"}


def styles(points: Sequence[Point]) -> dict[str, int]:
    """Number of the line style of every curve and engine."""
    return {name: i for i, name in enumerate(dict.fromkeys(label(point) for point in points))}


def label(point: Point) -> str:
    """Curve and engine."""
    return f"{LABELS[point.curve]}, {point.engine}"


def growth(points: Sequence[Point], legend: bool = False) -> Markup:
    """Plot time per candidate against waypoints, joints and population; with a legend where the page has none."""
    with mpl.rc_context(RC):
        figure = sized(1040, 340)
        panels = figure.subplots(1, len(AXES))
        for axes, (axis, name) in zip(panels, AXES.items(), strict=True):
            _panel(axes, [point for point in points if point.axis == axis], styles(points))
            axes.set_xlabel(name)
        panels[0].set_ylabel("microseconds per candidate")
        if legend:
            lines = {line.get_label(): line for axes in panels for line in axes.get_lines()}
            figure.legend(lines.values(), lines.keys(), loc="upper center", ncols=len(lines), frameon=False)
        figure.subplots_adjust(0.06, 0.15, 0.99, 0.9 if legend else 0.97, wspace=0.16)
        description = "Time per candidate against the number of waypoints, joints and candidates, by curve and engine."
        return svg(figure, "growth", "Growth of the kernels' time", description)


def _panel(axes: Axes, points: Sequence[Point], numbers: dict[str, int]) -> None:
    for name, i in numbers.items():
        own = [point for point in points if label(point) == name]
        if own:
            x, y = [point.size for point in own], [median(point.seconds) * 1e6 for point in own]
            axes.loglog(x, y, color=SERIES[i], linestyle=DASHES[i], marker=MARKERS[i], label=name)
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.minorticks_off()
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:,.0f}")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
