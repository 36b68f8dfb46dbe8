"""Every plot of the report, as inline SVG; the only file of the report that imports matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator

from study.analysis.formatting import count, percent
from study.problem import Problem
from study.report.plot_style import (
    BAND,
    DASHES,
    GRID,
    INK,
    LANES,
    MARKERS,
    MUTED,
    PAPER,
    RC,
    SERIES,
    Bar,
    Convergence,
    HeadlineRow,
    Series,
    crowded,
    headline_range,
    sample_times,
    spaced_ticks,
    themed,
)

NARROW = 500
"""Below so many pixels a label does not fit on one line."""

QUANTITIES = ("position", "velocity", "acceleration", "jerk")
OUT_OF_SIGHT = 0.3
"""Share of a limit; if every method uses less, the plot shows the motion and not the limit."""


def svg(figure: Figure, key: str, title: str, description: str) -> Markup:
    """Turn a finished figure into an inline figure of a page; see `plot_style.themed`."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    return themed(buffer.getvalue(), key, title, description)


def sized(width: float, height: float) -> Figure:
    """Make a figure of so many pixels; an SVG has 72 units to the inch."""
    return Figure(figsize=(width / 72, height / 72))


def _margins(figure: Figure, left: float, right: float, bottom: float, top: float) -> None:
    """Margins in pixels; a layout engine would measure every text and take as long as the drawing."""
    width, height = 72 * figure.get_size_inches()
    figure.subplots_adjust(left / width, bottom / height, 1 - right / width, 1 - top / height)


def _grid(axes: Axes, axis: Any = "both") -> None:
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
        _margins(figure, 46, 6, 42, 22)
        for order, axes in enumerate(panels):
            _profile_panel(axes, problem, joint, order, series)
            axes.set_title(f"{QUANTITIES[order]}, {unit}{('', '/s', '/s²', '/s³')[order]}", loc="left")
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
    _grid(axes)
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
    highest = max(peaks)
    if not np.isfinite(limit):
        highest = _calm_top(peaks)
    elif highest < OUT_OF_SIGHT * limit:
        note = f"limit ±{limit:.4g} is out of sight"
        axes.annotate(note, (1.0, 1.0), xycoords="axes fraction", ha="right", va="bottom", color=MUTED, fontsize=10)
    else:
        highest = max(limit, min(highest, 1.5 * limit))
    top = 1.12 * highest or 1.0
    _shade(axes, -limit, limit, -top, top)


def _calm_top(peaks: Sequence[float]) -> float:
    """Top of an axis without limit: the largest peak, unless it dwarfs the smallest."""
    moving = [peak for peak in peaks if peak > 0]
    return min(max(moving), 4 * min(moving)) if moving else 1.0


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
    ends = [float(np.nanmin(curve.lower)) for curve in curves if np.isfinite(curve.lower).any()]
    shortest = min([*ends, *([reference[1]] if reference else [])], default=1.0)
    with mpl.rc_context(RC):
        figure = sized(width, 380)
        axes = figure.subplots()
        _margins(figure, 74, 24, 44, 10)
        _grid(axes)
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


def headline(key: str, rows: Sequence[HeadlineRow], reference: str, width: float) -> Markup:
    """Plot every case's methods as percent of time above or below the reference.

    The reference is what 0 % stands for; the width is in pixels.
    """
    with mpl.rc_context(RC):
        figure = sized(width, 60 + 84 * len(rows))
        axes = figure.subplots()
        _margins(figure, 4, 4, 44, 4)
        _grid(axes, "x")
        axes.axvline(1.0, color=INK, linewidth=1.4)
        axes.set_xscale("log")
        axes.set_xlim(*headline_range(rows, width))
        for level, row in enumerate(rows):
            _headline_row(axes, level, row, width)
        axes.set(ylim=(len(rows) - 0.42, -0.7), yticks=[], xlabel=f"time against {reference}")
        shown = spaced_ticks(axes.get_xlim(), width)
        axes.set_xticks(shown, [percent(ratio - 1).replace(".00", "").replace(".0", "") for ratio in shown])
        axes.minorticks_off()
        axes.spines["left"].set_visible(False)
        return svg(
            figure,
            key,
            "Who is faster, and by how much",
            f"For every case the time of each kind of method in percent above or below {reference}. "
            "The numbers stand in the table below.",
        )


