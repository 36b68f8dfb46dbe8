"""Arms whose links are shown as the meshes that the user's own robot description names, every file written down once.

A view shows an entity in one place only, but several instances of it. So all arms stand in one scene, `APART` from each
other to the side, every view looks at its own, and a link's mesh has an instance in every arm.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr
from scipy.spatial.transform import Rotation

from study.errors import StudyError
from study.files import read_file
from study.problem import Floats
from study.recording.stream import entity, time_column
from study.robots.meshes import Shape
from study.robots.urdf import UrdfRobot

ROOM = 24e6
"""Bytes that a recording spends on meshes, all together."""

APART = 50.0
"""Distance from arm to arm, m: beside the view, and near enough for single precision."""

LIGHT = (190, 198, 206)
MESHES = entity("meshes")
MEDIA = {
    ".stl": "model/stl",
    ".obj": "model/obj",
    ".glb": "model/gltf-binary",
    ".dae": "model/vnd.collada+xml",
}


def chosen_meshes(robot: UrdfRobot) -> tuple[tuple[Shape, ...], dict[Path, bytes], str]:
    """Meshes that stand for the links, their files' contents, and what is to be said of them.

    What links are shown as comes first, what they are looked for collisions with where that is too much or not there, and
    nothing, which stands for capsules, where neither will do.
    """
    reason = robot.missing
    for shapes in (robot.shapes, robot.plain):
        if not shapes:
            continue
        try:
            contents = _contents(shapes)
        except StudyError as error:
            reason = reason or str(error)
            continue
        said = f" Links are drawn as what they are looked for collisions with: {reason}." if reason else ""
        return shapes, contents, said
    return (), {}, f" Links are drawn as capsules: {reason}." if reason else ""


def _contents(shapes: Sequence[Shape]) -> dict[Path, bytes]:
    contents = {path: read_file(path) for path in {shape.path for shape in shapes}}
    total = sum(map(len, contents.values()))
    if total > ROOM:
        raise StudyError(f"their meshes would take {total / 1e6:.0f} MB, of which {ROOM / 1e6:.0f} MB are allowed")
    return contents


def log_meshes(
    stream: rr.RecordingStream,
    shapes: Sequence[Shape],
    contents: dict[Path, bytes],
    poses: tuple[np.ndarray, Floats],
    across: Floats,
) -> None:
    """Draw the links of all arms to `/meshes`: every mesh once, with an instance in every arm.

    Parameters
    ----------
    stream : rerun.RecordingStream
    shapes : sequence of Shape
    contents : dict of Path to bytes
    poses : tuple of int64 array of shape (n,), ns, and array of shape (n, n_arms, n_frames, 4, 4), m
        Times, and where the arms' frames are then, every arm in its own base frame.
    across : array of shape (n_arms, 3), m
        Where their bases stand.
    """
    times, frames = poses
    count = len(across)
    for number, shape in enumerate(shapes):
        placed = frames[:, :, shape.frame] @ shape.place
        turns = Rotation.from_matrix(placed[..., :3, :3].reshape(-1, 3, 3)).as_quat()
        where = f"{MESHES}/{number}"
        kind = shape.path.suffix.lower()
        bare = LIGHT if kind == ".stl" else None  # a kind that has no colours of its own
        stream.log(
            where,
            rr.Asset3D(contents=contents[shape.path], media_type=MEDIA[kind], albedo_factor=bare),
            rr.InstancePoses3D.from_fields(scales=[shape.scale] * count),
            static=True,
        )
        places = (placed[..., :3, 3] + across).reshape(-1, 3)
        columns = rr.InstancePoses3D.columns(translations=places, quaternions=turns)
        stream.send_columns(where, time_column(times), columns.partition([count] * len(times)))
