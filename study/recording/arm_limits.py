"""Torques and the tool's speed and acceleration over time, with their limits."""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from study.arm import ArmLimits
from study.demands import Demand
from study.problem import Floats
from study.recording.contents import NANOSECOND, Contents, Shown, in_seconds
from study.recording.stream import LIMIT_COLOR, entity, method_part, time_column

ROOT = "arm"
TORQUE, SPEED, ACCELERATION = "torque, share of the limit", "tool speed, m/s", "tool acceleration, m/s²"


def log_arm_limits(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write every method's largest share of a torque limit and its tool's rates, with limit lines; nothing without limits."""
    limits = contents.case.problem.arm
    if limits is None:
        return
    ends = time_column(np.array([0, np.ceil(contents.longest / NANOSECOND)]))
    for name, limit in limited(limits).items():
        path = entity(ROOT, name, "_limit")
        stream.log(path, rr.SeriesLines(names="limit", colors=LIMIT_COLOR, widths=1.0), static=True)
        stream.send_columns(path, ends, rr.Scalars.columns(scalars=np.full(2, limit)))
    for each in contents.shown:
        times = each.times(contents.samples)
        for name, values in _values(limits, each, in_seconds(times)).items():
            path = entity(ROOT, name, method_part(each.label))
            stream.log(path, rr.SeriesLines(names=each.label, colors=each.color, widths=1.5), static=True)
            stream.send_columns(path, time_column(times), rr.Scalars.columns(scalars=values))


def limited(limits: ArmLimits) -> dict[str, float]:
    """Names of what is limited and drawn, with the height of the limit line."""
    kinds = {
        TORQUE: (Demand.TORQUE, 1.0),
        SPEED: (Demand.TOOL_SPEED, limits.tool_speed),
        ACCELERATION: (Demand.TOOL_ACCELERATION, limits.tool_acceleration),
    }
    return {name: height for name, (demand, height) in kinds.items() if demand in limits.demands}


def arm_views(contents: Contents) -> list[rrb.Vertical]:
    """One tab with a plot of each limit of the arm; none where the arm is not limited."""
    limits = contents.case.problem.arm
    if limits is None:
        return []
    plots = [
        rrb.TimeSeriesView(
            name=f"{name[0].upper()}{name[1:]}",
            origin=entity(ROOT, name),
            contents="$origin/**",
            plot_legend=rrb.PlotLegend(visible=False),
        )
        for name in limited(limits)
    ]
    return [rrb.Vertical(*plots, name="Torque and tool")]


def _values(limits: ArmLimits, each: Shown, seconds: Floats) -> dict[str, Floats]:
    arm = limits.mechanism
    rates = [each.motion(seconds, order) for order in range(3)]
    speed, acceleration = (np.linalg.norm(rate, axis=1) for rate in arm.tool_rates(*rates))
    torque = (np.abs(arm.torque(*rates)) / limits.torque).max(axis=1)
    values = {TORQUE: torque, SPEED: speed, ACCELERATION: acceleration}
    return {name: values[name] for name in limited(limits)}
