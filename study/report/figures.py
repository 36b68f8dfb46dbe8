"""Every plot of the report, as inline SVG; the only file of the report that imports matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from study.problem import Floats, Problem
from study.report.svg import PLACEHOLDER, themed
from study.trajectory import Motion

INK, MUTED, GRID, BAND, PAPER = (PLACEHOLDER[name] for name in ("ink", "muted", "grid", "band", "paper"))
SERIES = tuple(PLACEHOLDER[f"s{k}"] for k in range(1, 7))
DASHES: tuple[Any, ...] = ("-", (0, (6, 2)), (0, (6, 2, 1.5, 2)), (0, (1.5, 1.5)), (0, (3, 1.5, 1, 1.5, 1, 1.5)), (0, (9, 3)))
MARKERS = ("o", "s", "^", "D", "X", "v")
RC = {
    "svg.hashsalt": "time-optimal-study",
    "svg.fonttype": "none",
    "text.parse_math": False,
    "font.size": 11.0,
    "axes.titlesize": 11.0,
    "axes.labelsize": 10.5,
    "xtick.labelsize": 10.0,
    "ytick.labelsize": 10.0,
    "hatch.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "axes.axisbelow": True,
} | dict.fromkeys(("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color", "axes.titlecolor"), INK)
QUANTITIES = ("position", "velocity", "acceleration", "jerk")
SAMPLES = 240


def _svg(figure: Figure, key: str, title: str, description: str) -> Markup:
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    return themed(buffer.getvalue(), key, title, description)


def _figure(width: float, height: float) -> Figure:
    """Size in pixels of the page; an SVG has 72 units to the inch."""
    return Figure(figsize=(width / 72, height / 72), layout="constrained")


def _grid(axes: Axes, axis: Any = "both") -> None:
    axes.grid(True, axis=axis, color=GRID, linewidth=0.8)
    axes.tick_params(length=0)


@dataclass(frozen=True, eq=False)
class Series:
    """A method's motion under the name and style it has in the legend."""

    label: str
    style: int
    motion: Motion


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
        figure = _figure(390, 560)
        panels = figure.subplots(4, 1, sharex=True)
        for order, axes in enumerate(panels):
            _profile_panel(axes, problem, joint, order, series)
            axes.set_title(f"{QUANTITIES[order]}, {unit}{('', '/s', '/s²', '/s³')[order]}", loc="left")
        panels[-1].set_xlabel("time, s")
        methods = ", ".join(one.label for one in series)
        return _svg(
            figure,
            key,
            f"Profiles of {name}",
            f"Position, velocity, acceleration and jerk of {name} over time for {methods}; "
            "what lies beyond a limit is hatched. The largest value of each stands in the limit table.",
        )


def _profile_panel(axes: Axes, problem: Problem, joint: int, order: int, series: Sequence[Series]) -> None:
    _grid(axes)
    peaks = []
    for one in series:
        times = _times(one.motion)
        values = one.motion(times, order)[:, joint]
        peaks.append(float(np.abs(values).max()))
        axes.plot(times, values, color=SERIES[one.style], linestyle=DASHES[one.style], linewidth=1.6)
    if order == 0:
        low, high = problem.limits.lower[joint], problem.limits.upper[joint]
        axes.plot(series[0].motion.waypoint_times, problem.waypoints[:, joint], "o", color=INK, markersize=3.5)
        _shade(axes, low, high, *axes.get_ylim())
        return
    limit = float(problem.limits.rates[order - 1, joint])
    top = 1.12 * (max(limit, min(max(peaks), 1.5 * limit)) if np.isfinite(limit) else _calm_top(peaks))
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


def _times(motion: Motion) -> Floats:
    """Times to draw at; both sides of every knot, where a profile may step, as long as there are few."""
    even = np.linspace(0.0, motion.duration, SAMPLES)
    inner = motion.knots[1:-1] if len(motion.knots) < SAMPLES else np.empty(0)
    return np.sort(np.concatenate([even, inner, inner * (1 - 1e-9)]))


