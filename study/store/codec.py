"""Results as text and arrays and back, exact to the last bit and the same bytes every time; never pickle."""

from __future__ import annotations

import hashlib
import io
import json
import math
from collections.abc import Mapping, Sequence
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
from study.planning import RunSettings, Status
from study.problem import Problem
from study.store.results import Cell, Result
from study.trajectory import Motion, Trajectory

Arrays = dict[str, NDArray[Any]]
MOTIONS: dict[str, type[Trajectory] | type[ParametricTrajectory]] = {
    "Trajectory": Trajectory,
    "ParametricTrajectory": ParametricTrajectory,
}
RESULTS_FORMAT = 2
"""Counted up when what is stored about a cell changes its meaning, so that every cell is run again."""

MEASURED = "_seconds"
"""Details whose names end so are wall times: kept, but outside what two equal runs have in common."""

MAGIC = b"tos-arrays\n"
"""Begins a stored block of arrays; a NumPy archive begins with PK."""

_ENCODER = json.JSONEncoder(sort_keys=True, separators=(",", ":"))
_VERDICT_SCALARS = ("duration", "continuity", "violation", "reasons")
_VERDICT_ARRAYS = tuple(field.name for field in fields(Verdict) if field.name not in _VERDICT_SCALARS)
_MOTION_ARRAYS = {name: tuple(field.name for field in fields(kind)) for name, kind in MOTIONS.items()}
_SEEDLESS = tuple(field.name for field in fields(RunSettings) if field.name != "seed")
_seedless = attrgetter(*_SEEDLESS)


def canonical(document: object) -> str:
    """Write JSON in one fixed way: sorted keys, no spaces, shortest exact floats."""
    return _ENCODER.encode(document)


def problem_content(problem: Problem) -> object:
    """Everything a planner sees of a problem, as plain data."""
    return plain(problem)


def plain(value: object) -> object:
    """Turn dataclasses, arrays and enumerations into plain data that JSON can hold."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Enum):
        return value.name
    if is_dataclass(value):
        parts = {field.name: plain(getattr(value, field.name)) for field in fields(value)}
        return {"kind": type(value).__name__} | parts  # a tube and a straight path may have the same parts
    if isinstance(value, Mapping):
        return [[plain(key), plain(held)] for key, held in sorted(value.items())]
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [plain(held) for held in value]
    return value


def cell_key(cell: Cell, problem: Problem, version: str) -> str:
    """Name a cell by what determines its result.

    Parameters
    ----------
    cell : Cell
    problem : Problem
        The case's content: a changed waypoint or limit is another cell.
    version : str
        Of the code that runs.

    Returns
    -------
    str
        SHA-256 in hexadecimal.
    """
    return cell_key_in(problem_digest(problem), cell, version)


def problem_digest(problem: Problem) -> str:
    """Checksum of everything a planner sees of a problem."""
    return hashlib.sha256(canonical(problem_content(problem)).encode()).hexdigest()


def cell_key_in(problem: str, cell: Cell, version: str) -> str:
    """Name a cell, as `cell_key` does, from the checksum of its problem; a sweep makes each problem's once."""
    before, after = _around_seed_in_key(problem, cell.planner, version, _seedless(cell.settings))
    return hashlib.sha256(f"{before}{cell.settings.seed}{after}".encode()).hexdigest()


@lru_cache(maxsize=4096)
def _around_seed_in_key(problem: str, planner: str, version: str, settings: tuple[object, ...]) -> tuple[str, str]:
    """Cut what a key is made of at the seed, the one thing that changes from cell to cell of a sweep."""
    before, after = (canonical(part)[1:-1] for part in _around_seed(settings))
    start, end = canonical([RESULTS_FORMAT, problem, planner])[:-1], canonical([version])[1:]
    return f'{start},"{before}', f'{after}",{end}'


def settings_text(settings: RunSettings) -> str:
    """Write run settings as JSON, the inverse of `settings_from`."""
    before, after = _around_seed(_seedless(settings))
    return f"{before}{settings.seed}{after}"


