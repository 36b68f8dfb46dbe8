"""Candidates of a search, generation after generation, in the space of segment durations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from study.analysis.replay import Replay, replayed
from study.planning import Formulation
from study.problem import Floats
from study.recording.contents import NANOSECOND, PALETTE, Contents, Shown
from study.recording.layout import drawing, under_key
from study.recording.pictures import FAINT, GREY, WHITE, log_key, log_text
from study.recording.stream import GENERATION, entity, method_part, time_column

PANELS = 5
"""Generations that are drawn side by side: the first, the last, and others closer together at the start."""

SIZE = np.array([300.0, 300.0])
APART = 380.0
FRAMES = 80
"""Generations that the moving picture shows at most."""


@dataclass(frozen=True, eq=False)
class Swarm:
    """A search that has been run again, and the method it belongs to."""

    shown: Shown
    replay: Replay

    @property
    def title(self) -> str:
        """Name and seed."""
        run = self.shown.method.representative
        return f"{self.shown.label}, seed {run.cell.settings.seed if run else 0}"

    @property
    def remark(self) -> str:
        """Remark on the change of the durations before they are driven."""
        run = self.shown.method.representative
        scaled = run is not None and run.cell.settings.formulation is Formulation.SCALED
        return " before they are stretched to the limits (only proportions count)" if scaled else ""

    @property
    def n_segments(self) -> int:
        """Number of durations of a candidate."""
        return self.replay.populations[0][0].shape[1]

    def color(self, part: int) -> tuple[int, int, int]:
        """The method's colour, or the joint's where every joint is searched alone."""
        return self.shown.color if len(self.replay.parts) == 1 else PALETTE[part % len(PALETTE)]


def swarms_of(contents: Contents) -> tuple[Swarm, ...]:
    """Run the paper's own planner and the best metaheuristic again, as far as they have populations."""
    best = contents.chosen.search
    wanted = {contents.case.planner, best.label if best is not None else ""}
    swarms = []
    for shown in contents.shown:
        run = shown.method.representative
        replay = replayed(contents.case, run) if shown.label in wanted and run is not None else None
        if replay is not None:
            swarms.append(Swarm(shown, replay))
    return tuple(swarms)


def log_swarms(stream: rr.RecordingStream, contents: Contents, swarms: Sequence[Swarm]) -> None:
    """Draw some generations to `/swarm` for every timeline, and all to `/population`.

    The latter stand on the timeline `generation`, and once more on that of the motions, spread over the time that these
    run, so that they move while the arms do.
    """
    joints = contents.case.problem.joint_names
    if any(len(swarm.replay.parts) > 1 for swarm in swarms):
        log_key(stream, "swarm_joints", [(name, PALETTE[k % len(PALETTE)]) for k, name in enumerate(joints)])
    for swarm in swarms:
        bounds = np.log10(contents.case.problem.duration_bounds)
        name, last = method_part(swarm.shown.label), swarm.replay.generations - 1
        for panel, generation in enumerate(_spread(last, PANELS)):
            corner = np.array([APART * panel, 0.0])
            where = entity("swarm", name, f"panel {panel + 1}")
            log_frame(stream, where, corner, bounds, swarm.n_segments)
            log_text(stream, where + "/title", (corner[0], -24.0), f"generation {generation + 1}", WHITE)
            for part in range(len(swarm.replay.parts)):
                points = places(swarm.replay.at(part, generation), bounds, corner, (part, len(swarm.replay.parts)))
                dots = rr.Points2D(points, colors=swarm.color(part), radii=1.6)
                stream.log(f"{where}/{entity(str(part))}", dots, static=True)
            stream.log(where + "/best", _best(swarm, generation, bounds, corner), static=True)
        _log_moving(stream, swarm, bounds, contents.run_time)


def _log_moving(stream: rr.RecordingStream, swarm: Swarm, bounds: Floats, run_time: float) -> None:
    where, corner, last = (
        entity("population", method_part(swarm.shown.label)),
        np.zeros(2),
        swarm.replay.generations - 1,
    )
    log_frame(stream, where, corner, bounds, swarm.n_segments)
    frames = np.unique(np.linspace(0, last, FRAMES).round().astype(np.int64))
    times = np.linspace(0.0, run_time / NANOSECOND, len(frames)).astype(np.int64)
    index = [rr.TimeColumn(GENERATION, sequence=frames + 1), *time_column(times)]
    shape = rr.Points2D.from_fields(colors=[WHITE], radii=[0.0], show_labels=True)
    stream.log(where + "/generation", shape, static=True)
    titles = rr.Points2D.columns(
        positions=np.tile([0.5 * SIZE[0], -34.0], (len(frames), 1)), labels=[f"generation {k + 1}" for k in frames]
    )
    stream.send_columns(where + "/generation", index, titles.partition([1] * len(frames)))
    for part in range(len(swarm.replay.parts)):
        place = (part, len(swarm.replay.parts))
        points = [places(swarm.replay.at(part, int(k)), bounds, corner, place) for k in frames]
        path = f"{where}/{entity(str(part))}"
        stream.log(path, rr.Points2D.from_fields(colors=[swarm.color(part)], radii=[1.6]), static=True)
        columns = rr.Points2D.columns(positions=np.concatenate(points)).partition([len(part) for part in points])
        stream.send_columns(path, index, columns)


