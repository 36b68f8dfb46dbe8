"""Figures of the comparison as inline SVG; lines differ by dash and marker, so that they read in black and white."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import isotonic_regression

from study.analysis.formatting import ratio as figure_text
from study.comparison.plots import Marks
from study.comparison.ranking import Omnibus
from study.comparison.targets import Anytime, Distribution
from study.problem import Floats
from study.report.figures import sized, svg
from study.report.plot_style import DASHES, GRID, INK, MARKERS, MUTED, RC, SERIES, Notes

LEAST = 1e-6
"""Smallest share above the reference that a logarithmic axis shows."""


def _canvas(width: float, height: float, left: float, top: float = 10.0, right: float = 14.0) -> tuple[Figure, Axes]:
    """Make axes in a figure of so many pixels, with a margin for row names on the left."""
    figure = sized(width, height)
    axes = figure.subplots()
    figure.subplots_adjust(left / width, 46 / height, 1 - right / width, 1 - top / height)
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.tick_params(length=0)
    axes.minorticks_off()
    return figure, axes


def _decades(axes: Axes) -> None:
    """Label the decades of a horizontal logarithmic axis in plain digits."""
    axes.xaxis.set_major_formatter(lambda value, _: figure_text(value))
    axes.minorticks_off()


def _rows(axes: Axes, names: Sequence[str]) -> None:
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)


def distribution(key: str, lines: Sequence[Distribution], styles: dict[str, int]) -> Markup:
    """Plot the share of targets reached against evaluations per segment; planners without a style are thin lines."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(860, 400, 58, right=190)
        for line in lines:
            style = styles.get(line.planner)
            look: dict[str, Any] = {"color": MUTED, "linewidth": 0.7} if style is None else _look(style)
            axes.step(line.costs, line.shares, where="post", **look)
        axes.set(xscale="log", xlabel="evaluations per segment", ylabel="share of targets reached", ylim=(0, 1.02))
        _decades(axes)
        for line, y in zip(lines, _spread([line.shares[-1] for line in lines], 0.042), strict=True):
            style = styles.get(line.planner)
            colour = MUTED if style is None else SERIES[style]
            axes.annotate(
                line.planner, (line.costs[-1], line.shares[-1]), xytext=(1.02, y), textcoords=("axes fraction", "data"),
                va="center", fontsize=11, color=MUTED if style is None else INK, annotation_clip=False,
                arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.8, "relpos": (0, 0.5), "shrinkA": 0},
            )  # fmt: skip
        names = ", ".join(line.planner for line in lines)
        return svg(
            figure, key, "Targets reached", f"Share of cases, runs and targets reached against evaluations for {names}."
        )


def _spread(places: Sequence[float], apart: float) -> Floats:
    """Heights for labels at falling places: as near to these as may be, and so far apart from one another."""
    steps = apart * np.arange(len(places))
    return np.asarray(isotonic_regression(np.asarray(places) + steps, increasing=False).x) - steps


def _look(style: int) -> dict[str, Any]:
    return {
        "color": SERIES[style],
        "linestyle": DASHES[style],
        "marker": MARKERS[style],
        "markevery": (4 * style, 24),
        "markersize": 5,
        "linewidth": 1.7,
    }


def anytime(key: str, case: str, curves: Sequence[Anytime], reference: float, styles: dict[str, int]) -> Markup:
    """Plot the quartiles of the best objective so far, as a share above the reference, for the planners with a style."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(560, 320, 88, 24)
        shown = [curve for curve in curves if curve.planner in styles]
        for curve in shown:
            style = styles[curve.planner]
            low, middle, high = np.maximum(curve.values / reference - 1.0, LEAST)
            known = np.isfinite(high)
            axes.fill_between(
                curve.evaluations[known],
                low[known],
                high[known],
                color=SERIES[style],
                alpha=0.13,
                linewidth=0,
                step="post",
            )
            begun = np.isfinite(middle)
            axes.step(curve.evaluations[begun], middle[begun], where="post", **_look(style))
        axes.set(xscale="log", yscale="log", xlabel="evaluations", ylabel="above the best known")
        axes.set_title(case, loc="left")
        axes.yaxis.set_major_formatter(lambda value, _: f"{100 * value:g} %")
        _decades(axes)
        names = ", ".join(curve.planner for curve in shown)
        return svg(figure, key, f"Anytime curves on {case}", f"Median and quartiles against evaluations for {names}.")


def critical_difference(key: str, test: Omnibus) -> Markup:
    """Plot mean ranks; bars on the right join planners that Nemenyi's test cannot tell apart."""
    n = len(test.planners)
    with mpl.rc_context(RC):
        figure, axes = _canvas(720, 26 * n + 96, 190, 30)
        ranks = test.friedman.mean_ranks
        axes.plot(ranks, range(n), "o", color=INK, markersize=6)
        for i, group in enumerate(test.groups):
            x = n + 0.5 + 0.45 * i
            axes.plot([x, x], [min(group) - 0.25, max(group) + 0.25], color=INK, linewidth=3, solid_capstyle="butt")
        axes.plot([1, 1 + test.difference], [-1, -1], color=INK, linewidth=2, marker="|", clip_on=False)
        axes.annotate(
            f"critical difference {test.difference:.2f}",
            (1 + test.difference, -1),
            xytext=(6, -4),
            textcoords="offset points",
            annotation_clip=False,
        )
        _rows(axes, test.planners)
        axes.set_xlim(0.5, max(n + 1.0, n + 0.7 + 0.45 * len(test.groups)))
        axes.set_xticks(range(1, n + 1, 1 if n < 10 else 2))
        axes.set_ylim(n - 0.4, -1.5)
        axes.set_xlabel("mean rank over cases (1 is best); a bar joins what cannot be told apart")
        return svg(
            figure, key, "Critical difference diagram", "Mean ranks of the planners; they stand in the table too."
        )


def rows_of_marks(plot: Marks) -> Markup:
    """Draw marks in named rows."""
    rows, notes = plot.rows, Notes()
    with mpl.rc_context(RC):
        figure, axes = _canvas(720, 26 * len(rows) + (84 if plot.heading else 60), 220, 24 if plot.heading else 10)
        if plot.line is not None:
            axes.axvline(plot.line, color=INK, linewidth=1.2)
        for edge in plot.edges:
            axes.axvline(edge, color=MUTED, linewidth=1.2, linestyle=(0, (5, 3)))
        for mark in plot.marks:
            face = INK if mark.filled else "none"
            place = rows.index(mark.row) + mark.offset
            gid = notes.add(f"{mark.row}: {mark.note or figure_text(mark.x)}")
            axes.plot(mark.x, place, mark.shape, color=INK, markerfacecolor=face, markersize=6, clip_on=False, gid=gid)
        if plot.logarithmic:
            axes.set_xscale("log")
            _decades(axes)
        _rows(axes, rows)
        if plot.span is not None:
            axes.set_xlim(*plot.span)
        axes.set_title(plot.heading, loc="left")
        axes.set_xlabel(plot.label)
        return svg(figure, plot.key, plot.title, plot.description, notes)
