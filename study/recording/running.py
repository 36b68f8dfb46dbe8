"""Searches in mid-run: their candidates, the best motion so far and how its total time came down."""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from study.analysis.formatting import count
from study.cases.library import Case
from study.curves import curve_named
from study.problem import Floats
from study.recording.contents import PALETTE
from study.recording.layout import drawing
from study.recording.pictures import FAINT, GREY, WHITE, log_text, stairs
from study.recording.stream import LIMIT_COLOR, entity
from study.recording.swarm import SIZE, log_frame, places
from study.runs.progress import Progress
from study.store.results import Cell

WHERE = "running"
SLOTS = 2
"""Number of searches that are drawn one below the other; with more workers the one that was drawn longest ago makes room."""

WIDE, APART, PITCH = 560.0, 90.0, 430.0
SAMPLES = 160
HIGHEST = 1.25
"""Share of a limit above which a velocity leaves the drawing."""

_corners = (0.0, SIZE[0] + APART, SIZE[0] + WIDE + 2.5 * APART)


class RunningSearches:
    """Drawings of what is being searched for a case; each is drawn again in place.

    Parameters
    ----------
    case : Case
    """

    def __init__(self, case: Case) -> None:
        self._case = case
        self._slots: dict[Cell, int] = {}
        self._totals: dict[Cell, list[tuple[int, float]]] = {}

    def show(self, stream: rr.RecordingStream, cell: Cell, progress: Progress) -> None:
        """Draw where a search stands."""
        slot = self._slots.pop(cell, None)
        if slot is None:
            slot = self._free()
            stream.log(entity(WHERE, str(slot)), rr.Clear(recursive=True), static=True)
        self._slots[cell] = slot  # at the end: the first is the one that was drawn longest ago
        totals = self._totals.setdefault(cell, [])
        totals.append((progress.evaluations, float(progress.durations.sum())))
        top = PITCH * slot
        self._log_title(stream, cell, slot, "")
        _log_candidates(stream, entity(WHERE, str(slot), "candidates"), self._case, progress, np.array([0.0, top]))
        _log_motion(
            stream, entity(WHERE, str(slot), "motion"), self._case, cell, progress, np.array([_corners[1], top])
        )
        _log_totals(stream, entity(WHERE, str(slot), "totals"), np.array(totals), np.array([_corners[2], top]))

    def finish(self, stream: rr.RecordingStream, cell: Cell) -> None:
        """Say that a search is finished; its drawing stays until another one needs the place."""
        if cell in self._slots:
            self._log_title(stream, cell, self._slots[cell], ", finished")

    def _free(self) -> int:
        left = set(range(SLOTS)) - set(self._slots.values())
        if left:
            return min(left)
        oldest = next(iter(self._slots))
        return self._slots.pop(oldest)

    def _log_title(self, stream: rr.RecordingStream, cell: Cell, slot: int, remark: str) -> None:
        evaluations, total = self._totals[cell][-1]
        text = f"{cell.label}, seed {cell.settings.seed}: {total:.4f} s after {count(evaluations)} evaluations{remark}"
        log_text(stream, entity(WHERE, str(slot), "title"), (0.0, PITCH * slot - 54.0), text, WHITE)


def running_view() -> rrb.Spatial2DView:
    """The view of the drawings."""
    bounds = ((-60.0, _corners[2] + WIDE + 30.0), (-90.0, PITCH * SLOTS - 20.0))
    return drawing("Searching now", WHERE, bounds)


