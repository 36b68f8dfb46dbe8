"""The figure of growth as inline SVG; lines differ by dash and marker, so that they read in black and white."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.axes import Axes

from study.bench.growth import LABELS, Point
from study.problem import Floats
from study.report.figures import gridded, sized, svg
from study.report.pictures import standalone
from study.report.plot_style import DASHES, GRID, INK, MARKERS, RC, SERIES

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


def torques(panels: Mapping[str, Sequence[tuple[str, Floats, Floats]]]) -> str:
    """Draw the largest share of a torque limit along motions, a panel for each case; an SVG file of its own."""
    styles = {
        name: k for k, name in enumerate(dict.fromkeys(label for lines in panels.values() for label, _, _ in lines))
    }
    with mpl.rc_context(RC):
        figure = sized(1040, 360)
        for axes, (case, lines) in zip(figure.subplots(1, len(panels)), panels.items(), strict=True):
            for label, x, y in lines:
                axes.plot(x, 100 * y, color=SERIES[styles[label]], linestyle=DASHES[styles[label]])
            axes.axhline(100.0, color=INK, linewidth=1.0)
            axes.set_title(case)
            axes.set_xlabel("share of the motion's duration")
            axes.set_ylim(0.0, 115.0)
            axes.set_xlim(0.0, 1.0)
            gridded(axes)
        figure.axes[0].set_ylabel("largest share of a torque limit, %")
        figure.subplots_adjust(0.06, 0.14, 0.99, 0.92, wspace=0.12)
        description = (
            "Largest share of a torque limit over all joints against the share of the duration, for every motion."
        )
        inline = svg(figure, "torques", "Torques along the motions", description)
    return standalone(str(inline), "Largest share of a torque limit", [(k, name) for name, k in styles.items()])
