"""The plots of the reproduction pages, in the report's look."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from study.report.figures import svg
from study.report.plot_style import DASHES, GRID, INK, MUTED, RC, SERIES
from study.reproduction.paper import Panel
from study.reproduction.uniformity import chaos_numbers, chi_squares
from study.search.chaos import N_BINS

LEAST = 1e-300
"""Height at which a logarithmic axis shows zero."""

TALL = 2.5
"""Multiple of the last values above which a median is not shown: it holds penalties of infeasible candidates."""


def panels(key: str, shown: Sequence[Panel], columns: int, title: str) -> Markup:
    """Plot small multiples of best values over generations, medians over seeds.

    Parameters
    ----------
    key : str
        Prefix of the figure's ids.
    shown : sequence of Panel
        All with the same labels, on the papers' linear axis of generations; printed values and the optimum are
        horizontal lines.
    columns : int
    title : str
    """
    rows = math.ceil(len(shown) / columns)
    with mpl.rc_context(RC):
        figure = _figure(1040 if columns > 1 else 620, 60 + (250 if columns < 3 else 210) * rows)
        for k, panel in enumerate(shown, start=1):
            axes = figure.add_subplot(rows, columns, k)
            _panel(axes, panel)
            if k > len(shown) - columns:
                axes.set_xlabel("generation")
        return svg(
            figure,
            key,
            title,
            "Best value so far against generations, median over seeds; the tables hold the last values.",
        )


def _panel(axes: Axes, panel: Panel) -> None:
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.tick_params(length=0)
    axes.set_title(panel.title, loc="left")
    for style, (label, (generations, values)) in enumerate(panel.lines.items()):
        heights = np.maximum(values, LEAST) if panel.logarithmic else np.asarray(values)
        look = {"color": SERIES[style % len(SERIES)], "linestyle": DASHES[style % len(DASHES)]}
        axes.plot(generations, heights, linewidth=1.6, **look)
        if label in panel.marks and (panel.marks[label] > LEAST or not panel.logarithmic):
            axes.axhline(panel.marks[label], color=look["color"], linestyle=(0, (2, 3)), linewidth=1.1)
    if panel.logarithmic:
        _logarithmic(axes, panel)
    else:
        _linear(axes, panel)


def _logarithmic(axes: Axes, panel: Panel) -> None:
    """Scale the upright axis for values that span orders of magnitude."""
    axes.set_xlim(left=0)
    if all(np.min(values) > 0 or np.max(values) >= 0 for _, values in panel.lines.values()):
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(numticks=6))
        _plain_ticks(axes.yaxis)


def _linear(axes: Axes, panel: Panel) -> None:
    """Scale as the papers do, so that the whole descent of feasible values shows, with the optimum as floor."""
    ends = [float(values[-1]) for _, values in panel.lines.values()]
    floor = min([*ends, *panel.marks.values(), *([] if panel.least is None else [panel.least])])
    starts = [
        float(next((v for v in values if v < TALL * max(ends)), values[-1])) for _, values in panel.lines.values()
    ]
    top = max([*starts, *ends, *panel.marks.values()])
    if panel.least is not None:
        axes.axhline(panel.least, color=MUTED, linewidth=1.1)
    axes.set_ylim(floor - 0.08 * (top - floor) - 0.005 * floor, top + 0.08 * (top - floor) + 0.005 * floor)
    axes.set_xlim(left=0)


def _plain_ticks(axis: Axis) -> None:
    """Label a logarithmic axis without mathematical type, which the pages do not set."""
    axis.set_major_formatter(
        lambda value, _: f"{value:g}" if 1e-3 < value < 1e5 else f"{value:.0e}".replace("e+0", "e").replace("e-0", "e-")
    )
    axis.set_minor_formatter(NullFormatter())


def histograms(key: str, names: Sequence[str], numbers: int) -> Markup:
    """Plot how often the numbers of one start of each map fall into ten bins, with the median chi-square over many starts.

    Parameters
    ----------
    key : str
        Prefix of the figure's ids.
    names : sequence of str
        Maps.
    numbers : int
        Numbers drawn, as many as the paper shows.
    """
    with mpl.rc_context(RC):
        figure = _figure(1040, 250)
        edges = np.linspace(0.0, 1.0, N_BINS + 1)
        for k, name in enumerate(names, start=1):
            axes = figure.add_subplot(1, len(names), k)
            counts, _ = np.histogram(chaos_numbers(name)[:numbers, 0], bins=edges)
            axes.bar(edges[:-1], counts, width=0.92 / N_BINS, align="edge", color=SERIES[0], alpha=0.85)
            axes.axhline(numbers / N_BINS, color=INK, linewidth=1.2)
            axes.tick_params(length=0)
            axes.set_title(f"{name}: χ² = {np.median(chi_squares(name, numbers)):.1f}", loc="left")
        described = ", ".join(f"{name} {np.median(chi_squares(name, numbers)):.1f}" for name in names)
        return svg(
            figure,
            key,
            "Histograms of the maps",
            f"Counts of {numbers} numbers in ten bins; median chi-square over starts: {described}.",
        )


def _figure(width: float, height: float) -> Figure:
    return Figure(figsize=(width / 72, height / 72), layout="constrained")
