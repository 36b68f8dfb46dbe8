"""A moving picture of the first look's arms, for a README: the viewer draws every frame without a screen."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from PIL import Image
from rerun.experimental import ViewerClient

from study.analysis.case_summary import CaseSummary
from study.errors import StudyError
from study.recording.contents import gather
from study.recording.layout import arms_alone
from study.recording.scene import log_scene, scene_of
from study.recording.stream import TIMELINE, recording_file
from study.recording.viewer import headless, settled_picture

SIZE = (1150, 640)
"""Of the window, pixels."""

BAR = 36
"""Height of the strip at the top that the viewer leaves empty, pixels."""

WIDTH, COLORS = 900, 96
FRAMES, REST = 50, 1.5
"""Frames, evenly over the time that the slowest arm takes, and how long the last one stays, s."""


def moving_picture(summary: CaseSummary, frames: int = FRAMES) -> bytes:
    """Animated GIF of the first look's arms, all started at once, in the time that the slowest takes.

    Parameters
    ----------
    summary : CaseSummary
    frames : int

    Raises
    ------
    StudyError
        If there is no arm or no motion, or the viewer cannot draw here.
    """
    contents = gather(summary, 2 * frames)
    scene, seconds = scene_of(contents), max((each.motion.duration for each in contents.first_look), default=0.0)
    if scene is None:
        raise StudyError(f"case {contents.case.name!r} has no robot, or no motion, to draw")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arms.rrd"
        with recording_file(path, contents.case.name) as stream:
            stream.send_blueprint(arms_alone(contents, scene))
            log_scene(stream, contents, scene)
        with headless(path, SIZE) as client:
            images = [_small(png) for png in _shots(client, np.linspace(0.0, seconds, frames))]
    step = 1000.0 * seconds / max(frames - 1, 1)
    return _gif(images, [*[round(step)] * (len(images) - 1), round(step + 1000.0 * REST)])


def _shots(client: ViewerClient, times: Sequence[float] | np.ndarray) -> Iterator[bytes]:
    for time in times:
        client.set_time(TIMELINE, duration=float(time), play_state="paused")
        yield settled_picture(client, pause=0.05)


def _small(png: bytes) -> Image.Image:
    image = Image.open(io.BytesIO(png)).convert("RGB")
    image = image.crop((0, BAR, image.width, image.height))
    return image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.Resampling.LANCZOS)


def _gif(images: Sequence[Image.Image], milliseconds: Sequence[int]) -> bytes:
    """One palette for all frames, so that what stands still takes no room."""
    sheet = Image.new("RGB", (images[0].width, 3 * images[0].height))
    for place, image in enumerate((images[0], images[len(images) // 2], images[-1])):
        sheet.paste(image, (0, place * image.height))
    palette = sheet.quantize(COLORS, Image.Quantize.MAXCOVERAGE)
    first, *rest = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images)
    out = io.BytesIO()
    first.save(out, "GIF", save_all=True, append_images=rest, duration=list(milliseconds), loop=0, optimize=False)
    return out.getvalue()
