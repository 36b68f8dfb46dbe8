"""Check of what a stored result holds, so that a file whose checksums fit a foreign content ends in a sentence too."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from study.store.kept import Arrays, Encoded

REQUIRED: dict[str, type] = {"message": str, "iterations": int, "details": dict}
OPTIONAL: dict[str, type] = {"lower_bound": float, "motion": str, "verdict": dict}
VERDICT: dict[str, type] = {"duration": float, "continuity": int, "violation": float, "reasons": Sequence}
NUMBERS: dict[str, type] = {"wall_time": float, "evaluations": int}

SHAPES: dict[str, tuple[int, int] | tuple[int]] = {
    "ratios": (3, 0), "peaks": (3, 0), "times": (3, 0), "segments": (3, 0), "position_excess": (0,), "waypoint_error": (0,),
    "end_velocity": (2, 0), "end_acceleration": (2, 0), "overshoot": (0,), "arm_shares": (2, 2), "arm_times": (2,),
}  # fmt: skip
"""Shapes of a verdict's arrays; the number of joints is added to the last axis."""


def parsed(text: str | bytes) -> Any:
    """Read JSON.

    Raises
    ------
    ValueError
        If it is none, or nested too deeply.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def check_result(encoded: Encoded) -> None:
    """Make sure that an outcome holds a planner's result: the kinds of all numbers and texts, the shapes of all arrays.

    Raises
    ------
    ValueError
        If it does not.
    """
    document, arrays = encoded.document, encoded.arrays
    _check(document, REQUIRED)
    _check(document, {name: kind for name, kind in OPTIONAL.items() if name in document})
    _check(vars(encoded), NUMBERS)
    for details in (document["details"], encoded.times):
        _check(details, dict.fromkeys(details, float))
    if arrays["history"].ndim != 2 or arrays.get("durations", arrays["history"][:, 0]).ndim != 1:
        raise ValueError("its history or its durations have another shape")
    if "verdict" in document:
        _check_verdict(document["verdict"], arrays)


def _check_verdict(verdict: Mapping[str, Any], arrays: Arrays) -> None:
    _check(verdict, VERDICT)
    _check(dict(enumerate(verdict["reasons"])), dict.fromkeys(range(len(verdict["reasons"])), str))
    joints = arrays["verdict.ratios"].shape[-1]
    for name, (*first, last) in SHAPES.items():
        if arrays[f"verdict.{name}"].shape != (*first, last + joints):
            raise ValueError(f"the verdict's {name} have another shape")


def _check(content: Mapping[Any, Any], kinds: Mapping[Any, type]) -> None:
    for name, kind in kinds.items():
        if not isinstance(content[name], kind) or isinstance(content[name], bool):
            raise ValueError(f"{name!r} is {type(content[name]).__name__}, not {kind.__name__}")
