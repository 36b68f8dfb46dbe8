"""How the viewer opens a recording: an overview, then one tab per signal, convergence and activity."""

from __future__ import annotations

import numpy as np
import rerun.blueprint as rrb

from study.experiment.cases import Case
from study.judge import RATES
from study.report.recording.contents import Contents
from study.report.recording.scene import Scene
from study.report.recording.signals import limit_values
from study.report.recording.stream import SIGNALS, TIMELINE, entity

TITLES = ("Position", "Velocity", "Acceleration", "Jerk")
KINDS = ("angle", "speed")


def layout(contents: Contents, scene: Scene | None) -> rrb.Blueprint:
    """Arrange the views of a recording; time stands still at the start."""
    tabs = [
        _overview(contents, scene),
        *(_signal_tab(contents, order) for order in range(4)),
        _convergence(contents),
        _activity(contents, "Activity"),
    ]
    return rrb.Blueprint(
        rrb.Tabs(*tabs, active_tab=0),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed", play_state="paused"),
        auto_layout=False,
        auto_views=False,
    )


def _overview(contents: Contents, scene: Scene | None) -> rrb.Container:
    words = rrb.Vertical(
        rrb.TextDocumentView(name="Summary", origin="summary"),
        rrb.BarChartView(name="Duration of each method, s", origin="durations"),
        row_shares=[3, 2],
    )
    plots = [_plot(contents, order, joint, legend=False) for order, joint in active_signals(contents)]
    right: list[rrb.View | rrb.Container] = [] if scene is None else [_arms("Arms side by side", scene)]
    right.append(rrb.Horizontal(*plots))
    moving = rrb.Vertical(*right, row_shares=[3, 2][: len(right)])
    return rrb.Horizontal(words, moving, column_shares=[2, 3], name="Overview")


def active_signals(contents: Contents, wanted: int = 3) -> list[tuple[int, int]]:
    """Orders and joints whose limits the fastest feasible method uses longest; velocity of the first joints otherwise."""
    shares: dict[tuple[int, int], float] = {}
    for entry, motion in contents.moving:
        for use in entry.uses:
            key = (use.order, use.joint)
            shares[key] = shares.get(key, 0.0) + (use.end - use.start) / motion.duration
    ranked = sorted(shares, key=lambda key: (-shares[key], key))
    others = [(1, joint) for joint in range(contents.case.problem.n_joints)]
    return sorted(dict.fromkeys([*ranked[:wanted], *others]), key=lambda key: key not in ranked)[:wanted]


def _signal_tab(contents: Contents, order: int) -> rrb.Container:
    joints = range(contents.case.problem.n_joints)
    return rrb.Grid(*(_plot(contents, order, joint, legend=joint == 0) for joint in joints), name=TITLES[order])


def _plot(contents: Contents, order: int, joint: int, legend: bool) -> rrb.TimeSeriesView:
    case = contents.case
    name = f"{TITLES[order]} of {case.problem.joint_names[joint]}, {_unit(case, order, joint)}"
    return rrb.TimeSeriesView(
        name=name,
        origin=entity(SIGNALS[order], case.problem.joint_names[joint]),
        plot_legend=rrb.PlotLegend(visible=legend),
        axis_y=_axis(case, order, joint),
    )


def _axis(case: Case, order: int, joint: int) -> rrb.ScalarAxis | None:
    """Keep a rate within sight of its limits, whatever an infeasible method does; positions fit themselves."""
    pair = limit_values(case, order, joint)
    if order == 0 or pair is None:
        return None
    return rrb.ScalarAxis(range=(1.2 * pair[1], 1.2 * pair[0]), zoom_lock=False)


def _unit(case: Case, order: int, joint: int) -> str:
    return case.units[joint] + ("", "/s", "/s²", "/s³")[order]


def _arms(name: str, scene: Scene) -> rrb.Spatial3DView:
    distance = 0.9 * float(np.linalg.norm(scene.extent))
    eye = scene.middle + distance * np.array([1.0, 0.0, 0.35])
    return rrb.Spatial3DView(
        name=name,
        origin="arms",
        eye_controls=rrb.EyeControls3D(position=eye, look_target=scene.middle, eye_up=(0.0, 0.0, 1.0)),
    )


def _convergence(contents: Contents) -> rrb.Container:
    return rrb.Vertical(
        rrb.TimeSeriesView(name="log10 of the gap to the best known time", origin="convergence/gap"),
        rrb.TimeSeriesView(name="Best objective so far, s", origin="convergence/value"),
        name="Convergence",
    )


def _activity(contents: Contents, name: str) -> rrb.Container:
    used = {use.order for entry in contents.entries for use in entry.uses}
    lanes = [
        rrb.StateTimelineView(name=f"{rate.capitalize()} limit in use, by joint", origin=entity("activity", rate))
        for order, rate in enumerate(RATES, start=1)
        if order in used
    ]
    return rrb.Vertical(*lanes, name=name)
