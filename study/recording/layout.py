"""Layout of the viewer: an overview, then one tab per signal, activity, convergence and durations."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from study.cases.library import Case
from study.judge import RATES
from study.recording.contents import NANOSECOND, Contents, Shown
from study.recording.pictures import (
    LADDER_ROOM,
    Bounds,
    bars_bounds,
    bars_pitch,
    curves_bounds,
    key_bounds,
    key_height,
)
from study.recording.scene import OBSTACLES, Look, Scene
from study.recording.signals import limit_values
from study.recording.stream import SIGNALS, TIMELINE, entity, method_part
from study.recording.summary import history, ladder_bars

TITLES = ("Position", "Velocity", "Acceleration", "Jerk")
Part = rrb.View | rrb.Container


def layout(contents: Contents, scene: Scene | None, populations: Sequence[Part] = ()) -> rrb.Blueprint:
    """Arrange the views of a recording, those of search populations among them; the compared motions run, in a loop.

    Where the cursor stands cannot be said in a layout, and the viewer puts it at the end; what runs begins at the start.
    """
    tabs: list[Part] = [_overview(contents, scene), *(_signal_tab(contents, order) for order in range(4))]
    tabs += _activity(contents)
    tabs += [*_convergence(contents), *populations]
    count = len(contents.shown)
    tabs.append(drawing("Durations", "durations", bars_bounds(count, bars_pitch(count))))
    if scene is not None:
        if len(contents.case.obstacles):
            tabs.append(rrb.TimeSeriesView(name="Distance to obstacles, m", origin="clearance"))
        tabs.append(rrb.Grid(*(_arm(each, scene.every) for each in contents.shown), name="All arms"))
    return rrb.Blueprint(
        rrb.Tabs(*tabs, active_tab=0),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(
            timeline=TIMELINE,
            state="collapsed",
            play_state="playing",
            loop_mode="selection",
            time_selection=rrb.components.AbsoluteTimeRange(0, math.ceil(contents.run_time / NANOSECOND)),
        ),
        auto_layout=False,
        auto_views=False,
    )


def _overview(contents: Contents, scene: Scene | None) -> rrb.Container:
    rungs = len(ladder_bars(contents))
    words = rrb.Vertical(
        rrb.TextDocumentView(name="Summary", origin="summary"),
        drawing("Ladder of lost time", "ladder", bars_bounds(rungs, bars_pitch(rungs, LADDER_ROOM))),
        row_shares=[3, 2],
    )
    plots = rrb.Horizontal(
        *(_plot(contents, order, joint, contents.compared) for order, joint in active_signals(contents))
    )
    if scene is None:
        return rrb.Horizontal(words, plots, column_shares=[2, 3], name="Overview")
    first = [_arm(each, scene.first) for each in contents.first_look]
    arms = rrb.Grid(*first, grid_columns=min(3, (len(first) + 1) // 2))
    return rrb.Horizontal(words, rrb.Vertical(arms, plots, row_shares=[3, 2]), column_shares=[2, 3], name="Overview")


def active_signals(contents: Contents, wanted: int = 3) -> list[tuple[int, int]]:
    """Orders and joints whose limits the first look's methods use longest; velocities fill up where there are few."""
    shares: dict[tuple[int, int], float] = {}
    for each in contents.compared:
        for use in each.uses:
            key = (use.order, use.joint)
            shares[key] = shares.get(key, 0.0) + (use.end - use.start) / each.motion.duration
    ranked = sorted(shares, key=lambda key: (-shares[key], key))[:wanted]
    others = [(1, joint) for joint in range(contents.case.problem.n_joints)]
    return sorted(list(dict.fromkeys([*ranked, *others]))[:wanted])


def _signal_tab(contents: Contents, order: int) -> rrb.Container:
    joints = range(contents.case.problem.n_joints)
    plots = rrb.Grid(*(_plot(contents, order, joint) for joint in joints))
    return under_key("Methods", "methods", len(contents.shown), [plots], TITLES[order])


