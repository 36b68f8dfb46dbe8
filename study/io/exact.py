"""A motion as exact piecewise polynomials in JSON: every float is written so that it is read back to the last bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError
from study.io.text import read_text
from study.parametric import ParametricTrajectory
from study.problem import Problem
from study.trajectory import Motion, Trajectory

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


def read_exact(path: Path) -> Trajectory | ParametricTrajectory:
    """Read an exact motion back.

    Raises
    ------
    StudyError
        If the file cannot be read, is of another format or its numbers make no motion.
    """
    content = _content(path)
    if content.get("format") != FORMAT or content.get("kind") not in KINDS:
        raise StudyError(f"file {str(path)!r} is not an exact trajectory: its format must be {FORMAT!r}")
    cls, parts = KINDS[content["kind"]]
    missing = [part for part in parts if part not in content]
    if missing:
        raise StudyError(f"file {str(path)!r}: field {missing[0]!r} is missing; write the file again")
    try:
        return cls(*(np.array(content[part], dtype=float) for part in parts))
    except (StudyError, ValueError, TypeError) as error:
        raise StudyError(f"file {str(path)!r}: {error}") from None


def _content(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise StudyError(f"file {str(path)!r} is not valid JSON at line {error.lineno}: {error.msg}") from None
    return content if isinstance(content, dict) else {}
