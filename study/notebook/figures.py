"""Figures of one motion, for notebooks and scripts; the only file of this package that imports matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from study.errors import StudyError, short, unknown
from study.problem import Floats, JointLimits, Problem
from study.report.plot_style import sample_times
from study.trajectory import Motion

QUANTITIES = ("position", "velocity", "acceleration", "jerk")
UNITS = ("rad or m", "rad/s or m/s", "rad/s² or m/s²", "rad/s³ or m/s³")
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7a4fa3", "#7f7f7f")
"""Okabe and Ito's, with violet and grey for yellow and black: people with any colour vision tell them apart."""

DASHES = ("-", "--", "-.", ":")
MANY_JOINTS = 10
"""Up to so many joints are named in a legend."""

BEYOND = "#b8b8b8"
LOOK: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "time-optimal-study",
    "text.parse_math": False,
    "font.size": 9.0,
    "hatch.linewidth": 0.6,
    "hatch.color": BEYOND,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 9.0,
    "figure.facecolor": "white",
    "axes.facecolor": "white",
}
"""With a ground of its own, for dark notebooks."""


class Drawing(Figure):
    """A figure of matplotlib that a notebook draws by itself, without `%matplotlib`."""

    def _repr_svg_(self) -> str:
        buffer = io.StringIO()
        with mpl.rc_context(LOOK):
            self.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
        text = buffer.getvalue()
        return text[text.index("<svg") :]


def drawing(problem: Problem, motion: Motion, inches: tuple[float, float] = (9.0, 5.4)) -> Drawing:
    """Draw all joints: positions, and rates in percent of their limits.

    Parameters
    ----------
    problem : Problem
    motion : Motion
    inches : pair of float
        Width and height.
    """
    times = sample_times(motion)
    limits = [_bounds(problem, motion, times, order) for order in range(1, 4)]
    with mpl.rc_context(LOOK):
        figure = Drawing(figsize=inches, layout="constrained")
        panels = figure.subplots(2, 2, sharex=True).ravel()
        lines = _positions(panels[0], problem, motion, times, range(problem.n_joints))
        for order, (axes, pair) in enumerate(zip(panels[1:], limits, strict=True), start=1):
            _shares(axes, motion(times, order), times, pair, QUANTITIES[order])
        for axes in panels[2:]:
            axes.set_xlabel("time, s")
        if problem.n_joints <= MANY_JOINTS:
            figure.legend(lines, problem.joint_names, loc="outside lower center", ncols=5, frameon=False)
    return figure


def drawing_of_joint(problem: Problem, motion: Motion, joint: str | int) -> Drawing:
    """Draw one joint in its own units, with what lies beyond its limits hatched.

    Raises
    ------
    StudyError
        If there is no such joint.
    """
    number, times = _place(problem, joint), sample_times(motion)
    with mpl.rc_context(LOOK):
        figure = Drawing(figsize=(6.0, 7.0), layout="constrained")
        panels = figure.subplots(4, 1, sharex=True)
        _positions(panels[0], problem, motion, times, [number])
        _hatch(panels[0], problem.limits.lower[number], problem.limits.upper[number])
        for order, axes in enumerate(panels[1:], start=1):
            low, high = (side[:, number] for side in _bounds(problem, motion, times, order))
            axes.plot(times, motion(times, order)[:, number], **_line(number))
            axes.set_title(f"{QUANTITIES[order]}, {UNITS[order]}{'' if np.isfinite(high).any() else '; no limit'}")
            if np.isfinite(high).all() and np.isfinite(low).all():
                axes.set_ylim(1.15 * min(low.min(), axes.get_ylim()[0]), 1.15 * max(high.max(), axes.get_ylim()[1]))
                for edge, end in ((low, axes.get_ylim()[0]), (high, axes.get_ylim()[1])):
                    axes.fill_between(times, edge, end, facecolor="none", edgecolor=BEYOND, hatch="////", linewidth=0)
                    axes.plot(times, edge, color="black", linewidth=0.9)
        panels[-1].set_xlabel("time, s")
        figure.suptitle(problem.joint_names[number], x=0.02, ha="left", fontsize=10, fontweight="bold")
    return figure


