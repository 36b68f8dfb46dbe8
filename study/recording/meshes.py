"""Arms whose links are shown as the meshes that the user's own robot description names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr
from scipy.spatial.transform import Rotation

from study.errors import StudyError
from study.files import read_file
from study.problem import Floats
from study.recording.stream import time_column
from study.robots.meshes import Shape

ROOM = 12e6
"""Bytes that a recording spends on meshes; every arm needs its own copy of them."""

MEDIA = {
    ".stl": "model/stl",
    ".obj": "model/obj",
    ".glb": "model/gltf-binary",
    ".dae": "model/vnd.collada+xml",
}


def mesh_contents(shapes: Sequence[Shape], arms: int) -> dict[Path, bytes]:
    """Read the meshes of an arm.

    Parameters
    ----------
    shapes : sequence of Shape
    arms : int
        How many arms are drawn of them.

    Raises
    ------
    StudyError
        If a file cannot be read, or so many copies would make the recording too large.
    """
    contents: dict[Path, bytes] = {}
    for path in {shape.path for shape in shapes}:
        contents[path] = read_file(path)
    total = arms * sum(len(contents[shape.path]) for shape in shapes)
    if total > ROOM:
        raise StudyError(f"their meshes would take {total / 1e6:.0f} MB, of which {ROOM / 1e6:.0f} MB are allowed")
    return contents


def log_meshes(
    stream: rr.RecordingStream,
    path: str,
    shapes: Sequence[Shape],
    contents: dict[Path, bytes],
    poses: tuple[np.ndarray, Floats],
    color: tuple[int, int, int],
) -> None:
    """Draw an arm: a moving frame for every link that has meshes, and these fixed to it.

    Parameters
    ----------
    stream : rerun.RecordingStream
    path : str
    shapes : sequence of Shape
    contents : dict of Path to bytes
    poses : tuple of int64 array of shape (n,), ns, and array of shape (n, n_links + 1, 4, 4), m
        Times, and where the arm's frames are then.
    color : tuple of three int
    """
    times, frames = poses
    for frame in sorted({shape.frame for shape in shapes}):
        turns = Rotation.from_matrix(frames[:, frame, :3, :3]).as_quat()
        columns = rr.Transform3D.columns(translation=frames[:, frame, :3, 3], quaternion=turns)
        stream.send_columns(f"{path}/frame{frame}", time_column(times), columns)
    for number, shape in enumerate(shapes):
        where = f"{path}/frame{shape.frame}/mesh{number}"
        place = rr.Transform3D(
            translation=shape.place[:3, 3],
            quaternion=rr.Quaternion(xyzw=Rotation.from_matrix(shape.place[:3, :3]).as_quat()),
            scale=shape.scale,
        )
        stream.log(where, place, static=True)
        media = MEDIA[shape.path.suffix.lower()]
        asset = rr.Asset3D(contents=contents[shape.path], media_type=media, albedo_factor=color)
        stream.log(where, asset, static=True)
