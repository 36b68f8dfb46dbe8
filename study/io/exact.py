"""A motion as exact piecewise polynomials in JSON: every float is written so that it is read back to the last bit."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from study.errors import StudyError
from study.files import named
from study.io.arrays_file import floats, load_arrays
from study.io.documents import parsed
from study.parametric import ParametricTrajectory
from study.problem import Problem
from study.trajectory import Motion, Trajectory

HIGHEST_DEGREE = 50
"""Of polynomials that are read; roots of higher ones have no digits left."""

FORMAT = "time-optimal-study trajectory 1"
KINDS: dict[str, tuple[type[Trajectory] | type[ParametricTrajectory], tuple[str, ...]]] = {
    "polynomial": (Trajectory, ("knots", "coefficients", "waypoint_times")),
    "parametric": (ParametricTrajectory, ("time", "position")),
}
MEANING = {
    "polynomial": "q(t) = sum of coefficients[piece][k][joint] * (t - knots[piece])^k, in rad or m and s",
    "parametric": "t(u) and q(u) = sums of time[piece][k] * u^k and position[piece][k][joint] * u^k, u from 0 to 1",
}


def exact_text(motion: Motion, problem: Problem) -> str:
    """Write a motion down exactly.

    Raises
    ------
    StudyError
        If the motion is of a kind that is not made of polynomials.
    """
    for kind, (cls, parts) in KINDS.items():
        if isinstance(motion, cls):
            content = {
                "format": FORMAT,
                "kind": kind,
                "meaning": MEANING[kind],
                "name": problem.name,
                "joint_names": list(problem.joint_names),
                "waypoints": problem.waypoints.tolist(),
                **{part: getattr(motion, part).tolist() for part in parts},
            }
            return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    raise StudyError(f"a motion of type {type(motion).__name__} has no exact form here; write samples instead")


def read_exact(path: str | Path) -> Trajectory | ParametricTrajectory:
    """Read an exact motion back.

    Raises
    ------
    StudyError
        If the file cannot be read, is of another format or its numbers make no motion.
    """
    path = named(path)
    content = _archive(path) if path.suffix.lower() == ".npz" else _content(path)
    kind = content.get("kind")
    if content.get("format") != FORMAT or not isinstance(kind, str) or kind not in KINDS:
        raise StudyError(f"file {str(path)!r} is not an exact trajectory: its format must be {FORMAT!r}")
    cls, parts = KINDS[kind]
    missing = [part for part in parts if part not in content]
    if missing:
        raise StudyError(f"file {str(path)!r}: field {missing[0]!r} is missing; write the file again")
    try:
        return cls(*(floats(content[part]) for part in parts))
    except (StudyError, ValueError, TypeError, OverflowError, IndexError, RecursionError) as error:
        raise StudyError(f"file {str(path)!r}: {error}") from None


def _content(path: Path) -> dict[str, Any]:
    content = parsed(path)
    content = content if isinstance(content, dict) else {}
    degree = max(
        (len(piece) for part in ("coefficients", "time", "position") for piece in _pieces(content.get(part))), default=0
    )
    if degree > HIGHEST_DEGREE + 1:
        raise StudyError(
            f"file {str(path)!r}: polynomials of degree {degree - 1} are not read, at most {HIGHEST_DEGREE}"
        )
    return content


def _pieces(part: Any) -> list[Any]:
    return [piece for piece in part if isinstance(piece, list)] if isinstance(part, list) else []


def holds_coefficients(path: Path) -> bool:
    """Whether a file is an archive that holds the polynomials of a motion besides its samples."""
    if path.suffix.lower() != ".npz" or not os.path.isfile(path):
        return False
    return bool({"coefficients", "position_coefficients"} & set(load_arrays(path)))


def _archive(path: Path) -> dict[str, Any]:
    arrays = load_arrays(path)
    if "coefficients" in arrays:
        parts = ("knots", "coefficients", "waypoint_times")
        return {"format": FORMAT, "kind": "polynomial", **{part: arrays[part] for part in parts if part in arrays}}
    given = {"time": arrays.get("time_coefficients"), "position": arrays.get("position_coefficients")}
    return {"format": FORMAT, "kind": "parametric", **{name: part for name, part in given.items() if part is not None}}