def _place(problem: Problem, joint: str | int) -> int:
    names = list(problem.joint_names)
    if isinstance(joint, str):
        if joint not in names:
            raise unknown("joint", joint, names)
        return names.index(joint)
    if isinstance(joint, bool) or not isinstance(joint, int | np.integer) or not 0 <= joint < len(names):
        raise StudyError(f"a joint is a name or a place from 0 to {len(names) - 1}, got {short(joint)}")
    return int(joint)


def _bounds(problem: Problem, motion: Motion, times: Floats, order: int) -> tuple[Floats, Floats]:
    """Limits of a rate in both directions at every time, each of shape (n_times, n_joints)."""
    segments = np.searchsorted(motion.waypoint_times, times, side="right") - 1
    low, high = (np.tile(side[order - 1], (len(times), 1)) for side in _sides(problem.limits))
    for segment, limits in problem.segment_limits.items():
        inside = np.clip(segments, 0, problem.n_segments - 1) == segment
        own_low, own_high = (side[order - 1] for side in _sides(limits))
        low[inside], high[inside] = np.maximum(low[inside], own_low), np.minimum(high[inside], own_high)
    return low, high


def _sides(limits: JointLimits) -> tuple[Floats, Floats]:
    return limits.lowest_rates, limits.highest_rates


def _positions(axes: Axes, problem: Problem, motion: Motion, times: Floats, joints: Sequence[int]) -> list[Line2D]:
    values, lines = motion(times), []
    for joint in joints:
        look = _line(joint)
        lines += axes.plot(times, values[:, joint], **look)
        axes.plot(motion.waypoint_times, problem.waypoints[:, joint], "o", color=look["color"], markersize=3)
    axes.set_title(f"{QUANTITIES[0]}, {UNITS[0]}; dots: waypoints")
    return lines


def _line(joint: int) -> dict[str, Any]:
    """Style of a joint: other colours first, then other dashes."""
    dashes = DASHES[joint // len(COLORS) % len(DASHES)]
    return {"color": COLORS[joint % len(COLORS)], "linestyle": dashes, "linewidth": 1.2}


def _shares(axes: Axes, values: Floats, times: Floats, pair: tuple[Floats, Floats], name: str) -> None:
    """Plot a rate in percent of its limits; joints without one are left out, or shown in units where none has one."""
    low, high = pair
    limited = (np.isfinite(low) & np.isfinite(high)).any(axis=0)
    if not limited.any():
        for joint in range(values.shape[1]):
            axes.plot(times, values[:, joint], **_line(joint))
        axes.set_title(f"{name}, {UNITS[QUANTITIES.index(name)]}; no limit")
        return
    shares = 100.0 * np.where(values < 0, -values / low, values / high)
    for joint in np.flatnonzero(limited).tolist():
        axes.plot(times, shares[:, joint], **_line(joint))
    axes.set_title(f"{name}, % of the limit{'' if limited.all() else '; joints without one are left out'}")
    top = max(115.0, 1.05 * float(np.abs(shares[:, limited]).max()))
    axes.set_ylim(-top, top)
    _hatch(axes, -100.0, 100.0)


def _hatch(axes: Axes, low: float, high: float) -> None:
    """Hatch what lies beyond limits that are in sight."""
    bottom, top = axes.get_ylim()
    for limit, end in ((low, bottom), (high, top)):
        if bottom < limit < top:
            axes.axhspan(limit, end, facecolor="none", edgecolor=BEYOND, hatch="////", linewidth=0)
            axes.axhline(limit, color="black", linewidth=0.9)
    axes.set_ylim(bottom, top)
