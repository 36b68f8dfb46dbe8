"""Layout of the viewer: an overview, then one tab per signal, activity, convergence and durations."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from study.cases.library import Case
from study.judge import RATES
from study.recording.arm_limits import arm_views
from study.recording.contents import NANOSECOND, Contents, Shown
from study.recording.meshes import MESHES
from study.recording.pictures import (
    FEW_COLUMNS,
    KEY_COLUMNS,
    LADDER_ROOM,
    Bounds,
    bars_bounds,
    bars_pitch,
    curves_bounds,
    key_bounds,
    key_height,
)
from study.recording.scene import OBSTACLES, Look, Scene
from study.recording.signals import lane_path, limit_values
from study.recording.stream import SIGNALS, TIMELINE, entity, method_part
from study.recording.summary import history, ladder_bars

TITLES = ("Position", "Velocity", "Acceleration", "Jerk")
Part = rrb.View | rrb.Container


def layout(contents: Contents, scene: Scene | None, populations: Sequence[Part] = ()) -> rrb.Blueprint:
    """Arrange the views of a recording, those of search populations among them; the compared motions run, in a loop.

    Where the cursor stands cannot be said in a layout, and the viewer puts it at the end; what runs begins at the start.
    """
    tabs: list[Part] = [_overview(contents, scene), *(_signal_tab(contents, order) for order in range(4))]
    tabs += [*arm_views(contents), *_activity(contents)]
    tabs += [*_convergence(contents), *populations]
    count = len(contents.shown)
    tabs.append(drawing("Durations", "durations", bars_bounds(count, bars_pitch(count))))
    if scene is not None:
        if len(contents.case.obstacles):
            tabs.append(_clearance(contents.shown))
        tabs.append(rrb.Grid(*(_arm(each, scene.every, scene) for each in contents.shown), name="All arms"))
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
    near = scene is not None and len(contents.case.obstacles) > 0
    signals = active_signals(contents, 2 if near else 3)
    views = [_plot(contents, order, joint, contents.compared) for order, joint in signals]
    plots = rrb.Horizontal(*views, *[_clearance(contents.compared)] * near)
    key, height = drawing("Colours", "featured", key_bounds(len(contents.compared), FEW_COLUMNS)), 0.09
    if scene is None:
        arms: Part = rrb.TextDocumentView(name="No arm", origin="no_arm")
    else:
        arms = _first_arms(contents, scene)
    shares = [0.6 if scene is not None else 0.2, height, 0.4 if scene is not None else 0.8]
    return rrb.Horizontal(
        words, rrb.Vertical(arms, key, plots, row_shares=shares), column_shares=[2, 3], name="Overview"
    )


def arms_alone(contents: Contents, scene: Scene) -> rrb.Blueprint:
    """Lay out the first look's arms, and nothing else."""
    panels = rrb.BlueprintPanel(state="hidden"), rrb.SelectionPanel(state="hidden"), rrb.TopPanel(state="hidden")
    time = rrb.TimePanel(timeline=TIMELINE, state="hidden", play_state="paused")
    return rrb.Blueprint(_first_arms(contents, scene), *panels, time, auto_layout=False, auto_views=False)


def _first_arms(contents: Contents, scene: Scene) -> rrb.Grid:
    first = [_arm(each, scene.first, scene) for each in contents.first_look]
    return rrb.Grid(*first, grid_columns=min(3, (len(first) + 1) // 2))


def _clearance(only: Sequence[Shown]) -> rrb.TimeSeriesView:
    """Plot how near arms come to obstacles; the line at zero is where they touch."""
    parts = [entity("clearance", "_contact"), *(entity("clearance", method_part(each.label)) for each in only)]
    return rrb.TimeSeriesView(
        name="Distance to obstacles, m",
        origin="clearance",
        contents=[f"+ {part}" for part in parts],
        plot_legend=rrb.PlotLegend(visible=False),
    )


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


def _signal_tab(contents: Contents, order: int) -> Part:
    """Plot a signal of all joints: of the featured methods, and a click away of all."""
    joints = range(contents.case.problem.n_joints)
    few, every = (
        rrb.Grid(*(_plot(contents, order, joint, only) for joint in joints)) for only in (contents.compared, ())
    )
    return _few_or_all(contents, "Methods", [few], [every], TITLES[order])


def _few_or_all(contents: Contents, key: str, few: Sequence[Part], every: Sequence[Part], title: str) -> Part:
    """Two tabs in one, of which the featured methods stand in front; one where both are the same, or few show nothing."""
    count, total, joints = len(contents.compared), len(contents.shown), contents.case.problem.n_joints + 1
    first, second = (("joints", joints),) * 2 if key == "Joints" else (("featured", count), ("methods", total))
    if count == total or not few:
        return under_key(key, *second, every, title)
    tabs = (
        under_key(key, *first, few, f"{count} featured methods"),
        under_key(key, *second, every, f"All {total} methods"),
    )
    return rrb.Tabs(*tabs, active_tab=0, name=title)


def under_key(name: str, origin: str, count: int, rows: Sequence[Part], title: str) -> rrb.Vertical:
    """Put rows of equal height below a key, which gets the height that so many names need."""
    columns = FEW_COLUMNS if origin == "featured" else KEY_COLUMNS
    key, height = drawing(name, origin, key_bounds(count, columns)), key_height(count, columns)
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


def _arm(each: Shown, look: Look, scene: Scene) -> rrb.Spatial3DView:
    """Look at one method's arm; every arm on a tab is seen from the same place."""
    eye = rrb.EyeControls3D(position=look.eye, look_target=look.target, eye_up=(0.0, 0.0, 1.0))
    parts = ["$origin/**", f"+ {OBSTACLES}", *[f"+ {MESHES}/**"] * (scene.poses is not None)]
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
    few, every = (_lanes(contents, only) for only in (contents.compared, contents.shown))
    return [_few_or_all(contents, "Joints", few, every, "Limits in use")] if every else []


def _lanes(contents: Contents, only: Sequence[Shown]) -> list[Part]:
    """Views of the joints at their limits, a lane for every method, as many as use one."""
    views: list[Part] = []
    for order, rate in enumerate(RATES, start=1):
        lanes = [lane_path(contents, rate, each) for each in only if any(use.order == order for use in each.uses)]
        if lanes:
            parts, name = [f"+ {lane}" for lane in lanes], f"Joints at their {rate} limit, a lane for every method"
            views.append(rrb.StateTimelineView(name=name, origin="/", contents=parts))
    return views