def _spread(last: int, count: int) -> list[int]:
    """Generations from 0 to the last, closer together at the start."""
    return sorted({0, last, *np.rint(np.geomspace(1, last + 1, count) - 1).astype(int).tolist()})


def places(durations: Floats, bounds: Floats, corner: Floats, place: tuple[int, int] = (0, 1)) -> Floats:
    """Places of candidates in the drawing: a column for every segment, the duration upwards; shape (n_candidates * n_segments, 2).

    Parameters
    ----------
    durations : array of shape (n_candidates, n_segments), s
    bounds : array of shape (2,)
        log10 of the ends of the search's box, s.
    corner : array of shape (2,)
        Of the frame, upper left.
    place : pair of int
        Which of how many joints this is, where every joint is searched alone.
    """
    n_segments, (part, n_parts) = durations.shape[1], place
    offset = 0.0 if n_parts == 1 else 0.6 * (part / (n_parts - 1) - 0.5)  # joints side by side in a segment's column
    x = np.broadcast_to((np.arange(n_segments) + 0.5 + offset) / n_segments, durations.shape)
    y = 1.0 - (np.log10(durations) - bounds[0]) / (bounds[1] - bounds[0])
    return np.asarray(corner + SIZE * np.stack([x, y], axis=-1).reshape(-1, 2))


def _best(swarm: Swarm, generation: int, bounds: Floats, corner: Floats) -> rr.Points2D:
    """The best candidate so far of every part, as white dots."""
    parts = range(len(swarm.replay.parts))
    rows = [places(swarm.replay.best(k, generation)[None], bounds, corner, (k, len(parts))) for k in parts]
    return rr.Points2D(np.concatenate(rows), colors=WHITE, radii=2.6)


def log_frame(stream: rr.RecordingStream, where: str, corner: Floats, bounds: Floats, n_segments: int) -> None:
    """Lines at the ends of the search's box and at every power of ten between, and between the segments."""
    decades = np.arange(np.floor(bounds[0]), np.floor(bounds[1]) + 1)
    ticks = [t for t in (decades[:, None] + np.log10([1.0, 2.0, 5.0])).ravel() if bounds[0] < t < bounds[1]]
    levels = np.unique(np.round([*bounds, *ticks], 9))
    heights = 1.0 - (levels - bounds[0]) / (bounds[1] - bounds[0])
    edges = np.arange(n_segments + 1) / n_segments
    across = [[corner + SIZE * (0, y), corner + SIZE * (1, y)] for y in heights]
    up = [[corner + SIZE * (x, 0), corner + SIZE * (x, 1)] for x in edges]
    stream.log(f"{where}/frame", rr.LineStrips2D([*across, *up], colors=FAINT, radii=0.6), static=True)
    for k, (level, y) in enumerate(zip(levels, heights, strict=True)):
        spot = (corner[0] - 46.0, corner[1] + SIZE[1] * y + 8.0)
        log_text(stream, f"{where}/frame/{k}", spot, f"{10**level:.3g} s", GREY)
    log_text(
        stream, f"{where}/frame/x", (corner[0] + 60.0, corner[1] + SIZE[1] + 24.0), "segments, from the first", GREY
    )


def swarm_views(swarms: Sequence[Swarm]) -> list[rrb.View | rrb.Container]:
    """Tabs of the drawings and of the moving pictures."""
    if not swarms:
        return []
    still: list[rrb.View | rrb.Container] = [
        _picture(
            f"{swarm.title}: segment durations of all candidates{swarm.remark}, the best so far in white",
            "swarm",
            swarm,
            PANELS,
        )
        for swarm in swarms
    ]
    moving = [_picture(f"{swarm.title}, generation by generation", "population", swarm, 1) for swarm in swarms]
    joints = max(len(swarm.replay.parts) for swarm in swarms)
    tabs: list[tuple[list[rrb.View | rrb.Container], str]] = [
        (still, "Search population"),
        ([rrb.Horizontal(*moving)], "Search population in motion"),
    ]
    if joints == 1:
        return [rrb.Vertical(*rows, name=name) for rows, name in tabs]
    return [under_key("Joints", "swarm_joints", joints, rows, name) for rows, name in tabs]


def _picture(name: str, root: str, swarm: Swarm, panels: int) -> rrb.Spatial2DView:
    bounds = ((-60.0, APART * (panels - 1) + SIZE[0] + 20.0), (-60.0, SIZE[1] + 50.0))
    return drawing(name, entity(root, method_part(swarm.shown.label)), bounds)
