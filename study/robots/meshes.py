"""Mesh files of a URDF file, and the frames that carry them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from study.errors import StudyError
from study.io.urdf import Urdf, UrdfMesh
from study.problem import Floats

KINDS = (".stl", ".obj", ".glb", ".dae")
"""Formats that the viewer can show."""

_PACKAGES = ("package://", "model://")


@dataclass(frozen=True, eq=False)
class Shape:
    """Mesh that moves with one of an arm's frames.

    Attributes
    ----------
    frame : int
        Place among the arm's frames, the base first, and after them those of joints that follow.
    place : array of shape (4, 4), m
        From that frame to the mesh's.
    scale : array of shape (3,)
    path : Path
    """

    frame: int
    place: Floats
    scale: Floats
    path: Path


def shapes_of(
    urdf: Urdf, meshes: Sequence[UrdfMesh], places: Mapping[str, int], file: Path
) -> tuple[tuple[Shape, ...], str]:
    """Meshes of an arm, each with the frame that carries it, or none and why; other joints stand at zero.

    An arm with some of its links left out would be taken for another one.

    Parameters
    ----------
    urdf : Urdf
    meshes : sequence of UrdfMesh
        Its own, for show or for collisions.
    places : mapping of str to int
        Joints that move: the frame behind each.
    file : Path
        The URDF file, beside which the meshes are.
    """
    try:
        return tuple(_shape(urdf, mesh, places, file) for mesh in meshes), ""
    except StudyError as error:
        return (), str(error)


def _shape(urdf: Urdf, mesh: UrdfMesh, places: Mapping[str, int], file: Path) -> Shape:
    frame, place = 0, np.eye(4)
    for joint in urdf.above(mesh.link):
        place = place @ joint.origin
        if joint.name in places:
            frame, place = places[joint.name], np.eye(4)
    return Shape(frame, place @ mesh.origin, mesh.scale, _mesh_file(mesh.file, file))


def _mesh_file(name: str, file: Path) -> Path:
    """Mesh file of a name: beside the URDF file, or in a package that one of the folders above it holds or is."""
    if Path(name).suffix.lower() not in KINDS:
        raise StudyError(f"{name!r} is no mesh that the viewer can show, which are {', '.join(KINDS)}")
    folder, package = file.resolve().parent, next((prefix for prefix in _PACKAGES if name.startswith(prefix)), None)
    if package is None:
        places = [folder / unquote(name.removeprefix("file://"))] if name.startswith("file://") else [folder / name]
    else:
        first, _, rest = name.removeprefix(package).partition("/")
        above = [folder, *folder.parents]
        places = [up / first / rest for up in above] + [up / rest for up in above if up.name == first]
    for place in places:
        try:
            if place.is_file():
                return place
        except (OSError, ValueError):  # too long for this system, or with a zero byte
            break
    raise StudyError(f"{name!r} is not there")
