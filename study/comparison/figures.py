"""Figures of the comparison as inline SVG; lines differ by dash and marker, so that they read in black and white."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from study.analysis.formatting import ratio as figure_text
from study.comparison.ablations import AblationFinding
from study.comparison.audit import ALARM, FunctionFinding, TrajectoryFinding
from study.comparison.differences import Omnibus
from study.comparison.performance import Anytime, Distribution
from study.comparison.tasks import CENTRED, REFLECTED
from study.report.plot_style import DASHES, GRID, INK, MARKERS, MUTED, RC, SERIES, themed

LEAST = 1e-6
"""Smallest share above the reference that a logarithmic axis shows."""


def _svg(figure: Figure, key: str, title: str, description: str) -> Markup:
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    return themed(buffer.getvalue(), key, title, description)


def _canvas(width: float, height: float, left: float, top: float = 10.0) -> tuple[Figure, Axes]:
    """Make axes in a figure of so many pixels, with a margin for row names on the left."""
    figure = Figure(figsize=(width / 72, height / 72))
    axes = figure.subplots()
    figure.subplots_adjust(left / width, 46 / height, 1 - 14 / width, 1 - top / height)
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


def distribution(key: str, found: Sequence[Distribution], styles: dict[str, int]) -> Markup:
    """Plot the share of targets reached against evaluations per segment; planners without a style are thin lines."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(720, 380, 58)
        for one in found:
            style = styles.get(one.planner)
            look: dict[str, Any] = {"color": MUTED, "linewidth": 0.7} if style is None else _look(style)
            axes.step(one.costs, one.shares, where="post", **look)
        axes.set(xscale="log", xlabel="evaluations per segment", ylabel="share of targets reached", ylim=(0, 1.02))
        _decades(axes)
        names = ", ".join(one.planner for one in found)
        return _svg(
            figure, key, "Targets reached", f"Share of cases, runs and targets reached against evaluations for {names}."
        )


def _look(style: int) -> dict[str, Any]:
    return {
        "color": SERIES[style],
        "linestyle": DASHES[style],
        "marker": MARKERS[style],
        "markevery": (4 * style, 24),
        "markersize": 5,
        "linewidth": 1.7,
    }


def anytime(key: str, case: str, found: Sequence[Anytime], reference: float, styles: dict[str, int]) -> Markup:
    """Plot the quartiles of the best objective so far, as a share above the reference, for the planners with a style."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(560, 320, 88, 24)
        for one in (one for one in found if one.planner in styles):
            style = styles[one.planner]
            low, middle, high = np.maximum(one.values / reference - 1.0, LEAST)
            known = np.isfinite(high)
            axes.fill_between(
                one.evaluations[known],
                low[known],
                high[known],
                color=SERIES[style],
                alpha=0.13,
                linewidth=0,
                step="post",
            )
            shown = np.isfinite(middle)
            axes.step(one.evaluations[shown], middle[shown], where="post", **_look(style))
        axes.set(xscale="log", yscale="log", xlabel="evaluations", ylabel="above the best known")
        axes.set_title(case, loc="left")
        axes.yaxis.set_major_formatter(lambda value, _: f"{100 * value:g} %")
        _decades(axes)
        names = ", ".join(one.planner for one in found if one.planner in styles)
        return _svg(figure, key, f"Anytime curves on {case}", f"Median and quartiles against evaluations for {names}.")


def critical_difference(key: str, found: Omnibus) -> Markup:
    """Plot mean ranks; bars on the right join planners that Nemenyi's test cannot tell apart."""
    n = len(found.planners)
    with mpl.rc_context(RC):
        figure, axes = _canvas(720, 26 * n + 96, 190, 30)
        ranks = found.friedman.mean_ranks
        axes.plot(ranks, range(n), "o", color=INK, markersize=6)
        for i, group in enumerate(found.groups):
            x = n + 0.5 + 0.45 * i
            axes.plot([x, x], [min(group) - 0.25, max(group) + 0.25], color=INK, linewidth=3, solid_capstyle="butt")
        axes.plot([1, 1 + found.difference], [-1, -1], color=INK, linewidth=2, marker="|", clip_on=False)
        axes.annotate(
            f"critical difference {found.difference:.2f}",
            (1 + found.difference, -1),
            xytext=(6, -4),
            textcoords="offset points",
            annotation_clip=False,
        )
        _rows(axes, found.planners)
        axes.set_xlim(0.5, max(n + 1.0, n + 0.7 + 0.45 * len(found.groups)))
        axes.set_xticks(range(1, n + 1, 1 if n < 10 else 2))
        axes.set_ylim(n - 0.4, -1.5)
        axes.set_xlabel("mean rank over cases (1 is best); a bar joins what cannot be told apart")
        return _svg(
            figure, key, "Critical difference diagram", "Mean ranks of the planners; they stand in the table too."
        )


