"""Plots of bars and marks of the report, as inline SVG: the headline, the ladder of lost time and the segments."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes

from study.analysis.formatting import percent
from study.report.figures import gridded, margins, sized, svg
from study.report.plot_style import (
    GRID,
    INK,
    MARKERS,
    MUTED,
    PAPER,
    RC,
    SERIES,
    Bar,
    HeadlineRow,
    Mark,
    Notes,
    Series,
    headline_range,
    spaced_ticks,
)

NARROW = 500
"""Below so many pixels a label does not fit on one line."""

LANE = 15
"""Height of a method in the headline figure, pixels; a case's name takes two."""


def headline(key: str, rows: Sequence[HeadlineRow], reference: str, width: float) -> Markup:
    """Plot every case's methods as percent of time above or below the reference, each in a lane of its own.

    The reference is what 0 % stands for; the width is in pixels.
    """
    lanes = sum(2 + len(row.marks) for row in rows)
    notes = Notes()
    with mpl.rc_context(RC):
        figure = sized(width, 50 + LANE * lanes)
        axes = figure.subplots()
        margins(figure, 4, 4, 44, 4)
        axes.set_xscale("log")
        axes.set(xlim=headline_range(rows, width), ylim=(lanes - 0.4, -0.4), yticks=[])
        shown = spaced_ticks(axes.get_xlim(), width)
        axes.set_xticks(shown, [percent(ratio - 1).replace(".00", "").replace(".0", "") for ratio in shown])
        axes.set_xlabel(
            f"time against {reference}; equal distances are equal ratios"
            if width > NARROW
            else "time against the reference, by ratio"
        )
        axes.minorticks_off()
        axes.spines["left"].set_visible(False)
        gridded(axes, "x")
        axes.axvline(1.0, color=INK, linewidth=1.4)
        top = 0
        for row in rows:
            _headline_row(axes, top, row, width, notes)
            top += 2 + len(row.marks)
        return svg(
            figure,
            key,
            "Who is faster, and by how much",
            f"For every case the time of each kind of method in percent above or below {reference}. "
            "The numbers stand in the table below.",
            notes,
        )


def _headline_row(axes: Axes, top: int, row: HeadlineRow, width: float, notes: Notes) -> None:
    if top:
        axes.axhline(top - 0.3, color=MUTED, linewidth=0.8)
    axes.annotate(
        row.title, (0.0, top + 0.5), xycoords=("axes fraction", "data"), fontweight="bold", va="center",
        bbox={"facecolor": PAPER, "edgecolor": "none", "pad": 1.5},
    )  # fmt: skip
    for lane, mark in enumerate(row.marks, start=top + 1):
        change = percent(mark.ratio - 1)
        said = f"{row.title}: {mark.name}, {change}" + ("" if mark.feasible else ", infeasible or not judged")
        _mark(axes, lane + 0.5, mark, notes, said)
        _label(axes, lane + 0.5, mark, f"{change}  {mark.name}" if width > NARROW else change, notes)


def _mark(axes: Axes, y: float, mark: Mark, notes: Notes, said: str) -> None:
    colour = SERIES[mark.role]
    if mark.best_ratio is not None:
        ends = [mark.best_ratio, mark.ratio]
        axes.plot(ends, [y, y], color=colour, linewidth=4, alpha=0.6, gid=notes.add(said, mark.role))
    axes.plot(
        mark.ratio, y, MARKERS[mark.role], markersize=8.0, markeredgecolor=colour, markeredgewidth=1.8,
        markerfacecolor=colour if mark.feasible else PAPER, clip_on=False, gid=notes.add(said, mark.role),
    )  # fmt: skip


def _label(axes: Axes, y: float, mark: Mark, text: str, notes: Notes) -> None:
    """A label on the side with more room."""
    low, high = np.log(axes.get_xlim())
    ends = (mark.ratio, mark.ratio if mark.best_ratio is None else mark.best_ratio)
    place = (np.log(mark.ratio) - low) / (high - low)
    left = place > 0.6 or (mark.ratio < 1.0 and place > 0.25)
    axes.annotate(
        text, (min(ends) if left else max(ends), y), xytext=(-9 if left else 9, 0), textcoords="offset points",
        va="center", ha="right" if left else "left", fontsize=11, gid=notes.add(slot=mark.role),
        bbox={"facecolor": PAPER, "edgecolor": "none", "pad": 0.5, "alpha": 0.8},
    )  # fmt: skip


