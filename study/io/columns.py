"""Columns of a recording by their names: times, joints, rates, and everything else."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from study.files import as_written
from study.io.samples import Samples
from study.problem import Floats

TIME = re.compile(
    r"[#%\s]*_*((elapsed|rel|relative|sim|ros|unix|epoch|system|wall|log|local|record|recording|controller|robot|host)[ _.]*)?"
    r"(t|times?|time[ _]?stamps?|stamp|zeit|temps|elapsed|epoch|clock|(time|secs?)[ _]?(from|since)[ _]?start)"
    r"([ _]*[\[(]?\s*(?P<unit>s|secs?|seconds|ms|msecs?|milliseconds|us|µs|usecs?|microseconds|ns|nsecs?|nanoseconds)\s*[\])]?)?",
    re.IGNORECASE,
)
"""Names that recorders give the column of times; without a unit in seconds."""

UNITS = {"m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}
"""Seconds by the first letter of a unit."""

SINCE_1970 = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3))
"""Times above the first number are counted since 1970, in units of the second number, s."""

SECONDS = re.compile(r"([#%\s]*|.*[._/])(sec|secs|seconds)", re.IGNORECASE)
NANOSECONDS = re.compile(r"([#%\s]*|.*[._/])(nanosec|nanosecs|nsec|nsecs|nanoseconds)|%time", re.IGNORECASE)
OTHERS = re.compile(
    r"(field\.)?(header\.)?(seq|stamp|frame_id)|#?|id|idx|index|row|line|sample|step|count|counter|unnamed: \d+"
    r"|(next\.)?(reward|done)|(frame|episode|task)_index|.*(effort|torque|tau|current|temperature)s?[ _\[]*\d*\]?"
    r"|(actual|target)_(?!qd*_?\d).*|(field\.)?name\d+|jerk of .*",
    re.IGNORECASE,
)
"""Columns that recorders write beside positions and rates."""

UNIT = re.compile(r"(?P<name>.*?)\s*[\[(](?P<unit>rad|deg|m|mm)[\])]\s*")
"""Unit in a column's name, as in `elbow [deg]`."""


class Order(IntEnum):
    """Order of a column's time derivative."""

    POSITION = 0
    VELOCITY = 1
    ACCELERATION = 2


_ORDERS = {
    **dict.fromkeys(("q", "pos", "position", "positions"), Order.POSITION),
    **dict.fromkeys(("qd", "dq", "vel", "velocity", "velocities"), Order.VELOCITY),
    **dict.fromkeys(("qdd", "ddq", "acc", "accel", "acceleration", "accelerations"), Order.ACCELERATION),
}
_ORDER = f"(?P<order>{'|'.join(sorted(_ORDERS, key=len, reverse=True))})"
_STYLES = tuple(
    re.compile(style, re.IGNORECASE)
    for style in (
        r"(?P<order>velocity|acceleration) of (?P<name>.+)",
        rf"(?P<before>(?:.*[ ._/])?){_ORDER}[ ._/\[(]*(?P<number>\d+)[\])]?",
        rf"(?P<name>.+?)[ ._/]{_ORDER}(?P<unit> *[\[(].*[\])])?",
    )
)


@dataclass
class _Layout:
    """Indices of columns by what they hold."""

    seconds: dict[int, float] = field(default_factory=dict)
    nanoseconds: list[int] = field(default_factory=list)
    others: list[int] = field(default_factory=list)
    joints: dict[Order, dict[str, int]] = field(default_factory=lambda: {order: {} for order in Order})


