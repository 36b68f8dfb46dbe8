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
    r"[#%\s]*(t|time|times|timestamp|stamp|zeit|temps|time[ _]?from[ _]?start|t_?s|time_?s|elapsed)"
    r"(\s*[\[(]?\s*(?P<unit>s|sec|secs|seconds|ms|us|ns)\s*[\])]?)?",
    re.IGNORECASE,
)
"""Names that recorders give the column of times; without a unit in seconds."""

UNITS = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}

SECONDS = re.compile(r"([#%\s]*|.*[._/])(sec|secs|seconds)", re.IGNORECASE)
NANOSECONDS = re.compile(
    r"([#%\s]*|.*[._/])(nanosec|nanosecs|nsec|nsecs|nanoseconds)|%time|time_?ns|t_?ns", re.IGNORECASE
)
OTHERS = re.compile(
    r"(field\.)?(header\.)?(seq|stamp|frame_id)|index|row|(frame|episode|task)_index|.*(effort|torque|current|temperature)s?\d*"
    r"|(actual|target)_(?!qd*_?\d).*|(field\.)?name\d+|jerk of .*",
    re.IGNORECASE,
)
"""Columns that recorders write beside positions and rates."""


class Order(IntEnum):
    """Order of a column's time derivative."""

    POSITION = 0
    VELOCITY = 1
    ACCELERATION = 2


_STYLES = (
    (re.compile(r"(?P<order>velocity|acceleration) of (?P<name>.+)"), {"velocity": 1, "acceleration": 2}),
    (re.compile(r"(?:actual|target)_(?P<order>q|qd|qdd)_?(?P<name>\d+)"), {"q": 0, "qd": 1, "qdd": 2}),
    (
        re.compile(r"field\.(?P<order>position|velocity|acceleration)(?P<name>\d+)"),
        {"position": 0, "velocity": 1, "acceleration": 2},
    ),
    (
        re.compile(
            r"(?P<name>.+?)[ ._/](?P<order>pos|position|vel|velocity|acc|accel|acceleration)(?P<unit> *[\[(].*[\])])?",
            re.IGNORECASE,
        ),
        {"pos": 0, "position": 0, "vel": 1, "velocity": 1, "acc": 2, "accel": 2, "acceleration": 2},
    ),
)


@dataclass
class _Layout:
    """Indices of columns by what they hold."""

    factor: float = 1.0
    seconds: list[int] = field(default_factory=list)
    nanoseconds: list[int] = field(default_factory=list)
    others: list[int] = field(default_factory=list)
    joints: dict[Order, dict[str, int]] = field(default_factory=lambda: {order: {} for order in Order})


def sampled_columns(header: Sequence[str], values: Floats) -> Samples:
    """Sort the columns of a table with a header.

    Parameters
    ----------
    header : sequence of str
    values : array of shape (n_rows, n_columns)
        Not a number in columns of text.
    """
    names = [as_written(name.strip()) for name in header]
    layout = _layout(names)
    positions, notes = layout.joints[Order.POSITION], []
    if not positions:  # a table of nothing but rates and times holds columns that happen to be named so
        positions = {names[k]: k for k in range(len(names)) if k not in (*layout.seconds, *layout.nanoseconds)}
        layout.joints, layout.others = {Order.POSITION: positions, Order.VELOCITY: {}, Order.ACCELERATION: {}}, []
    rates = {order: _matching(layout.joints[order], positions) for order in (Order.VELOCITY, Order.ACCELERATION)}
    if layout.others:
        notes.append(f"not used: column {', '.join(repr(names[k]) for k in layout.others[:8])}")
    unmatched = [order for order in rates if layout.joints[order] and rates[order] is None]
    notes += [
        f"not used: columns of {order.name.lower()}, which do not belong to the same joints" for order in unmatched
    ]
    times = _times(layout, values)
    if times is None and len(values) > 2 and (np.diff(values[:, 0]) > 0).all() and 0 in positions.values():
        notes.append(f"column {names[0]!r} only grows; if it holds times, name it 'time'")
    columns = {order: None if index is None else values[:, index] for order, index in rates.items()}
    numbered = all(name.isdigit() for name in positions)
    return Samples(
        positions=values[:, list(positions.values())],
        names=() if numbered else tuple(positions),
        times=times,
        velocities=columns[Order.VELOCITY],
        accelerations=columns[Order.ACCELERATION],
        notes=tuple(notes),
    )


def _layout(names: Sequence[str]) -> _Layout:
    layout = _Layout()
    styled = [_styled(name) for name in names]
    suffixed = any(part is not None and part[0] is not Order.POSITION for part in styled)
    every = all(part is not None for part, name in zip(styled, names, strict=True) if not _is_time(name))
    for index, (name, part) in enumerate(zip(names, styled, strict=True)):
        if NANOSECONDS.fullmatch(name):
            layout.nanoseconds.append(index)
        elif (time := TIME.fullmatch(name)) or SECONDS.fullmatch(name):
            layout.factor = UNITS.get((time["unit"] or "").lower(), 1.0) if time else 1.0
            layout.seconds.append(index)
        elif part is not None and (part[0] is not Order.POSITION or suffixed or every):
            if layout.joints[part[0]].setdefault(part[1], index) != index:
                layout.others.append(index)
        elif OTHERS.fullmatch(name):
            layout.others.append(index)
        else:
            layout.joints[Order.POSITION].setdefault(name, index)
    return layout


def _is_time(name: str) -> bool:
    return any(pattern.fullmatch(name) for pattern in (TIME, SECONDS, NANOSECONDS))


def _styled(name: str) -> tuple[Order, str] | None:
    for pattern, orders in _STYLES:
        if match := pattern.fullmatch(name):
            parts = match.groupdict()
            return Order(orders[parts["order"].lower()]), parts["name"] + (parts.get("unit") or "")
    return None


def _matching(columns: dict[str, int], positions: dict[str, int]) -> list[int] | None:
    return [columns[name] for name in positions] if columns and set(positions) <= set(columns) else None


def _times(layout: _Layout, values: Floats) -> Floats | None:
    """Times in seconds: of a column of seconds, of seconds and nanoseconds together, or of nanoseconds alone."""
    if not layout.seconds and not layout.nanoseconds:
        return None
    whole = values[:, layout.seconds[0]] if layout.seconds else np.zeros(len(values))
    if not layout.nanoseconds or (layout.seconds and (np.diff(whole) % 1 != 0).any()):
        return whole * layout.factor
    return (whole - whole[0]) + values[:, layout.nanoseconds[0]] * 1e-9
