"""Words and bars of a recording: the table of verdicts, the ladder, convergence and where it comes from."""

from __future__ import annotations

import importlib.metadata

import numpy as np
import rerun as rr

from study.analysis.formatting import DASH, count, percent, seconds, wall
from study.analysis.ladder import Rung
from study.analysis.methods import Kind, MethodSummary
from study.cases.obstacles import UNFOLLOWED
from study.planning import Freedom
from study.problem import Floats
from study.recording.contents import Contents
from study.recording.pictures import GREY, LADDER_ROOM, Bar, EffortAxis, Line, bars_pitch, log_bars, log_curves
from study.recording.stream import EVALUATION, entity, method_part

EVALUATIONS = EffortAxis("evaluations", count)
WALL_TIME = EffortAxis("wall time, shared out evenly over the evaluations of a run", wall)
NO_ARM = """\
No arm is drawn, because the case names none. In a case of one's own `robot: arm.urdf`, beside the limits, gives every
method its arm here, with tool path, obstacles and distances; in Python `plan(problem).show(robot="arm.urdf")` does.
"""
SHORTEST = 1e-6
"""Wall times are not taken for shorter than this, s."""

GAP_FLOOR = 1e-6
"""Relative gaps below the judge's tolerance are drawn at it."""


def log_summary(stream: rr.RecordingStream, contents: Contents, scene: str = "") -> None:
    """Write the Markdown table to `/summary`, the ladder of lost time to `/ladder`, all durations to `/durations`.

    Parameters
    ----------
    stream : rerun.RecordingStream
    contents : Contents
    scene : str
        What is to be said of the arms, where some are drawn.
    """
    log_standings(stream, contents, scene)
    if not scene:
        stream.log("no_arm", rr.TextDocument(NO_ARM, media_type=rr.MediaType.MARKDOWN), static=True)
    bars = ladder_bars(contents)
    log_bars(stream, "ladder", bars, bars_pitch(len(bars), LADDER_ROOM))


def log_standings(stream: rr.RecordingStream, contents: Contents, scene: str = "") -> None:
    """Write the table and the durations; written again, both replace what stood there."""
    text = rr.TextDocument(markdown(contents, scene), media_type=rr.MediaType.MARKDOWN)
    stream.log("summary", text, static=True)
    bars = [Bar(o.label, o.title, o.motion.duration, o.color) for o in contents.shown]
    log_bars(stream, "durations", bars, bars_pitch(len(bars)))


def ladder_bars(contents: Contents) -> list[Bar]:
    """Bars of the ladder of lost time, or of the first look's methods where there are too few rungs."""
    shown = {each.label: each for each in contents.shown}
    rungs = contents.summary.rungs
    if not rungs:
        return [Bar(o.label, o.title, o.motion.duration, o.color) for o in contents.first_look]
    bars = []
    for place, rung in enumerate(rungs, start=1):
        first = rung.method.split(", ")[0]  # a rung may stand for several methods of the same time
        each = shown.get(first, shown.get(f"published: {first}"))
        remark = "" if rung.feasible else "  infeasible" if each is not None else "  not judged"
        text = f"{_rung_name(rung)}  {seconds(rung.seconds)}{remark}"
        bars.append(Bar(f"{place} {rung.method}", text, rung.seconds, GREY if each is None else each.color))
    return bars


def _rung_name(rung: Rung) -> str:
    return rung.method if rung.method.lower().startswith(rung.name.lower()) else f"{rung.name}: {rung.method}"