def sampled_columns(header: Sequence[str], values: Floats) -> Samples:
    """Sort the columns of a table with a header.

    Parameters
    ----------
    header : sequence of str
    values : array of shape (n_rows, n_columns)
    """
    names = [as_written(name.strip()) for name in header]
    joints = _as_exported(names)
    if joints:
        parts = np.hsplit(values[:, 1:], (len(names) - 1) // len(joints))
        accelerations = parts[2] if len(parts) > 2 else None
        return Samples(parts[0], joints, times=values[:, 0], velocities=parts[1], accelerations=accelerations)
    layout = _layout(names)
    positions, notes = layout.joints[Order.POSITION], list[str]()
    if not positions:  # a table of nothing but rates and times holds columns that happen to be named so
        positions = {names[k]: k for k in range(len(names)) if k not in (*layout.seconds, *layout.nanoseconds)}
        layout.joints, layout.others = {Order.POSITION: positions, Order.VELOCITY: {}, Order.ACCELERATION: {}}, []
    rates = {order: _matching(layout.joints[order], positions) for order in (Order.VELOCITY, Order.ACCELERATION)}
    times = _times(layout, names, values, notes)
    if layout.others:
        notes.append(f"not used: column {', '.join(repr(names[k]) for k in sorted(layout.others)[:8])}")
    unmatched = [order for order in rates if layout.joints[order] and rates[order] is None]
    notes += [
        f"not used: columns of {order.name.lower()}, which do not belong to the same joints" for order in unmatched
    ]
    if times is None and len(values) > 2 and (np.diff(values[:, 0]) > 0).all() and 0 in positions.values():
        notes.append(f"column {names[0]!r} only grows; if it holds times, name it 'time'")
    columns = {order: None if index is None else values[:, index] for order, index in rates.items()}
    titles, units = _titles(positions, names)
    return Samples(
        positions=values[:, list(positions.values())],
        names=titles,
        times=times,
        velocities=columns[Order.VELOCITY],
        accelerations=columns[Order.ACCELERATION],
        notes=tuple(notes),
        units=units,
    )


def _as_exported(names: Sequence[str]) -> tuple[str, ...]:
    """Joints of a table that `study.io.export` wrote with rates, whatever they are called; none of another table."""
    rates = sum(name.startswith("velocity of ") for name in names)
    joints = tuple(names[1 : rates + 1])
    blocks = [f"{kind} of {name}" for kind in ("velocity", "acceleration") for name in joints]
    return joints if rates and names[0] == "time" and list(names[1 + rates :]) in (blocks[:rates], blocks) else ()


def _layout(names: Sequence[str]) -> _Layout:
    layout = _Layout()
    styled = [_styled(name) for name in names]
    suffixed = any(part is not None and part[0] is not Order.POSITION for part in styled)
    every = all(part is not None for part, name in zip(styled, names, strict=True) if not is_time(name))
    measured_first = sorted(range(len(names)), key=lambda index: names[index].lower().startswith("target"))
    for index in measured_first:
        name, part = names[index], styled[index]
        if NANOSECONDS.fullmatch(name):
            layout.nanoseconds.append(index)
        elif (time := TIME.fullmatch(name)) or SECONDS.fullmatch(name):
            layout.seconds[index] = UNITS.get((time["unit"] or "s")[0].lower(), 1.0) if time else 1.0
        elif part is not None and (part[0] is not Order.POSITION or suffixed or every):
            if layout.joints[part[0]].setdefault(part[1], index) != index:
                layout.others.append(index)
        elif OTHERS.fullmatch(name) or layout.joints[Order.POSITION].setdefault(name, index) != index:
            layout.others.append(index)
    return layout


def is_time(name: str) -> bool:
    """Whether a column of this name holds times."""
    return any(pattern.fullmatch(name.strip()) for pattern in (TIME, SECONDS, NANOSECONDS))


def _styled(name: str) -> tuple[Order, str] | None:
    """Order of a column and what it has in common with the joint's other columns."""
    for pattern in _STYLES:
        if match := pattern.fullmatch(name):
            parts, order = match.groupdict(), _ORDERS[match["order"].lower()]
            if "number" not in parts:
                return order, parts["name"] + (parts.get("unit") or "")
            return order, re.sub("^(actual|target)_", "", parts["before"], flags=re.IGNORECASE) + parts["number"]
    return None


def _titles(positions: dict[str, int], header: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the joints: without the folders that all of them share, and with their units apart."""
    names = [
        header[k] if key[-1:].isdigit() and _STYLES[1].fullmatch(header[k]) else key for key, k in positions.items()
    ]
    shared = [name.rpartition("/")[2] for name in names]
    if all("/" in name for name in names) and len(set(shared)) == len(names):
        names = shared
    matches = [UNIT.fullmatch(name) for name in names]
    bare = tuple(match["name"] or name if match else name for match, name in zip(matches, names, strict=True))
    if all(name.isdigit() for name in names) or len(set(bare)) < len(names):
        return (() if len(set(bare)) == len(names) else tuple(names)), ()
    units = tuple(match["unit"] if match else "" for match in matches)
    return bare, units if any(units) else ()


def _matching(columns: dict[str, int], positions: dict[str, int]) -> list[int] | None:
    return [columns[name] for name in positions] if columns and set(positions) <= set(columns) else None


def _times(layout: _Layout, names: Sequence[str], values: Floats, notes: list[str]) -> Floats | None:
    """Times in seconds: of a column of seconds, of seconds and nanoseconds together, or of nanoseconds alone."""
    if not layout.seconds and not layout.nanoseconds:
        return None
    first = next(iter(layout.seconds), None)
    whole, factor = (np.zeros(len(values)), 1.0) if first is None else (values[:, first], layout.seconds[first])
    plain = not layout.nanoseconds or (first is not None and bool((np.diff(whole) % 1 != 0).any()))
    used = {first, None if plain else layout.nanoseconds[0]}
    layout.others += sorted({*layout.seconds, *layout.nanoseconds} - used)
    if not plain:
        return (whole - whole[0]) + values[:, layout.nanoseconds[0]] * 1e-9
    if factor == 1.0 and (since := next((unit for least, unit in SINCE_1970 if whole[0] > least), None)):
        notes.append(f"column {names[first or 0]!r} is taken for times since 1970 in steps of {since:g} s")
        return (whole - whole[0]) * since
    return whole * factor
