"""Data of the figures that answer to the pointer: values under the cursor, methods switched on and off, stretches enlarged.

Each stands in its page as JSON; `report.js` draws it with uPlot. A page without the scripts, without JavaScript or on paper
shows the static figure beside it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from study.problem import Floats, Problem
from study.report.plot_style import QUANTITIES, RATE_UNITS, STROKES, Convergence, Series, rate_top

POINTS = 400
"""Instants at which profiles are given; about two pixels of a wide page."""

DIGITS = 5


@dataclass(frozen=True)
class Line:
    """A method of a figure: name, slot (None: grey), what is said beside it, whether it is hidden at first, where it ends."""

    name: str
    slot: int | None
    note: str = ""
    hidden: bool = False
    end: float | None = None


@dataclass(frozen=True)
class Look:
    """Axes and words of a figure.

    Attributes
    ----------
    name : str
    unit : str
        Name of the unit of what runs to the right, as in `At 1.2 s`.
    idle : str
        Caption of the values without a cursor.
    height : int
        Of every panel, pixels.
    columns : int
        Panels side by side on a wide page.
    choice : str
        Name of what the views are a choice of.
    log : (bool, bool)
        Whether the axes are logarithmic.
    form : str
        `plain`, or `percent` for shares.
    bands : bool
        Whether every line has a band, given as two more rows.
    across : str
        Label of the axis to the right.
    """

    name: str
    unit: str
    idle: str
    height: int = 300
    columns: int = 1
    choice: str = ""
    log: tuple[bool, bool] = (False, False)
    form: str = "plain"
    bands: bool = False
    across: str = ""


def over_evaluations(name: str, idle: str, height: int) -> Look:
    """Times above the best known with their quartiles against evaluations, both logarithmic."""
    return Look(
        name, "evaluations", idle, height, log=(True, True), form="percent", bands=True, across="curve evaluations"
    )


def share_over(name: str, unit: str) -> Look:
    """Shares in percent against a cost on a logarithmic axis."""
    return Look(name, unit, "At the end.", 380, log=(True, False), form="percent", across=unit)


Panel = Mapping[str, Any]


def profiles_data(
    problem: Problem, units: Sequence[str], series: Sequence[Series], notes: Mapping[str, str], hidden: bool = False
) -> Markup:
    """Position, velocity, acceleration and jerk of every joint.

    Parameters
    ----------
    problem : Problem
    units : sequence of str
        Of every joint, `rad` or `m`.
    series : sequence of Series
    notes : mapping of str to str
        What is said beside a method, by its label.
    hidden : bool
        Whether all methods but the first are switched off at first.
    """
    ends = [each.motion.duration for each in series]
    times = np.union1d(np.linspace(0.0, max(ends), POINTS), ends)
    values = [
        [_within(each.motion(times, order), times, end) for each, end in zip(series, ends, strict=True)]
        for order in range(4)
    ]
    views = []
    for joint, name in enumerate(problem.joint_names):
        panels = [_panel(problem, joint, units[joint], order, values[order], series) for order in range(4)]
        views.append({"name": name, "panels": panels})
    lines = [
        Line(
            each.label,
            each.style,
            f"{each.motion.duration:.4f} s {notes.get(each.label, '')}",
            hidden and k > 0,
            each.motion.duration,
        )
        for k, each in enumerate(series)
    ]
    idle = "Largest values; point at a figure for those of one instant."
    return _written(Look("profiles", "s", idle, 230, 2, "Joint", across="time, s"), lines, views, times)


def _within(values: Floats, times: Floats, end: float) -> Floats:
    return np.where(times[:, None] <= end, values, np.nan)


def _panel(
    problem: Problem, joint: int, unit: str, order: int, values: Sequence[Floats], series: Sequence[Series]
) -> Panel:
    limits = problem.limits
    rows = [row[:, joint] for row in values]
    panel: dict[str, Any] = {
        "title": f"{QUANTITIES[order]}, {unit}{RATE_UNITS[order]}",
        "short": QUANTITIES[order],
        "y": [*map(_numbers, rows)],
    }
    if order == 0:
        dots = np.column_stack([series[0].motion.waypoint_times, problem.waypoints[:, joint]])
        panel |= {
            "dots": [_numbers(dot) for dot in dots],
            "limits": _numbers([limits.lower[joint], limits.upper[joint]]),
        }
    else:
        limit = float(limits.rates[order - 1, joint])
        top = rate_top(limit, [float(np.nanmax(np.abs(row))) for row in rows])
        panel |= {"limits": _numbers([-limit, limit]), "range": _numbers([-top, top])}
    return panel


def convergence_data(curves: Sequence[Convergence], shortest: float) -> Markup:
    """Time above the shortest known, median and quartiles, against evaluations."""
    rows = []
    for curve in curves:
        shares = [np.maximum(line / shortest - 1.0, 1e-6) for line in (curve.median, curve.lower, curve.upper)]
        rows.append([_numbers(curve.evaluations), *map(_numbers, shares)])
    panel: dict[str, Any] = {
        "title": "time above the shortest known, median and quartiles",
        "short": "above",
        "y": rows,
    }
    idle = "At the end; point at the figure for other numbers of evaluations."
    look = over_evaluations("convergence", idle, 380)
    return _written(look, [Line(curve.label, curve.style) for curve in curves], [{"name": "", "panels": [panel]}])


def steps_data(
    look: Look, lines: Sequence[Line], title: str, short: str, rows: Iterable[Sequence[Iterable[float]]]
) -> Markup:
    """One panel of steps: for every line its places on the axis and its values there, with a band two rows more."""
    panel: dict[str, Any] = {"title": title, "short": short, "y": [[_numbers(part) for part in row] for row in rows]}
    return _written(look, lines, [{"name": "", "panels": [panel]}])


def answering(data: Markup, static: Markup) -> Markup:
    """Contents of a figure with its data and what stands in its place on paper and without scripts."""
    return data + Markup('<div class="static">{}</div>').format(static)


def _numbers(values: Iterable[float]) -> list[float | None]:
    """Numbers as short as they may be; null for what is not finite."""
    return [float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None for value in np.asarray(values, dtype=float)]


def _written(look: Look, lines: Sequence[Line], views: Sequence[Mapping[str, Any]], x: Floats | None = None) -> Markup:
    series = [
        {
            "name": line.name,
            "note": line.note.strip(),
            "color": "muted" if line.slot is None else f"s{line.slot + 1}",
            "dash": "" if line.slot is None else STROKES[line.slot],
            "thin": line.slot is None,
            "off": line.hidden,
            "end": line.end,
        }
        for line in lines
    ]
    axes = {"log": {"x": look.log[0], "y": look.log[1]}, "x": None if x is None else _numbers(x)}
    return data_element({**vars(look), **axes, "series": series, "views": views})


def data_element(content: Mapping[str, Any], name: str = "") -> Markup:
    """Write data as JSON into a page, for `report.js`; the class of the element is its name."""
    text = json.dumps(content, allow_nan=False, separators=(",", ":"))
    safe = text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
    kind = f' class="{name}"' if name else ""
    return Markup(f'<script type="application/json"{kind}>{safe}</script>')  # noqa: S704 - no letter of it can end the element
