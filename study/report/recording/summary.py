"""What a recording says in words and bars: the table of verdicts, the durations, convergence and where it comes from."""

from __future__ import annotations

import importlib.metadata

import numpy as np
import rerun as rr

from study.report.recording.contents import Contents, Entry
from study.report.recording.stream import EVALUATION, entity

GAP_FLOOR = 1e-6
"""Relative gaps below the judge's tolerance are drawn at it."""


def log_summary(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write the Markdown table to `/summary` and a bar per method to `/durations`."""
    text = rr.TextDocument(markdown(contents), media_type=rr.MediaType.MARKDOWN)
    stream.log("summary", text, static=True)
    for place, (entry, motion) in enumerate(contents.moving):
        bar = rr.BarChart([motion.duration], abscissa=[float(place)], widths=[0.8], color=entry.color)
        stream.log(entity("durations", entry.label), bar, static=True)


def log_metadata(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write what the recording is of as properties; no clock is read, so the same results give the same values."""
    case = contents.case
    stream.send_recording_name(case.title)
    stream.send_property(
        "case",
        rr.AnyValues(
            name=case.name,
            title=case.title,
            paper=case.paper,
            curve=case.curve,
            robot=case.robot or "none",
            joints=list(case.problem.joint_names),
            units=list(case.units),
            waypoints=case.problem.n_waypoints,
        ),
    )
    stream.send_property(
        "study",
        rr.AnyValues(
            version=importlib.metadata.version("time-optimal-study"),
            samples=contents.samples,
            methods=[entry.label for entry in contents.entries],
            seeds=[entry.result.cell.settings.seed if entry.result else -1 for entry in contents.entries],
        ),
    )


def log_convergence(stream: rr.RecordingStream, contents: Contents) -> None:
    """Write incumbent values over evaluations to `/convergence/value`, and log10 of their gaps to `/convergence/gap`."""
    for entry in contents.entries:
        history = np.empty((0, 2)) if entry.result is None else np.asarray(entry.result.history, dtype=float)
        counts, values = history[np.isfinite(history[:, 1])].T
        if not len(values):
            continue
        style = rr.SeriesLines(names=entry.label, colors=entry.color, widths=1.5)
        index = [rr.TimeColumn(EVALUATION, sequence=counts.astype(np.int64))]
        series = {"value": values}
        if np.isfinite(contents.best):
            series["gap"] = log_gaps(values, contents.best)
        for kind, column in series.items():
            path = entity("convergence", kind, entry.label)
            stream.log(path, style, static=True)
            stream.send_columns(path, index, rr.Scalars.columns(scalars=column))


def log_gaps(values: np.ndarray, best: float) -> np.ndarray:
    """log10 of the relative distance to the best known duration, not below the judge's tolerance."""
    return np.log10(np.maximum(values / best - 1.0, GAP_FLOOR))


def markdown(contents: Contents) -> str:
    """Summarise the case: what it asks, who wins, and every method's verdict."""
    case, problem = contents.case, contents.case.problem
    lines = [
        f"# {case.title}",
        f"{problem.n_waypoints} waypoints, {problem.n_joints} joints. {_winner(contents)}",
        "",
        "| Method | Verdict | Time, s | Gap | Seeds | Evaluations |",
        "|:--|:--|--:|--:|--:|--:|",
        *(_row(entry, contents.best) for entry in contents.entries),
        "",
        *_remarks(contents),
    ]
    return "\n".join(lines)


def _winner(contents: Contents) -> str:
    feasible = [entry for entry in contents.entries if entry.rank[0] == 0]
    if not feasible:
        return "**No method is feasible.**"
    return f"**Fastest feasible: {plain(feasible[0].label)}, {feasible[0].rank[1]:.5f} s.**"


def _row(entry: Entry, best: float) -> str:
    verdict = entry.verdict
    word = "no motion" if verdict is None else "feasible" if verdict.feasible else "**infeasible**"
    time = "" if verdict is None else f"{verdict.duration:.5f}"
    gap = f"{100 * (verdict.duration / best - 1):+.3f} %" if verdict is not None and verdict.feasible else ""
    seeds = f"{entry.feasible} of {entry.seeds}" if entry.result is not None and entry.seeds > 1 else ""
    evaluations = f"{entry.result.evaluations:,}" if entry.result is not None and entry.result.evaluations else ""
    return f"| {plain(entry.label)} | {word} | {time} | {gap} | {seeds} | {evaluations} |"


def _remarks(contents: Contents) -> list[str]:
    remarks = [entry for entry in contents.entries if entry.remark and entry.rank[0] > 0]
    lines = ["## Why not feasible", *(f"- **{plain(e.label)}**: {plain(e.remark)}" for e in remarks)] if remarks else []
    notes = ["## Notes", *(f"- {plain(note)}" for note in contents.case.notes)] if contents.case.notes else []
    seeds = (
        ["", "Of several seeds the run of median rank is shown."] if any(e.seeds > 1 for e in contents.entries) else []
    )
    return [*lines, *notes, *seeds]


def plain(text: str) -> str:
    """Keep text from being read as Markdown."""
    flat = " ".join(text.split())
    return "".join(f"\\{c}" if c in "\\`*_[]<>|#" else c for c in flat)
