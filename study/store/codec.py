"""Results as text and arrays and back, exact to the last bit and the same bytes every time; never pickle."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import lru_cache
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.errors import StudyError
from study.judge import Verdict
from study.parametric import ParametricTrajectory
from study.planning import RunSettings
from study.problem import Problem
from study.store.content import check_result, parsed
from study.store.kept import Arrays, Encoded
from study.store.results import Cell, Result
from study.trajectory import Motion, Trajectory

MOTIONS: dict[str, type[Trajectory] | type[ParametricTrajectory]] = {
    "Trajectory": Trajectory,
    "ParametricTrajectory": ParametricTrajectory,
}
MEASURED = "_seconds"
"""Details whose names end so are wall times: kept, but outside what two equal runs have in common."""

MAGIC = b"tos-arrays\n"
"""Begins a stored block of arrays."""

_ENCODER = json.JSONEncoder(sort_keys=True, separators=(",", ":"))
_VERDICT_SCALARS = ("duration", "continuity", "violation", "reasons")
_VERDICT_ARRAYS = tuple(field.name for field in fields(Verdict) if field.name not in _VERDICT_SCALARS)
_MOTION_ARRAYS = {name: tuple(field.name for field in fields(kind)) for name, kind in MOTIONS.items()}
_SEEDLESS = tuple(field.name for field in fields(RunSettings) if field.name != "seed")
_seedless = attrgetter(*_SEEDLESS)


def canonical(document: object) -> str:
    """Write JSON in one fixed way: sorted keys, no spaces, shortest exact floats."""
    return _ENCODER.encode(document)


def checksum(document: object) -> str:
    """SHA-256 of plain data, in hexadecimal."""
    return hashlib.sha256(canonical(document).encode()).hexdigest()


def plain(content: object) -> object:
    """Turn dataclasses, arrays, enumerations and sequences into plain data that says everything that they hold.

    Raises
    ------
    TypeError
        If the content holds anything else, of which no checksum could be trusted.
    """
    if content is None or isinstance(content, bool | int | float | str):
        return content.value if isinstance(content, Enum) else content
    if isinstance(content, Enum):
        return content.name
    if isinstance(content, np.ndarray):
        return content.tolist()
    if isinstance(content, Mapping):
        return {str(name): plain(part) for name, part in content.items()}
    if isinstance(content, list | tuple | range):
        return [plain(part) for part in content]
    if is_dataclass(content):
        return [type(content).__qualname__, {part.name: plain(getattr(content, part.name)) for part in fields(content)}]
    raise TypeError(f"no checksum can be made of {content!r}")


@lru_cache(maxsize=1024)
def problem_digest(problem: Problem) -> str:
    """Checksum of everything a planner sees of a problem."""
    return checksum(plain(problem))


def cell_digest(problem: Problem, cell: Cell) -> str:
    """Checksum of the content of a cell, its seed left out: a changed waypoint, limit or setting is another cell."""
    return _cell_digest(problem_digest(problem), cell.planner, _seedless(cell.settings))


@lru_cache(maxsize=4096)
def _cell_digest(problem: str, planner: str, settings: tuple[object, ...]) -> str:
    return checksum([problem, planner, _settings_text(settings)])


def settings_text(settings: RunSettings) -> str:
    """Write run settings without the seed as JSON, the inverse of `settings_from`."""
    return _settings_text(_seedless(settings))


@lru_cache(maxsize=4096)
def _settings_text(settings: tuple[object, ...]) -> str:
    return canonical(dict(zip(_SEEDLESS, settings, strict=True)))


def settings_from(text: str, seed: int) -> RunSettings:
    """Read run settings from JSON and a seed."""
    return RunSettings(**parsed(text), seed=seed)


def pack_arrays(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Write named arrays one after the other behind a header that names them.

    A NumPy archive says the same in three times the room and ten times the time.

    Raises
    ------
    ValueError
        If an array holds anything but numbers.
    """
    parts = {name: np.asarray(array, order="C") for name, array in arrays.items()}
    header = _header(tuple((name, part.dtype, part.shape) for name, part in parts.items()))
    return b"".join((header, *(part.tobytes() for part in parts.values())))


@lru_cache(maxsize=4096)
def _header(parts: tuple[tuple[str, np.dtype[Any], tuple[int, ...]], ...]) -> bytes:
    """Name arrays; cells of a sweep have the same ones."""
    text = canonical([[name, _check_numbers(name, dtype).str, shape] for name, dtype, shape in parts]).encode()
    return MAGIC + len(text).to_bytes(4, "little") + text


