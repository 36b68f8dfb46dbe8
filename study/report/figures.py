"""Plots of lines of the report, as inline SVG."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator

from study.analysis.formatting import count
from study.problem import Problem
from study.report.plot_style import (
    BAND,
    DASHES,
    GRID,
    INK,
    MARKERS,
    MUTED,
    OUT_OF_SIGHT,
    QUANTITIES,
    RATE_UNITS,
    RC,
    SERIES,
    Convergence,
    Notes,
    Series,
    rate_top,
    sample_times,
    themed,
)


def svg(figure: Figure, key: str, title: str, description: str, notes: Notes | None = None) -> Markup:
    """Turn a finished figure into an inline figure of a page; see `plot_style.themed`."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    return themed(buffer.getvalue(), key, title, description, notes)


def sized(width: float, height: float) -> Figure:
    """Make a figure of so many pixels; an SVG has 72 units to the inch."""
    return Figure(figsize=(width / 72, height / 72))


def margins(figure: Figure, left: float, right: float, bottom: float, top: float) -> None:
    """Margins in pixels; a layout engine would measure every text and take as long as the drawing."""
    width, height = 72 * figure.get_size_inches()
    figure.subplots_adjust(left / width, bottom / height, 1 - right / width, 1 - top / height)


def gridded(axes: Axes, axis: Any = "both") -> None:
    """Draw a grid, without ticks."""
    axes.grid(True, axis=axis, color=GRID, linewidth=0.8)
    axes.tick_params(length=0)


def profile(key: str, problem: Problem, joint: int, unit: str, series: Sequence[Series]) -> Markup:
    """Plot position, velocity, acceleration and jerk of one joint, with what lies beyond the limits hatched.

    Parameters
    ----------
    key : str
        Prefix of the figure's ids.
    problem : Problem
    joint : int
        Counted from 0.
    unit : str
        `rad` or `m`.
    series : sequence of Series
    """
    name = problem.joint_names[joint]
    with mpl.rc_context(RC):
        figure = sized(300 if problem.n_joints % 4 == 0 else 380, 620)
        panels = figure.subplots(4, 1, sharex=True, gridspec_kw={"hspace": 0.24})
        margins(figure, 46, 6, 42, 22)
        for order, axes in enumerate(panels):
            _profile_panel(axes, problem, joint, order, series)
            axes.set_title(f"{QUANTITIES[order]}, {unit}{RATE_UNITS[order]}", loc="left")
        panels[-1].set_xlabel("time, s")
        methods = ", ".join(each.label for each in series)
        return svg(
            figure,
            key,
            f"Profiles of {name}",
            f"Position, velocity, acceleration and jerk of {name} over time for {methods}; "
            "what lies beyond a limit is hatched. The largest value of each stands in the limit table.",
        )


def _profile_panel(axes: Axes, problem: Problem, joint: int, order: int, series: Sequence[Series]) -> None:
    gridded(axes)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=5))
    peaks = []
    for each in series:
        times = sample_times(each.motion)
        values = each.motion(times, order)[:, joint]
        peaks.append(float(np.abs(values).max()))
        axes.plot(
            times, values, color=SERIES[each.style], linestyle=DASHES[each.style], linewidth=1.6 if order < 3 else 1.0
        )
    if order == 0:
        low, high = problem.limits.lower[joint], problem.limits.upper[joint]
        axes.plot(series[0].motion.waypoint_times, problem.waypoints[:, joint], "o", color=INK, markersize=3.5)
        _shade(axes, low, high, *axes.get_ylim())
        return
    limit = float(problem.limits.rates[order - 1, joint])
    if max(peaks) < OUT_OF_SIGHT * limit < np.inf:
        note = f"limit ±{limit:.4g} is out of sight"
        axes.annotate(note, (1.0, 1.0), xycoords="axes fraction", ha="right", va="bottom", color=MUTED, fontsize=10)
    top = rate_top(limit, peaks)
    _shade(axes, -limit, limit, -top, top)


def _shade(axes: Axes, low: float, high: float, bottom: float, top: float) -> None:
    axes.set_ylim(bottom, top)
    for limit, edge in ((low, bottom), (high, top)):
        if bottom < limit < top:
            axes.axhspan(limit, edge, facecolor=BAND, edgecolor=MUTED, alpha=0.45, hatch="////", linewidth=0)
            axes.axhline(limit, color=INK, linewidth=1.0)


def convergence(key: str, curves: Sequence[Convergence], reference: tuple[str, float] | None, width: float) -> Markup:
    """Plot the time above the shortest known against evaluations: the median over seeds, the quartiles as a band.

    The reference, a name and a time in s, is drawn where a search went below it. The width is in pixels.
    """
    shortest = shortest_of(curves, reference)
    with mpl.rc_context(RC):
        figure = sized(width, 380)
        axes = figure.subplots()
        margins(figure, 74, 24, 44, 10)
        gridded(axes)
        for curve in curves:
            _converging(axes, curve, shortest)
        if reference and reference[1] > shortest * (1 + FLOOR):
            axes.axhline(_above(reference[1], shortest), color=INK, linewidth=1.2)
        axes.set(xscale="log", yscale="log", xlabel="curve evaluations", ylabel="time above the shortest known")
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 200 * low else (1.0,)))
        axes.xaxis.set_major_formatter(lambda value, _: count(value))
        axes.yaxis.set_major_formatter(lambda value, _: f"{100 * value:g} %")
        axes.minorticks_off()
        return svg(
            figure,
            key,
            "Convergence of the searches",
            "Time above the shortest known against curve evaluations, median and quartiles over seeds, for "
            + ", ".join(curve.label for curve in curves)
            + ". The last values stand in the results table.",
        )


def shortest_of(curves: Sequence[Convergence], reference: tuple[str, float] | None) -> float:
    """Shortest time of the curves and the reference, s; 1 where there is none."""
    ends = [float(np.nanmin(curve.lower)) for curve in curves if np.isfinite(curve.lower).any()]
    return min([*ends, *([reference[1]] if reference else [])], default=1.0)


FLOOR = 1e-6
"""Share above the shortest time that counts as having reached it, so that a logarithm can be taken."""


def _above(times: Any, shortest: float) -> Any:
    return np.maximum(np.asarray(times) / shortest - 1.0, FLOOR)


def _converging(axes: Axes, curve: Convergence, shortest: float) -> None:
    colour = SERIES[curve.style]
    lower, median, upper = (_above(line, shortest) for line in (curve.lower, curve.median, curve.upper))
    axes.fill_between(curve.evaluations, lower, upper, color=colour, alpha=0.13, linewidth=0, step="post")
    axes.step(
        curve.evaluations, median, where="post", color=colour, linestyle=DASHES[curve.style],
        marker=MARKERS[curve.style], markevery=(4 * curve.style, 28), markersize=5, linewidth=1.7,
    )  # fmt: skip