def ratios(key: str, found: Sequence[FunctionFinding]) -> Markup:
    """Plot every search's error ratio against the alarm level."""
    with mpl.rc_context(RC):
        figure, axes = _canvas(720, 24 * len(found) + 60, 220)
        rows = range(len(found))
        diagonal = [max(one.diagonal, 1e-3) for one in found]
        axes.axvline(ALARM, color=INK, linewidth=1.4, linestyle=(0, (6, 2)))
        axes.plot([max(one.shifted, 1e-3) for one in found], rows, "o", color=INK, markersize=7)
        axes.plot(diagonal, rows, "D", color=INK, markerfacecolor="none", markersize=6)
        axes.set_xscale("log")
        _decades(axes)
        _rows(axes, [one.search for one in found])
        axes.set_xlabel("error ratio: dot, off the origin; diamond, off the diagonal; dashed: 10")
        return _svg(figure, key, "Error ratios", "Geometric means over functions; the numbers stand in the table.")


def views(key: str, case: str, found: Sequence[TrajectoryFinding]) -> Markup:
    """Plot how much longer every search's median is in the other views of one case; filled where it is significant."""
    names = list(dict.fromkeys(one.search for one in found))
    with mpl.rc_context(RC):
        figure, axes = _canvas(720, 24 * len(names) + 80, 220, 24)
        axes.axvline(0.0, color=INK, linewidth=1.2)
        for one in found:
            row = names.index(one.search) + (-0.15 if one.view == REFLECTED else 0.15)
            marker = "o" if one.view == REFLECTED else "s"
            face = INK if one.depends else "none"
            axes.plot(
                100 * (one.seen / one.as_they_are - 1), row, marker, color=INK, markerfacecolor=face, markersize=6
            )
        _rows(axes, names)
        axes.set_title(case, loc="left")
        axes.set_xlabel(f"change of the median, %: circle {REFLECTED}, square {CENTRED}; filled: significant")
        return _svg(figure, key, f"Views of {case}", "Change of the median time; the numbers stand in the table.")


def effects(key: str, title: str, found: Sequence[AblationFinding]) -> Markup:
    """Plot the probability that an improvement helps, one row for each, one marker for each task."""
    names = list(dict.fromkeys(one.improvement for one in found))
    with mpl.rc_context(RC):
        figure, axes = _canvas(720, 30 * len(names) + 84, 220, 24)
        axes.axvline(0.5, color=INK, linewidth=1.2)
        for edge in (0.29, 0.71):
            axes.axvline(edge, color=MUTED, linewidth=1.0, linestyle=(0, (4, 3)))
        for one in found:
            row = names.index(one.improvement) + (-0.15 if one.trajectory else 0.15)
            face = INK if one.effect != "none" else "none"
            axes.plot(
                one.a12,
                row,
                "o" if one.trajectory else "^",
                color=INK,
                markerfacecolor=face,
                markersize=6,
                clip_on=False,
            )
        _rows(axes, names)
        axes.set_xlim(0, 1)
        axes.set_title(title, loc="left")
        axes.set_xlabel("A12: circle, trajectory; triangle, function; filled: significant")
        return _svg(
            figure, key, f"Ablation of {title}", "Effect sizes of the improvements; the numbers stand in the table."
        )
