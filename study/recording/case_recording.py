"""One recording per case, all methods inside."""

from __future__ import annotations

from pathlib import Path

from study.analysis.case_summary import CaseSummary
from study.recording.arm_limits import log_arm_limits
from study.recording.contents import gather
from study.recording.layout import layout
from study.recording.scene import log_scene, scene_of
from study.recording.signals import log_activity, log_signals
from study.recording.stream import APPLICATION, recording_file
from study.recording.summary import log_convergence, log_metadata, log_summary
from study.recording.swarm import log_swarms, swarm_views, swarms_of

__all__ = ["APPLICATION", "record_case"]


def record_case(summary: CaseSummary, path: Path, samples: int = 250) -> Path:
    """Write a recording of a case with all methods side by side.

    Of every label the run of median rank is shown (feasible before infeasible, then by duration), and beside them what
    the paper prints. The paper's own planner and the best metaheuristic are run again from their seeds to show their
    populations, which takes as long as they took. The same results give the same column values; row identities differ from file to file.

    It is made from stored results, not joined from a part per cell: the store keeps every finished cell through a kill, and
    who is shown, in which colour and at which rank, is known only from all of them.

    Parameters
    ----------
    summary : CaseSummary
    path : Path
        Replaced only when the new recording is complete.
    samples : int
        Evenly spaced samples of every motion; knots and exact peaks are added.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    StudyError
        If there is nothing to show, or the file cannot be written.
    """
    contents = gather(summary, samples)
    swarms, scene = swarms_of(contents), scene_of(contents)
    with recording_file(path, summary.case.name) as stream:
        stream.send_blueprint(
            layout(contents, scene, swarm_views(swarms))
        )  # first: else a slow viewer makes up its own
        log_metadata(stream, contents)
        log_summary(stream, contents, "" if scene is None else scene.words)
        if scene is not None:
            log_scene(stream, contents, scene)
        log_signals(stream, contents)
        log_arm_limits(stream, contents)
        log_activity(stream, contents)
        log_convergence(stream, contents)
        log_swarms(stream, contents, swarms)
    return path