@dataclass(frozen=True, eq=False)
class Convergence:
    """Best feasible total time so far over the seeds of one search; arrays of shape (n_points,), s, NaN before any."""

    label: str
    style: int
    evaluations: Floats
    median: Floats
    lower: Floats
    upper: Floats


def convergence(key: str, curves: Sequence[Convergence], reference: tuple[str, float] | None) -> Markup:
    """Plot total time against evaluations: the median over seeds, the quartiles as a band."""
    with mpl.rc_context(RC):
        figure = _figure(720, 380)
        axes = figure.subplots()
        _grid(axes)
        for curve in curves:
            colour = SERIES[curve.style]
            axes.fill_between(curve.evaluations, curve.lower, curve.upper, color=colour, alpha=0.15, linewidth=0, step="post")
            axes.step(
                curve.evaluations, curve.median, where="post", color=colour, linestyle=DASHES[curve.style],
                marker=MARKERS[curve.style], markevery=(3 * curve.style, 24), markersize=5, linewidth=1.7,
            )  # fmt: skip
        if reference:
            axes.axhline(reference[1], color=INK, linewidth=1.2)
            axes.annotate(
                f"{reference[0]}: {reference[1]:.4g} s", (0.995, reference[1]), xycoords=("axes fraction", "data"),
                ha="right", va="bottom", textcoords="offset points", xytext=(0, 3), color=INK,
            )  # fmt: skip
        axes.set_xscale("log")
        axes.set_ylim(*_converged_range(curves, reference))
        axes.set(xlabel="curve evaluations", ylabel="best total time so far, s")
        return _svg(
            figure,
            key,
            "Convergence of the searches",
            "Best total time so far against curve evaluations, median and quartiles over seeds, for "
            + ", ".join(curve.label for curve in curves)
            + ". The last values stand in the results table.",
        )


def _converged_range(curves: Sequence[Convergence], reference: tuple[str, float] | None) -> tuple[float, float]:
    """Range of time that shows the endings and the last two thirds of the way there."""
    ends = [curve.median[-1] for curve in curves if np.isfinite(curve.median[-1])]
    ends += [reference[1]] if reference else []
    starts = [np.nanquantile(curve.upper, 0.8) for curve in curves if np.isfinite(curve.upper).any()]
    if not ends:
        return 0.0, 1.0
    low, high = min(ends), max(ends + starts)
    pad = 0.06 * max(high - low, 1e-3 * low)
    return low - 2 * pad, high + pad


@dataclass(frozen=True)
class Mark:
    """One method in the headline figure: percent of time against the reference, and whether the judge accepts it."""

    role: int
    percent: float
    feasible: bool
    best_percent: float | None = None


@dataclass(frozen=True)
class HeadlineRow:
    """One case of the headline figure."""

    title: str
    marks: tuple[Mark, ...]


def headline(key: str, rows: Sequence[HeadlineRow], reference: str, width: float) -> Markup:
    """Plot every case's methods as percent of time above or below the reference.

    Parameters
    ----------
    key : str
    rows : sequence of HeadlineRow
    reference : str
        What 0 % stands for.
    width : float, pixels
    """
    with mpl.rc_context(RC):
        figure = _figure(width, 64 + 54 * len(rows))
        axes = figure.subplots()
        _grid(axes, "x")
        axes.axvline(0.0, color=INK, linewidth=1.4)
        for level, row in enumerate(rows):
            _headline_row(axes, level, row)
        axes.set(ylim=(len(rows) - 0.4, -0.75), yticks=[], xlabel=f"time against {reference}")
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:+.0f} %" if value else "0 %")
        axes.xaxis.set_major_locator(mpl.ticker.MaxNLocator(nbins=max(3, int(width / 110))))
        axes.spines["left"].set_visible(False)
        axes.margins(x=0.06)
        return _svg(
            figure,
            key,
            "Who is faster, and by how much",
            f"For every case the time of each kind of method in percent above or below {reference}. "
            "The numbers stand in the table below.",
        )