def ladder(key: str, groups: Sequence[tuple[str, Sequence[Bar]]], width: float) -> Markup:
    """Plot the ladder of lost time as bars from zero, group by group; the width is in pixels."""
    pitch = 64 if width < NARROW else 40  # from bar to bar
    notes = Notes()
    places = [k for k, (head, bars) in enumerate(groups) for _ in (*bars, *[None] * bool(head))]
    with mpl.rc_context(RC):
        figure = sized(width, pitch * (len(places) - 0.15 * sum(bool(head) for head, _ in groups)) + 52)
        axes = figure.subplots()
        margins(figure, 14, 6, 42, 4)
        axes.tick_params(length=0)
        y = 0.0
        for head, bars in groups:
            if head:
                y += 0.2 * bool(y)
                axes.axhline(y - 0.75, color=GRID, linewidth=1.0)
                axes.annotate(head, (0.0, y - 0.45), va="center", fontweight="bold", fontsize=12.5)
                y += 0.65
            for bar in bars:
                _rung(axes, bar, y, pitch, width, notes)
                y += 1.0
        room = (width - 20) / (width - 198)  # for the value beside the longest bar
        longest = max(bar.seconds for _, bars in groups for bar in bars)
        axes.set(xlim=(0, room * longest), ylim=(y - 0.5, -0.85), yticks=[], xlabel="total time, s")
        axes.spines["left"].set_visible(False)
        return svg(
            figure,
            key,
            "The ladder of lost time",
            "Total time of every rung from the published result to the fastest known motion; the table beside it holds the same numbers.",
            notes,
        )


def _rung(axes: Axes, bar: Bar, y: float, pitch: float, width: float, notes: Notes) -> None:
    colour = INK if bar.slot is None else SERIES[bar.slot % len(SERIES)]
    axes.barh(
        y, bar.seconds, height=17 / pitch, facecolor=colour if bar.solid and not bar.hatch else "none", edgecolor=colour,
        hatch=bar.hatch, linestyle="-" if bar.solid else "--", linewidth=1.2,
    )[0].set_gid(notes.add(f"{bar.label}: {bar.value}\n{bar.note}".strip()))  # fmt: skip
    label = bar.label.replace(": ", ":\n", 1) if width < NARROW else bar.label
    axes.annotate(label, (0.0, y), xytext=(0, 11), textcoords="offset points", va="bottom")
    axes.annotate(bar.value, (bar.seconds, y), xytext=(6, 0), textcoords="offset points", va="center", weight="bold")


def segments(key: str, series: Sequence[Series], width: float) -> Markup:
    """Plot how each motion spends its time between the waypoints, as bars cut at the waypoints; the width is in pixels."""
    notes = Notes()
    with mpl.rc_context(RC):
        figure = sized(width, 46 * len(series) + 52)
        axes = figure.subplots()
        margins(figure, 14, 10, 42, 4)
        gridded(axes, "x")
        for level, each in enumerate(series):
            times = each.motion.waypoint_times
            for k, (start, end) in enumerate(pairwise(times)):
                axes.barh(
                    level, end - start, left=start, height=0.44, facecolor=SERIES[each.style], edgecolor=PAPER,
                    linewidth=1.2, alpha=0.85 if k % 2 == 0 else 0.5, hatch="" if k % 2 == 0 else "///",
                )[0].set_gid(notes.add(f"{each.label}\nsegment {k + 1}: {end - start:.4f} s, from {start:.4f} s to {end:.4f} s"))  # fmt: skip
            axes.annotate(each.label, (0.0, level - 0.25), xytext=(0, 2), textcoords="offset points", va="bottom")
        axes.set(ylim=(len(series) - 0.5, -0.85), yticks=[], xlabel="time, s")
        axes.spines["left"].set_visible(False)
        return svg(
            figure,
            key,
            "Time spent on every segment",
            f"Bars cut at the waypoints for {', '.join(each.label for each in series)}; the table holds the same numbers.",
            notes,
        )
