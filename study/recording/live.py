"""Stream results into an open viewer as they come."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator
from contextlib import contextmanager

import rerun as rr
import rerun.blueprint as rrb

from study.analysis.case_summary import summarise_case
from study.analysis.methods import MethodSummary
from study.analysis.published import published_methods
from study.cases.library import Case
from study.errors import StudyError
from study.recording.contents import gather, in_seconds, sample_times
from study.recording.layout import drawing
from study.recording.pictures import bars_bounds, curves_bounds
from study.recording.process import address, require_display, running_viewer
from study.recording.running import RunningSearches, running_view
from study.recording.signals import log_limits
from study.recording.stream import APPLICATION, SIGNALS, TIMELINE, entity, method_part, strict, time_column
from study.recording.summary import log_convergence_curves, log_standings
from study.runs.progress import Progress
from study.store.results import Cell, Result

PAUSE = 2.0
"""Least time between two drawings of one case's standings, s."""

EXPECTED = 24
"""Number of methods that the drawings have room for before a reader has to zoom out."""


class LiveRecording:
    """A recording per case that grows while the study runs.

    Every finished run adds its velocities, accelerations and jerks at once; the table, the bars of durations and the
    curves of convergence are drawn again every few seconds at most, and once more at the end. Searches that are still
    running are drawn as often as they report: their candidates, the best motion so far and its total time.

    Parameters
    ----------
    url : str
        Where a viewer listens.
    samples : int
        Evenly spaced samples of every motion.
    """

    def __init__(self, url: str, samples: int = 120) -> None:
        self._url = url
        self._samples = samples
        self._streams: dict[str, rr.RecordingStream] = {}
        self._results: dict[str, list[Result]] = {}
        self._cases: dict[str, Case] = {}
        self._published: dict[str, tuple[MethodSummary, ...]] = {}
        self._drawn: dict[str, float] = {}
        self._running: dict[str, RunningSearches] = {}

    def show(self, case: Case, cell: Cell, progress: Progress) -> None:
        """Draw where a search that is still running stands."""
        with strict():
            self._running.setdefault(case.name, RunningSearches(case)).show(self._stream(case), cell, progress)

    def add(self, case: Case, result: Result) -> None:
        """Show one more result; cheap enough to be called for every cell as it finishes.

        Raises
        ------
        StudyError
            If the result belongs to another case.
        """
        if result.cell.case != case.name:
            raise StudyError(f"live recording of case {case.name!r}: got a result of case {result.cell.case!r}")
        self._cases[case.name] = case
        results = self._results.setdefault(case.name, [])
        results.append(result)
        with strict():
            stream = self._stream(case)
            if case.name in self._running:
                self._running[case.name].finish(stream, result.cell)
            if result.motion is not None:
                self._log_run(stream, case, result)
            if clock.monotonic() - self._drawn.get(case.name, 0.0) > PAUSE:
                self._draw(case)

    def close(self) -> None:
        """Draw what is still to be drawn and end the streams; the viewer keeps what it has."""
        with strict():
            for case in self._cases.values():
                self._draw(case)
        for stream in self._streams.values():
            stream.disconnect()
        self._streams.clear()

    def _stream(self, case: Case) -> rr.RecordingStream:
        if case.name not in self._streams:
            stream = rr.RecordingStream(APPLICATION, recording_id=f"{case.name} (live)", send_properties=False)
            stream.connect_grpc(self._url)
            rr.set_log_time_enabled(False, recording=stream)
            stream.send_recording_name(f"{case.title} (live)")
            stream.send_blueprint(_layout(case))  # once, so that a reader's own choice of tab is kept
            self._streams[case.name] = stream
        return self._streams[case.name]

    def _draw(self, case: Case) -> None:
        if case.name not in self._published:
            self._published[case.name] = published_methods(case)
        summary = summarise_case(case, self._results[case.name], self._published[case.name])
        contents = gather(summary, self._samples)
        stream = self._stream(case)
        log_standings(stream, contents)
        log_limits(stream, contents)
        log_convergence_curves(stream, contents)
        self._drawn[case.name] = clock.monotonic()

    def _log_run(self, stream: rr.RecordingStream, case: Case, result: Result) -> None:
        """Write one run under an entity of its own: what is written on a timeline cannot be taken back."""
        motion = result.motion
        if motion is None:
            return
        times = sample_times(motion, self._samples)
        for order, signal in enumerate(SIGNALS):
            values = motion(in_seconds(times), order)
            for joint, name in enumerate(case.problem.joint_names):
                path = entity(signal, name, method_part(result.cell.label), f"seed {result.cell.settings.seed}")
                stream.log(path, rr.SeriesLines(names=result.cell.label, widths=1.0), static=True)
                stream.send_columns(path, time_column(times), rr.Scalars.columns(scalars=values[:, joint]))


@contextmanager
def live_recording(hidden: tuple[int, int] | None = None) -> Iterator[tuple[LiveRecording, str]]:
    """Open a viewer and stream into it; its window stays open afterwards.

    Parameters
    ----------
    hidden : pair of int, pixels, optional
        Size of a viewer without a window, which ends with the context.

    Yields
    ------
    LiveRecording and the address at which the viewer listens

    Raises
    ------
    StudyError
        If there is no display or the viewer does not come up.
    """
    if hidden is None:
        require_display("cannot show the run live", "leave out --live and look at the recordings afterwards")
    with running_viewer(hidden) as (_, port):
        live = LiveRecording(address(port))
        try:
            yield live, address(port)
        finally:
            live.close()


def _layout(case: Case) -> rrb.Blueprint:
    names = case.problem.joint_names
    plots = [
        rrb.TimeSeriesView(name=f"Velocity of {n}", origin=entity("v", n), plot_legend=rrb.PlotLegend(visible=False))
        for n in names
    ]
    standings = rrb.Horizontal(
        rrb.TextDocumentView(name="Table", origin="summary"),
        drawing("Durations", "durations", bars_bounds(EXPECTED)),
        name="Standings",
    )
    return rrb.Blueprint(
        rrb.Tabs(
            running_view(),
            drawing("Convergence", "convergence_curves", curves_bounds(EXPECTED)),
            standings,
            rrb.Grid(*plots, name="Velocity"),
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed", play_state="paused"),
        auto_layout=False,
        auto_views=False,
    )
