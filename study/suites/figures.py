"""Figures of a suite's page as inline SVG; lines differ by dash and marker, so that they read in black and white."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from study.analysis.formatting import ratio as number
from study.report.figures import sized, svg
from study.report.plot_style import DASHES, GRID, INK, MARKERS, RC, SERIES
from study.suites.growth import Axis, Growth
from study.suites.profiles import Profile
from study.suites.targets import Cost

LEAST, MOST = 1e-5, 10.0
"""Gaps that the logarithmic axis shows."""

Marks = Sequence[tuple[str, int, float, str]]
"""Cases of the papers: name, segments, gap and planner."""


def _canvas(width: float, height: float) -> tuple[Figure, Axes]:
    figure = sized(width, height)
    axes = figure.subplots()
    figure.subplots_adjust(76 / width, 46 / height, 1 - 14 / width, 1 - 12 / height)
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.tick_params(length=0)
    return figure, axes


def _look(style: int) -> dict[str, Any]:
    return {"color": SERIES[style], "linestyle": DASHES[style], "linewidth": 1.6}


def growth(
    key: str, lines: Sequence[Growth], styles: Mapping[str, int], papers: Marks = (), axis: Axis = "segments"
) -> Markup:
    """Plot the median gap to the curve's optimum against the size, with bands, the papers' cases marked."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(760, 440)
        for line in lines:
            style = styles[line.planner]
            x = [point.size for point in line.points]
            low, middle, high = (
                np.clip([getattr(point.gap, name) for point in line.points], LEAST, MOST)
                for name in ("lower", "estimate", "upper")
            )
            axes.fill_between(x, low, high, color=SERIES[style], alpha=0.1, linewidth=0)
            axes.plot(x, middle, marker=MARKERS[style], markersize=5, **_look(style))
        for (segments, at), cases in _places(papers).items():
            axes.plot(segments, at, "*", color=INK, markersize=10, zorder=5)
            label = ", ".join(cases)
            axes.annotate(label, (segments, at), xytext=(7, 4), textcoords="offset points", color=INK, fontsize=10)
        axes.set(xscale="log", yscale="log", xlabel=axis, ylabel="above the optimum of the same curve")
        axes.set_ylim(LEAST / 1.5, MOST * 1.2)
        sizes = sorted({point.size for line in lines for point in line.points})
        axes.set_xticks(sizes, [str(size) for size in sizes])
        axes.yaxis.set_major_formatter(lambda value, _: f"{100 * value:g} %")
        axes.minorticks_off()
        names = ", ".join(line.planner for line in lines)
        return svg(
            figure, key, f"Gap to the optimum by {axis}", f"Median gap against the number of {axis} for {names}."
        )


def costs(key: str, every: Sequence[Cost], styles: Mapping[str, int], target: int) -> Markup:
    """Plot the expected evaluations to a target against the number of segments."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(760, 380)
        for name, style in styles.items():
            own = [cost for cost in every if cost.method == name]
            values = [cost.evaluations[target] if np.isfinite(cost.evaluations[target]) else np.nan for cost in own]
            axes.plot([cost.segments for cost in own], values, marker=MARKERS[style], markersize=5, **_look(style))
        axes.set(xscale="log", yscale="log", xlabel="segments", ylabel="expected evaluations")
        sizes = sorted({cost.segments for cost in every})
        axes.set_xticks(sizes, [str(size) for size in sizes])
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(lambda value, _: number(value))
        axes.minorticks_off()
        return svg(figure, key, "Cost by segments", f"Expected evaluations against segments for {', '.join(styles)}.")


def _places(papers: Marks) -> dict[tuple[int, float], list[str]]:
    """Names of the papers' cases by their place in the figure; those too near 0 to be told apart share one."""
    places: dict[tuple[int, float], list[str]] = {}
    for name, segments, gap, _ in papers:
        places.setdefault((segments, float(np.clip(gap, LEAST, MOST))), []).append(name)
    return places


def profiles(key: str, lines: Sequence[Profile], styles: Mapping[str, int], label: str, title: str) -> Markup:
    """Plot shares of runs over a factor or a cost; a line that ends below 1 has failures or runs that never get near."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(760, 360)
        last = max((float(line.x[-1]) for line in lines if len(line.x)), default=2.0)
        for line in lines:
            if len(line.x):
                x, share = np.append(line.x, last), np.append(line.share, line.share[-1])
                axes.step(x, share, where="post", **_look(styles[line.method]))
        axes.set(xscale="log", xlabel=label, ylabel="share of runs", ylim=(0, 1.02))
        axes.xaxis.set_major_formatter(lambda value, _: number(value))
        axes.minorticks_off()
        names = ", ".join(line.method for line in lines)
        return svg(figure, key, title, f"Share of all runs against {label} for {names}.")