def _headline_row(axes: Axes, level: int, row: HeadlineRow, width: float) -> None:
    axes.annotate(
        row.title, (0.0, level), xycoords=("axes fraction", "data"), xytext=(0, 20), textcoords="offset points",
        fontweight="bold", va="bottom",
    )  # fmt: skip
    axes.axhline(level, color=GRID, linewidth=1.0)
    for mark in row.marks:
        colour, height = SERIES[mark.role], level + LANES[mark.role]
        if mark.best_ratio is not None:
            axes.plot([mark.best_ratio, mark.ratio], [height, height], color=colour, linewidth=4, alpha=0.6)
        axes.plot(
            mark.ratio, height, MARKERS[mark.role], markersize=9.0, markeredgecolor=colour, markeredgewidth=1.8,
            markerfacecolor=colour if mark.feasible else PAPER, clip_on=False,
        )  # fmt: skip
        if mark.ratio != 1.0:
            left = (mark.ratio < 1.0 and mark.role > 0) or crowded(row, mark, axes.get_xlim(), width)
            axes.annotate(
                percent(mark.ratio - 1), (mark.ratio, height), xytext=(-9 if left else 9, 0),
                textcoords="offset points", va="center", ha="right" if left else "left", color=colour,
            )  # fmt: skip


def ladder(key: str, bars: Sequence[Bar], width: float) -> Markup:
    """Plot the ladder of lost time as bars from zero, one under the other; the width is in pixels."""
    pitch = 64 if width < NARROW else 40  # from bar to bar
    with mpl.rc_context(RC):
        figure = sized(width, pitch * len(bars) + 52)
        axes = figure.subplots()
        _margins(figure, 14, 6, 42, 4)
        axes.tick_params(length=0)
        longest = max(bar.seconds for bar in bars)
        for level, bar in enumerate(bars):
            axes.barh(
                level, bar.seconds, height=17 / pitch, facecolor=SERIES[0] if bar.solid else "none", edgecolor=SERIES[0] if not bar.hatch else INK,
                hatch=bar.hatch, linestyle="-" if bar.solid else "--", linewidth=1.2, alpha=0.9,
            )  # fmt: skip
            label = bar.label.replace(": ", ":\n", 1) if width < NARROW else bar.label
            axes.annotate(label, (0.0, level), xytext=(0, 11), textcoords="offset points", va="bottom")
            axes.annotate(
                bar.value, (bar.seconds, level), xytext=(6, 0), textcoords="offset points", va="center", weight="bold"
            )
        room = (width - 20) / (width - 198)  # for the value beside the longest bar
        axes.set(xlim=(0, room * longest), ylim=(len(bars) - 0.5, -0.85), yticks=[], xlabel="total time, s")
        axes.spines["left"].set_visible(False)
        return svg(
            figure,
            key,
            "The ladder of lost time",
            "Total time of every rung from the published result to the fastest known motion; the table beside it holds the same numbers.",
        )


def segments(key: str, series: Sequence[Series], width: float) -> Markup:
    """Plot how each motion spends its time between the waypoints, as bars cut at the waypoints; the width is in pixels."""
    with mpl.rc_context(RC):
        figure = sized(width, 46 * len(series) + 52)
        axes = figure.subplots()
        _margins(figure, 14, 10, 42, 4)
        _grid(axes, "x")
        for level, each in enumerate(series):
            times = each.motion.waypoint_times
            for k, (start, end) in enumerate(pairwise(times)):
                axes.barh(
                    level, end - start, left=start, height=0.44, facecolor=SERIES[each.style], edgecolor=PAPER,
                    linewidth=1.2, alpha=0.85 if k % 2 == 0 else 0.5, hatch="" if k % 2 == 0 else "///",
                )  # fmt: skip
            axes.annotate(each.label, (0.0, level - 0.25), xytext=(0, 2), textcoords="offset points", va="bottom")
        axes.set(ylim=(len(series) - 0.5, -0.85), yticks=[], xlabel="time, s")
        axes.spines["left"].set_visible(False)
        return svg(
            figure,
            key,
            "Time spent on every segment",
            f"Bars cut at the waypoints for {', '.join(each.label for each in series)}; the table holds the same numbers.",
        )