def under_key(name: str, origin: str, count: int, rows: Sequence[Part], title: str) -> rrb.Vertical:
    """Put rows of equal height below a key, which gets the height that so many names need."""
    key, height = drawing(name, origin, key_bounds(count)), key_height(count)
    return rrb.Vertical(key, *rows, row_shares=[height, *[(1.0 - height) / len(rows)] * len(rows)], name=title)


def _plot(contents: Contents, order: int, joint: int, only: Sequence[Shown] = ()) -> rrb.TimeSeriesView:
    """Plot one signal of one joint, of all methods or only of some."""
    case = contents.case
    joint_name = case.problem.joint_names[joint]
    unit = case.units[joint] + ("", "/s", "/s²", "/s³")[order]
    within = [f"+ {entity(SIGNALS[order], joint_name, method_part(each.label))}/**" for each in only]
    limit = f"+ {entity(SIGNALS[order], joint_name, '_limit')}"
    free = "" if order == 0 or limit_values(case, order, joint) is not None else " (no limit)"
    return rrb.TimeSeriesView(
        name=f"{TITLES[order]} of {joint_name}, {unit}{free}",
        origin=entity(SIGNALS[order], joint_name),
        contents=[limit, *within] if only else "$origin/**",
        plot_legend=rrb.PlotLegend(visible=False),
        axis_x=_time_axis(max(each.motion.duration for each in only)) if only else None,
        axis_y=_axis(case, order, joint),
    )


def _time_axis(end: float) -> rrb.TimeAxis:
    """Show time from the start to the end of what is compared."""
    first, last = rr.TimeRangeBoundary.absolute(seconds=0.0), rr.TimeRangeBoundary.absolute(seconds=1.02 * end)
    return rrb.TimeAxis(link="Independent", view_range=rr.TimeRange(start=first, end=last))


def _axis(case: Case, order: int, joint: int) -> rrb.ScalarAxis | None:
    """Keep a rate within sight of its limits, whatever an infeasible method does; positions fit themselves."""
    pair = limit_values(case, order, joint)
    if order == 0 or pair is None:
        return None
    return rrb.ScalarAxis(range=(1.2 * pair[1], 1.2 * pair[0]), zoom_lock=False)


def _arm(each: Shown, look: Look) -> rrb.Spatial3DView:
    """Look at one method's arm; every arm on a tab is seen from the same place."""
    eye = rrb.EyeControls3D(position=look.eye, look_target=look.target, eye_up=(0.0, 0.0, 1.0))
    parts = ["$origin/**", f"+ {OBSTACLES}"]
    return rrb.Spatial3DView(
        name=each.title, origin=entity("arms", method_part(each.label)), contents=parts, eye_controls=eye
    )


def drawing(name: str, origin: str, bounds: Bounds) -> rrb.Spatial2DView:
    """Show a drawing that does not depend on time, all of it."""
    limits = rrb.VisualBounds2D(x_range=bounds[0], y_range=bounds[1])
    return rrb.Spatial2DView(name=name, origin=origin, visual_bounds=limits)


def _convergence(contents: Contents) -> list[Part]:
    """The drawings; the series themselves are in the file too, but would stay empty on the timeline that is active."""
    searches = sum(len(history(each)[0]) > 0 for each in contents.methods)
    if not searches or not np.isfinite(contents.best):
        return []
    return [
        drawing(name, where, curves_bounds(searches))
        for name, where in (("Convergence", "convergence_curves"), ("Convergence over wall time", "convergence_times"))
    ]


def _activity(contents: Contents) -> list[Part]:
    used = {use.order for each in contents.shown for use in each.uses}
    lanes = [
        rrb.StateTimelineView(
            name=f"Joints at their {rate} limit, a lane for every method", origin=entity("activity", rate)
        )
        for order, rate in enumerate(RATES, start=1)
        if order in used
    ]
    if not lanes:
        return []
    return [under_key("Joints", "joints", contents.case.problem.n_joints + 1, lanes, "Limits in use")]