@lru_cache(maxsize=4096)
def _around_seed(settings: tuple[object, ...]) -> tuple[str, str]:
    before, name, after = canonical({**dict(zip(_SEEDLESS, settings, strict=True)), "seed": 0}).partition('"seed":')
    return before + name, after[1:]


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


def unpack_arrays(blob: bytes) -> Arrays:
    """Read what `pack_arrays` wrote, or the NumPy archive of the first layout; pickled objects are refused."""
    if not blob.startswith(MAGIC):
        with np.load(io.BytesIO(blob), allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    start = len(MAGIC) + 4
    place = start + int.from_bytes(blob[len(MAGIC) : start], "little")
    arrays: Arrays = {}
    for name, text, shape in json.loads(blob[start:place]):
        dtype = _check_numbers(name, np.dtype(text))
        count = math.prod(shape)
        arrays[name] = np.frombuffer(blob, dtype, count, place).reshape(shape).copy()
        place += count * dtype.itemsize
    return arrays


def _check_numbers(name: str, dtype: np.dtype[Any]) -> np.dtype[Any]:
    if dtype.kind not in "biuf":
        raise ValueError(f"only arrays of numbers can be stored, {name!r} is of {dtype}")
    return dtype


def encode(result: Result) -> tuple[str, bytes]:
    """Turn a result, without its cell and wall times, into a JSON document and a block of arrays.

    Raises
    ------
    StudyError
        If the motion is of a kind that cannot be stored exactly.
    """
    document: dict[str, object] = {
        "status": result.status.name,
        "message": result.message,
        "evaluations": int(result.evaluations),
        "iterations": int(result.iterations),
        "details": {name: float(value) for name, value in result.details.items() if not name.endswith(MEASURED)},
    }
    arrays: Arrays = {"history": np.asarray(result.history)}
    if result.durations is not None:
        arrays["durations"] = np.asarray(result.durations)
    if result.motion is not None:
        document["motion"] = type(result.motion).__name__
        arrays.update(_motion_arrays(result.motion))
    if result.verdict is not None:
        document["verdict"] = {name: getattr(result.verdict, name) for name in _VERDICT_SCALARS}
        arrays.update({f"verdict.{name}": getattr(result.verdict, name) for name in _VERDICT_ARRAYS})
    return canonical(document), pack_arrays(arrays)


def encode_times(result: Result) -> str:
    """Write the wall times that a planner noted among its details as JSON."""
    return canonical({name: float(value) for name, value in result.details.items() if name.endswith(MEASURED)})


def decode(cell: Cell, document_text: str, blob: bytes, wall_time: float, times: str = "{}") -> Result:
    """Turn what `encode` and `encode_times` wrote back into a result."""
    document, arrays = json.loads(document_text), unpack_arrays(blob)
    return Result(
        cell=cell,
        status=Status[document["status"]],
        message=document["message"],
        motion=_motion(document["motion"], arrays) if "motion" in document else None,
        verdict=_verdict(document["verdict"], arrays) if "verdict" in document else None,
        durations=arrays.get("durations"),
        evaluations=document["evaluations"],
        iterations=document["iterations"],
        history=arrays["history"],
        details=document["details"] | json.loads(times),
        wall_time=wall_time,
    )


def settings_from(text: str) -> RunSettings:
    """Read run settings from JSON."""
    return RunSettings(**json.loads(text))


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


def _motion_arrays(motion: Motion) -> Arrays:
    check_storable(motion)
    return {f"motion.{name}": getattr(motion, name) for name in _MOTION_ARRAYS[type(motion).__name__]}


def _motion(name: str, arrays: Arrays) -> Motion:
    parts = {key.removeprefix("motion."): value for key, value in arrays.items() if key.startswith("motion.")}
    return MOTIONS[name](**parts)


def _verdict(scalars: Mapping[str, Any], arrays: Arrays) -> Verdict:
    tables: dict[str, Any] = {name: arrays[f"verdict.{name}"] for name in _VERDICT_ARRAYS}
    return Verdict(**{**scalars, **tables, "reasons": tuple(scalars["reasons"])})
