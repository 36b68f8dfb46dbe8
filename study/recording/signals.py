"""Positions, velocities, accelerations and jerks over time, their limits, and when a limit is active."""

from __future__ import annotations

import re

import numpy as np
import rerun as rr

from study.analysis.activity import Use, lane
from study.cases.library import Case
from study.judge import RATES
from study.problem import Floats
from study.recording.contents import NANOSECOND, PALETTE, Contents, Shown, in_seconds
from study.recording.pictures import FEW_COLUMNS, log_key
from study.recording.stream import LIMIT_COLOR, SIGNALS, entity, method_part, time_column
from study.trajectory import Motion

SEVERAL = (200, 200, 200)
"""Colour of a stretch of time over which several joints use up the same kind of limit."""


def log_signals(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write every method's `/q`, `/v`, `/a` and `/jerk` joint by joint, with limit lines and saturation marks."""
    log_key(stream, "methods", [(each.label, each.color) for each in contents.shown])
    log_key(stream, "featured", [(each.title, each.color) for each in contents.compared], FEW_COLUMNS)
    log_limits(stream, contents)
    names = contents.case.problem.joint_names
    for each in contents.shown:
        times = each.times(contents.samples)
        for order, signal in enumerate(SIGNALS):
            values = each.motion(in_seconds(times), order)
            for joint, name in enumerate(names):
                path = entity(signal, name, method_part(each.label))
                stream.log(path, rr.SeriesLines(names=each.label, colors=each.color, widths=1.5), static=True)
                stream.send_columns(path, time_column(times), rr.Scalars.columns(scalars=values[:, joint]))
        _log_marks(stream, contents, each)


def log_limits(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write the limit lines of every signal and joint that has limits."""
    for order in range(4):
        for joint in range(contents.case.problem.n_joints):
            _log_limit(stream, contents, order, joint)


def log_activity(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write one lane per method and kind of limit, see `lane_path`: the joints that use it up."""
    names = tuple(contents.case.problem.joint_names)
    log_key(stream, "joints", [(name, _lane_color(names, name)) for name in names] + [("several", SEVERAL)])
    for each in contents.shown:
        for order, rate in enumerate(RATES, start=1):
            changes = lane(each.uses, order, names)
            texts = [text for _, text in changes]
            path = lane_path(contents, rate, each)
            shown = sorted({text for text in texts if text})
            if not shown:
                continue
            stream.log(
                path, rr.StateConfiguration(values=shown, colors=[_lane_color(names, t) for t in shown]), static=True
            )
            whole = np.rint(np.array([t for t, _ in changes]) / NANOSECOND)
            end = np.floor(each.motion.duration / NANOSECOND)
            times = np.append(np.minimum(whole, end - 1), end)
            stream.send_columns(path, time_column(times), rr.StateChange.columns(state=[*texts, ""]))


def lane_path(contents: Contents, rate: str, each: Shown) -> str:
    """Entity path of a lane, which the viewer shows beside it: ordered by rank, and with nothing that needs an escape."""
    place = contents.shown.index(each) + 1
    return entity(rate, f"{place:02d}_{re.sub('[^A-Za-z0-9_.-]+', '_', each.label)}")


def limit_values(case: Case, order: int, joint: int) -> Floats | None:
    """Upper and lower limit of a signal of a joint, or None where there is no such limit."""
    limits = case.problem.limits
    if order == 0:
        pair = np.array([limits.upper[joint], limits.lower[joint]])
    else:
        pair = np.array([1.0, -1.0]) * limits.rates[order - 1, joint]
    return pair if np.isfinite(pair).all() else None


def _log_limit(stream: rr.RecordingStream, contents: Contents, order: int, joint: int) -> None:
    """Two rows, at the start and at the end of the longest motion: static scalars are not drawn."""
    pair = limit_values(contents.case, order, joint)
    if pair is None:
        return
    path = entity(SIGNALS[order], contents.case.problem.joint_names[joint], "_limit")
    style = rr.SeriesLines(names=["upper limit", "lower limit"], colors=[LIMIT_COLOR] * 2, widths=[1.0, 1.0])
    stream.log(path, style, static=True)
    ends = time_column(np.array([0, np.ceil(contents.longest / NANOSECOND)]))
    stream.send_columns(path, ends, rr.Scalars.columns(scalars=np.tile(pair, (2, 1))))


def _log_marks(stream: rr.RecordingStream, contents: Contents, each: Shown) -> None:
    """Put a marker where a limit is used up: at both ends and in the middle of every stretch."""
    for order, signal in enumerate(SIGNALS[1:], start=1):
        for joint, name in enumerate(contents.case.problem.joint_names):
            uses = [use for use in each.uses if (use.order, use.joint) == (order, joint)]
            if not uses:
                continue
            times = _mark_times(uses, each.motion)
            path = entity(signal, name, method_part(each.label), "saturated")
            style = rr.SeriesPoints(
                names=f"{each.label} at its limit", colors=each.color, markers="diamond", marker_sizes=4.0
            )
            stream.log(path, style, static=True)
            values = each.motion(in_seconds(times), order)[:, joint]
            stream.send_columns(path, time_column(times), rr.Scalars.columns(scalars=values))


def _mark_times(uses: list[Use], motion: Motion) -> np.ndarray:
    ends = np.array([[np.ceil(use.start / NANOSECOND), np.floor(use.end / NANOSECOND)] for use in uses])
    times = np.column_stack([ends, np.rint(ends.mean(axis=1))])
    return np.unique(np.clip(times, 0, np.floor(motion.duration / NANOSECOND)).astype(np.int64))


def _lane_color(names: tuple[str, ...], text: str) -> tuple[int, int, int]:
    """A joint's own colour, or light grey where several joints share the stretch."""
    return PALETTE[names.index(text) % len(PALETTE)] if text in names else SEVERAL