def _log_candidates(stream: rr.RecordingStream, where: str, case: Case, progress: Progress, corner: Floats) -> None:
    bounds, parts = np.log10(case.problem.duration_bounds), len(progress.candidates)
    log_frame(stream, where, corner, bounds, case.problem.n_segments)
    log_text(stream, where + "/name", (corner[0], corner[1] - 24.0), "candidates, best so far in white", GREY)
    dots = [places(durations, bounds, corner, (k, parts)) for k, durations in enumerate(progress.candidates)]
    colors = np.repeat(
        np.array([PALETTE[k % len(PALETTE)] for k in range(parts)]), [len(part) for part in dots], axis=0
    )
    stream.log(where + "/dots", rr.Points2D(np.concatenate(dots), colors=colors, radii=1.8), static=True)
    best = places(progress.durations[None], bounds, corner)
    stream.log(where + "/best", rr.Points2D(best, colors=WHITE, radii=3.0), static=True)


def _log_motion(
    stream: rr.RecordingStream, where: str, case: Case, cell: Cell, progress: Progress, corner: Floats
) -> None:
    """Draw the velocities of the best motion so far, as shares of their limits."""
    motion = curve_named(cell.settings.curve).motion(case.problem.waypoints, progress.durations)
    times = np.linspace(0.0, motion.duration, SAMPLES)
    shares = np.clip(motion(times, 1) / case.problem.limits.velocity, -HIGHEST, HIGHEST)
    across = corner[0] + WIDE * times / motion.duration
    lines = [np.column_stack([across, _height(corner, share)]) for share in shares.T]
    levels = [[[corner[0], y], [corner[0] + WIDE, y]] for y in _height(corner, np.array([1.0, 0.0, -1.0]))]
    colors = [LIMIT_COLOR, FAINT, LIMIT_COLOR]
    stream.log(where + "/levels", rr.LineStrips2D(levels, colors=colors, radii=0.6), static=True)
    joints = [PALETTE[k % len(PALETTE)] for k in range(len(lines))]
    stream.log(where + "/lines", rr.LineStrips2D(lines, colors=joints, radii=1.0), static=True)
    name = f"velocities of the best motion so far, over {motion.duration:.4f} s: a colour per joint, limits in red"
    log_text(stream, where + "/name", (corner[0], corner[1] - 24.0), name, GREY)


def _height(corner: Floats, share: Floats) -> Floats:
    return np.asarray(corner[1] + 0.5 * SIZE[1] * (1.0 - share / HIGHEST))


def _log_totals(stream: rr.RecordingStream, where: str, totals: Floats, corner: Floats) -> None:
    """Draw the total time of the best so far over the logarithm of evaluations, from the first report to the last."""
    spots = np.column_stack([np.log10(totals[:, 0]), totals[:, 1]])
    low, high = spots.min(axis=0), spots.max(axis=0)
    share = (spots - low) / np.maximum(high - low, 1e-9)
    points = stairs(corner + np.column_stack([share[:, 0] * WIDE, (1.0 - share[:, 1]) * SIZE[1]]))
    points = points if len(points) > 1 else np.vstack([points, points + np.array([1.0, 0.0])])
    frame = corner + np.array([[0.0, 0.0], [0.0, SIZE[1]], [WIDE, SIZE[1]]])
    stream.log(where + "/frame", rr.LineStrips2D([frame], colors=FAINT, radii=0.6), static=True)
    stream.log(where + "/line", rr.LineStrips2D([points], colors=WHITE, radii=1.2), static=True)
    log_text(
        stream,
        where + "/name",
        (corner[0], corner[1] - 24.0),
        "total time of the best so far, over evaluations (log)",
        GREY,
    )
    for name, y, value in (("high", 8.0, high[1]), ("low", SIZE[1] + 8.0, low[1])):
        log_text(stream, f"{where}/{name}", (corner[0] - 66.0, corner[1] + y), f"{value:.4f} s", GREY)
    log_text(stream, where + "/begin", (corner[0], corner[1] + SIZE[1] + 24.0), count(totals[0, 0]), GREY)
    end = f"{count(totals[-1, 0])} evaluations"
    log_text(stream, where + "/end", (corner[0] + WIDE - 120.0, corner[1] + SIZE[1] + 24.0), end, GREY)