def _headline_row(axes: Axes, level: int, row: HeadlineRow) -> None:
    axes.annotate(
        row.title, (0.0, level), xycoords=("axes fraction", "data"), xytext=(0, 13), textcoords="offset points",
        fontweight="bold", va="bottom",
    )  # fmt: skip
    axes.axhline(level, color=GRID, linewidth=1.0)
    for mark in row.marks:
        colour = SERIES[mark.role]
        if mark.best_percent is not None:
            axes.plot([mark.best_percent, mark.percent], [level, level], color=colour, linewidth=4, alpha=0.6)
        axes.plot(
            mark.percent, level, MARKERS[mark.role], markersize=9.5, markeredgecolor=colour, markeredgewidth=1.8,
            markerfacecolor=colour if mark.feasible else PAPER, clip_on=False,
        )  # fmt: skip


@dataclass(frozen=True)
class Bar:
    """One rung of the ladder figure: a time with what stands over its bar and at its end."""

    label: str
    value: str
    seconds: float
    hatch: str
    solid: bool


def ladder(key: str, bars: Sequence[Bar]) -> Markup:
    """Plot the ladder of lost time as bars from zero, one under the other."""
    with mpl.rc_context(RC):
        figure = _figure(720, 46 * len(bars) + 40)
        axes = figure.subplots()
        _grid(axes, "x")
        longest = max(bar.seconds for bar in bars)
        for level, bar in enumerate(bars):
            axes.barh(
                level, bar.seconds, height=0.42, facecolor=SERIES[0] if bar.solid else "none", edgecolor=SERIES[0] if not bar.hatch else INK,
                hatch=bar.hatch, linestyle="-" if bar.solid else "--", linewidth=1.2, alpha=0.75,
            )  # fmt: skip
            axes.annotate(bar.label, (0.0, level - 0.24), xytext=(0, 2), textcoords="offset points", va="bottom")
            axes.annotate(bar.value, (bar.seconds, level), xytext=(6, 0), textcoords="offset points", va="center", fontweight="bold")
        axes.set(xlim=(0, 1.34 * longest), ylim=(len(bars) - 0.5, -0.85), yticks=[], xlabel="total time, s")
        axes.spines["left"].set_visible(False)
        return _svg(
            figure,
            key,
            "The ladder of lost time",
            "Total time of every rung from the published result to the fastest known motion; the table beside it holds the same numbers.",
        )


def segments(key: str, series: Sequence[Series]) -> Markup:
    """Plot how each motion spends its time between the waypoints, as bars cut at the waypoints."""
    with mpl.rc_context(RC):
        figure = _figure(720, 46 * len(series) + 46)
        axes = figure.subplots()
        _grid(axes, "x")
        for level, one in enumerate(series):
            times = one.motion.waypoint_times
            for k, (start, end) in enumerate(zip(times, times[1:], strict=False)):
                axes.barh(
                    level, end - start, left=start, height=0.44, facecolor=SERIES[one.style], edgecolor=PAPER,
                    linewidth=1.2, alpha=0.85 if k % 2 == 0 else 0.5, hatch="" if k % 2 == 0 else "///",
                )  # fmt: skip
            axes.annotate(one.label, (0.0, level - 0.25), xytext=(0, 2), textcoords="offset points", va="bottom")
        axes.set(ylim=(len(series) - 0.5, -0.85), yticks=[], xlabel="time, s")
        axes.spines["left"].set_visible(False)
        methods = ", ".join(one.label for one in series)
        return _svg(
            figure, key, "Time spent on every segment", f"Bars cut at the waypoints for {methods}; the table holds the same numbers."
        )