def log_metadata(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write what the recording is of as properties; no clock is read, so the same results give the same values."""
    case = contents.case
    stream.send_recording_name(case.title)
    about = rr.AnyValues(
        name=case.name,
        title=case.title,
        paper=case.paper,
        curve=case.curve,
        robot=case.robot or "none",
        joints=list(case.problem.joint_names),
        units=list(case.units),
        waypoints=case.problem.n_waypoints,
    )
    stream.send_property("case", about)
    runs = [each.method.representative for each in contents.shown]
    how = rr.AnyValues(
        version=importlib.metadata.version("time-optimal-study"),
        samples=contents.samples,
        methods=[each.label for each in contents.shown],
        seeds=[run.cell.settings.seed if run else 0 for run in runs],
    )
    stream.send_property("study", how)


def log_convergence(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write incumbent values over evaluations to `/convergence/value`, log10 of their gaps to `/convergence/gap`.

    Both stand on the timeline `evaluation`; the same gaps are drawn for every timeline to
    `/convergence_curves` over evaluations and to `/convergence_times` over wall time.
    """
    colors = {each.label: each.color for each in contents.shown}
    for method in contents.methods:
        counts, values = history(method)
        color = colors.get(method.label, GREY)
        if len(values):
            _log_series(stream, entity("convergence", "value", method_part(method.label)), (counts, values), color)
        if len(values) and np.isfinite(contents.best):
            gaps = log_gaps(values, contents.best)
            _log_series(stream, entity("convergence", "gap", method_part(method.label)), (counts, gaps), color)
    log_convergence_curves(stream, contents)


def log_convergence_curves(stream: rr.RecordingStream, contents: Contents) -> None:
    """Draw the gaps over evaluations and over wall time; drawn again, they replace what stood there."""
    if not np.isfinite(contents.best):
        return
    colors = {each.label: each.color for each in contents.shown}
    counted, timed = [], []
    for method in contents.methods:
        counts, values = history(method)
        gaps, color = log_gaps(values, contents.best), colors.get(method.label, GREY)
        if len(values):
            counted.append(Line(method.label, np.column_stack([np.log10(counts), gaps]), color))
            timed.append(Line(method.label, np.column_stack([np.log10(wall_times(method)), gaps]), color))
    if counted:
        log_curves(stream, "convergence_curves", [*counted, *_references(contents, counted)], EVALUATIONS)
        log_curves(stream, "convergence_times", [*timed, *_arrivals(contents, timed)], WALL_TIME)


def history(method: MethodSummary) -> tuple[Floats, Floats]:
    """Evaluations and finite incumbent values of the representative run, each of shape (n_records,)."""
    run = method.representative
    records = np.empty((0, 2)) if run is None else np.asarray(run.history, dtype=float).reshape(-1, 2)
    counts, values = records[np.isfinite(records[:, 1]) & (records[:, 0] > 0)].T
    return counts, values


def wall_times(method: MethodSummary) -> Floats:
    """Wall times of the history's records, s: the run's own, in proportion to the evaluations spent."""
    run, (counts, _) = method.representative, history(method)
    whole = max(run.wall_time, SHORTEST) if run is not None else SHORTEST
    return np.asarray(counts * whole / max(run.evaluations if run is not None else 1, 1))


def log_gaps(values: Floats, best: float) -> Floats:
    """log10 of the relative distance to the best known duration, not below the judge's tolerance."""
    return np.log10(np.maximum(values / best - 1.0, GAP_FLOOR))


def _log_series(
    stream: rr.RecordingStream, path: str, series: tuple[Floats, Floats], color: tuple[int, int, int]
) -> None:
    stream.log(path, rr.SeriesLines(colors=color, widths=1.5), static=True)
    index = [rr.TimeColumn(EVALUATION, sequence=series[0].astype(np.int64))]
    stream.send_columns(path, index, rr.Scalars.columns(scalars=series[1]))


def _references(contents: Contents, lines: list[Line]) -> list[Line]:
    """Level lines for featured feasible methods on the same curve that count no evaluations."""
    span = np.array([min(line.points[0, 0] for line in lines), max(line.points[-1, 0] for line in lines)])
    on_curve = [each for each in contents.featured if each.feasible and each.method.freedom is Freedom.CURVE]
    levels = [each for each in on_curve if not len(history(each.method)[0])]
    return [
        Line(each.label, np.column_stack([span, log_gaps(np.full(2, each.motion.duration), contents.best)]), each.color)
        for each in levels
    ]


def _arrivals(contents: Contents, lines: list[Line]) -> list[Line]:
    """Feasible methods on the same curve that count no evaluations: level lines from when they are done."""
    last = max(line.points[-1, 0] for line in lines)
    arrivals: list[Line] = []
    for each in contents.shown:
        run = each.method.representative
        if (
            run is None
            or each.published
            or not each.feasible
            or each.method.freedom is not Freedom.CURVE
            or len(history(each.method)[0])
        ):
            continue
        done = np.log10(max(run.wall_time, SHORTEST))
        ends = np.array([done, max(last, done)])
        arrivals.append(
            Line(
                each.label,
                np.column_stack([ends, log_gaps(np.full(2, each.motion.duration), contents.best)]),
                each.color,
            )
        )
    return arrivals


def markdown(contents: Contents, scene: str = "") -> str:
    """Summarise the case: what it asks, who wins, and every method's verdict."""
    case, problem = contents.case, contents.case.problem
    lines = [
        f"# {plain(case.title)}",
        f"{problem.n_waypoints} waypoints, {problem.n_joints} joints. {_winner(contents)}",
        "",
        _key(scene),
        "",
        "| Method | Verdict | Time | Gap | Path | Evaluations |",
        "|:--|:--|--:|--:|:--|--:|",
        *(_row(method, contents.summary.driving.get(method.label, "")) for method in contents.methods),
        "",
        *_remarks(contents),
    ]
    return "\n".join(lines)


def _winner(contents: Contents) -> str:
    feasible = [method for method in contents.methods if method.feasible]
    if not feasible:
        return "**No method is feasible.**"
    clear = [method for method in feasible if contents.summary.clear(method)]
    if not clear:
        return "**No motion may be driven: every feasible one touches something, or is not proved not to.**"
    steps = contents.summary.driving.get(clear[0].label, "").startswith(UNFOLLOWED)
    said = UNFOLLOWED if steps else "that may be driven"
    return f"**Fastest {said}: {plain(clear[0].label)}, {seconds(clear[0].duration)}.**"


def _key(scene: str) -> str:
    """Say what the colours and marks of the other views mean."""
    return (
        f"A method has one colour everywhere. Red lines are limits, diamonds mark where one is used up. {plain(scene)}"
    )


def _row(method: MethodSummary, driving: str) -> str:
    evaluations = count(method.evaluations) if method.evaluations else ""
    gap = percent(method.gap) if method.gap is not None else ""
    time = seconds(method.duration).replace(DASH, "")
    cells = (
        plain(method.label),
        _verdict(method) + (f", {driving.partition(':')[0]}" if ":" in driving else ""),
        time,
        gap,
        (method.freedom or "") if method.motion else "",
        evaluations,
    )
    return f"| {' | '.join(cells)} |"


def _verdict(method: MethodSummary) -> str:
    if method.motion is None:
        return "not judged" if method.kind is Kind.PUBLISHED else "no motion"
    if 0 < method.feasible_runs < method.runs:
        return f"{method.feasible_runs} of {method.runs} runs feasible"
    return "feasible" if method.feasible else "**infeasible**"


def _remarks(contents: Contents) -> list[str]:
    reasons = [f"- **{plain(m.label)}**: {plain(m.reason)}" for m in contents.methods if m.reason]
    notes = [f"- {plain(note)}" for note in contents.case.notes]
    lines = ["Time is the median of the feasible runs, and the run of median time is the one that moves.", ""]
    lines[0] += " Gap is to the fastest feasible run on whatever path."
    lines += ["## Why not feasible", *reasons, ""] if reasons else []
    said = {label: text.partition(": ")[2] for label, text in contents.summary.driving.items()}
    near = [f"- **{plain(label)}**: {plain(text)}" for label, text in said.items() if text]
    lines += ["## How near the arm comes", *near, ""] if near else []
    return lines + (["## Notes", *notes] if notes else [])


def plain(text: str) -> str:
    """Keep text from being read as Markdown."""
    flat = " ".join(text.split())
    return "".join(f"\\{c}" if c in "\\`*_[]<>|#" else c for c in flat)