def unpack_arrays(blob: bytes) -> dict[str, NDArray[Any]]:
    """Read what `pack_arrays` wrote.

    Raises
    ------
    ValueError
        If the block is anything else; pickled objects are refused.
    """
    if not blob.startswith(MAGIC):
        raise ValueError("this is no block of arrays")
    start = len(MAGIC) + 4
    place = start + int.from_bytes(blob[len(MAGIC) : start], "little")
    arrays: dict[str, NDArray[Any]] = {}
    for name, text, shape in parsed(blob[start:place]):
        dtype = _check_numbers(name, np.dtype(text))
        count = math.prod(shape)
        arrays[name] = np.frombuffer(blob, dtype, count, place).reshape(shape).copy()
        place += count * dtype.itemsize
    return arrays


def _check_numbers(name: str, dtype: np.dtype[Any]) -> np.dtype[Any]:
    if dtype.kind not in "biuf":
        raise ValueError(f"only arrays of numbers can be stored, {name!r} is of {dtype}")
    return dtype


def encode(result: Result) -> Encoded:
    """Turn a result, without its cell, into plain data.

    Raises
    ------
    StudyError
        If the motion is of a kind that cannot be stored exactly.
    """
    details = {name: float(value) for name, value in result.details.items()}
    document: dict[str, object] = {
        "message": result.message,
        "iterations": int(result.iterations),
        "details": {name: value for name, value in details.items() if not name.endswith(MEASURED)},
    }
    if result.lower_bound is not None:
        document["lower_bound"] = float(result.lower_bound)
    arrays = {"history": np.asarray(result.history)}
    if result.durations is not None:
        arrays["durations"] = np.asarray(result.durations)
    if result.motion is not None:
        document["motion"] = type(result.motion).__name__
        arrays.update(_motion_arrays(result.motion))
    verdict = result.verdict
    if verdict is not None:
        document["verdict"] = {name: getattr(verdict, name) for name in _VERDICT_SCALARS}
        arrays.update({f"verdict.{name}": getattr(verdict, name) for name in _VERDICT_ARRAYS})
    return Encoded(
        document,
        arrays,
        times={name: value for name, value in details.items() if name.endswith(MEASURED)},
        wall_time=float(result.wall_time),
        status=result.status,
        feasible=result.feasible,
        duration=None if verdict is None else verdict.duration,
        worst_ratio=None if verdict is None else verdict.worst_ratio,
        evaluations=int(result.evaluations),
    )


def decode(cell: Cell, encoded: Encoded) -> Result:
    """Turn what `encode` made back into a result.

    Raises
    ------
    ValueError
        If it holds anything else.
    """
    check_result(encoded)
    document, arrays = encoded.document, encoded.arrays
    return Result(
        cell=cell,
        status=encoded.status,
        message=document["message"],
        motion=_motion(document["motion"], arrays) if "motion" in document else None,
        verdict=_verdict(document["verdict"], arrays) if "verdict" in document else None,
        durations=arrays.get("durations"),
        evaluations=encoded.evaluations,
        iterations=document["iterations"],
        history=arrays["history"],
        details=document["details"] | encoded.times,
        wall_time=encoded.wall_time,
        lower_bound=document.get("lower_bound"),
    )


def check_storable(motion: Motion) -> None:
    """Refuse a motion of a kind that cannot be stored exactly.

    Raises
    ------
    StudyError
        If the motion is not one of the kinds in `MOTIONS`.
    """
    name = type(motion).__name__
    if MOTIONS.get(name) is not type(motion):
        raise StudyError(f"a motion must be one of {', '.join(MOTIONS)}, the planner returned a {name}")


def _motion_arrays(motion: Motion) -> dict[str, NDArray[Any]]:
    check_storable(motion)
    return {f"motion.{name}": getattr(motion, name) for name in _MOTION_ARRAYS[type(motion).__name__]}


def _motion(name: str, arrays: Arrays) -> Motion:
    parts = {key.removeprefix("motion."): value for key, value in arrays.items() if key.startswith("motion.")}
    return MOTIONS[name](**parts)


def _verdict(scalars: Mapping[str, Any], arrays: Arrays) -> Verdict:
    tables: dict[str, Any] = {name: arrays[f"verdict.{name}"] for name in _VERDICT_ARRAYS}
    return Verdict(**{**scalars, **tables, "reasons": tuple(scalars["reasons"])})
