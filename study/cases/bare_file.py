"""Waypoints alone, or a case without limits, completed by what is said beside the file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from study.errors import StudyError
from study.io.documents import parsed
from study.io.recordings import holds_samples


def bare_content(
    path: Path, units: str | None, limits: Sequence[Path], joints: str | None = None
) -> dict[str, Any] | None:
    """Content of a case file for waypoints alone, or for a case without limits, with what is said beside the file.

    Parameters
    ----------
    path : Path
    units, joints : str, optional
        One for all or a list with commas; names of the joints that are planned.
    limits : sequence of Path

    Returns
    -------
    dict of str to object, or None
        None for a case that says everything itself.

    Raises
    ------
    StudyError
        If limits are missing, or are given besides those of a case.
    """
    if holds_samples(path):
        if not limits:
            raise StudyError(
                f"file {path.name!r} holds waypoints only; add --limits with a joint_limits.yaml or a URDF, or write a case "
                "file, see `study init`"
            )
        content: dict[str, Any] = {"waypoints": path.name}
    elif limits or units or joints:
        given = parsed(path) if path.suffix.lower() in (".yaml", ".yml", ".json") else None
        content = dict(given) if isinstance(given, dict) else {}
        if content and not content.keys() & {"waypoints", "limits"}:
            keys = ", ".join(map(str, list(content)[:8]))
            raise StudyError(f"file {path.name!r} holds neither waypoints nor a trajectory; its keys are {keys}")
        if "waypoints" not in content or (set(content) & {"limits", *(("units",) if units else ())}):
            raise StudyError(
                f"--limits, --units and --joints go with waypoints alone; {str(path)!r} is a case, which says all three itself"
            )
    else:
        return None
    content |= {"limits": {"from": [str(file.resolve()) for file in limits]}}
    content |= {} if joints is None else {"joints": [name.strip() for name in joints.split(",")]}
    return content if units is None else content | {"units": units.split(",") if "," in units else units}
