"""Recordings as NumPy arrays and as Parquet tables."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError, plural
from study.files import MOST_BYTES, read_file
from study.io.columns import sampled_columns
from study.io.samples import Samples
from study.problem import Floats

POSITIONS = dict.fromkeys(
    ("position", "positions", "q", "qpos", "waypoints", "joint_positions", "observation.state")
).keys()
TIMES = ("time", "times", "t", "timestamp", "timestamps")
VELOCITIES = ("velocity", "velocities", "qd", "qvel", "joint_velocities")
ACCELERATIONS = ("acceleration", "accelerations", "qdd")
PYTHON_VALUE = 32
"""Bytes that a value of a table takes in memory."""

NAMES = ("joint_names", "names", "joints")
EXACT = ("knots", "coefficients", "time_coefficients", "position_coefficients", "waypoint_times", "jerk")
"""Arrays of a motion that `study.io.export` writes beside its samples."""


def samples_from_numpy(path: Path) -> Samples:
    """Read `.npy`, rows of positions, or `.npz` with positions and what else is known.

    Raises
    ------
    StudyError
        If the file is no such archive, holds Python objects, or has no array of positions.
    """
    return samples_from_arrays(load_arrays(path), f"file {path.name!r}")


def load_arrays(path: Path) -> dict[str, Any]:
    """Read the arrays of a NumPy file by name; a single one stands under `position`.

    Raises
    ------
    StudyError
        If the file is no such archive or holds Python objects.
    """
    try:
        raw = io.BytesIO(read_file(path))
        if zipfile.is_zipfile(raw):
            _check_size(sum(part.file_size for part in zipfile.ZipFile(raw).infolist()), path)
        raw.seek(0)
        with np.errstate(all="ignore"):
            content = np.load(raw, allow_pickle=False)
        arrays = {"position": content} if isinstance(content, np.ndarray) else dict(content)
        _check_size(
            sum(array.nbytes or 8 * array.size for array in arrays.values()), path
        )  # texts of no length take none
        return arrays
    except StudyError:
        raise
    except Exception as error:  # a damaged archive raises whatever the part that reads it makes of it
        raise StudyError(f"file {path.name!r} is no NumPy file of numbers: {error}") from None


def _check_size(size: int, path: Path) -> None:
    """Refuse what a small file unpacks to if no file of that size would be read."""
    if size > MOST_BYTES:
        raise StudyError(f"file {path.name!r} cannot be read: unpacked it is larger than {MOST_BYTES / 2**20:g} MB")


def samples_from_arrays(arrays: Mapping[str, Any], where: str) -> Samples:
    """Read positions, times, rates, names and units from arrays or lists under the names that programs give them.

    Raises
    ------
    StudyError
        If there are no positions, or an array is not of numbers or of another shape than they are.
    """
    used = set()

    def first(names: Iterable[str]) -> Any:
        name = next((name for name in names if name in arrays), None)
        used.add(name)
        return None if name is None else arrays[name]

    positions = first(POSITIONS)
    if positions is None:
        known = ", ".join(list(POSITIONS)[:4])
        raise StudyError(f"{where} has no array of positions ({known}); it has {', '.join(arrays)}")
    table = _matrix(positions, where, None)
    names, times, units = first(NAMES), first(TIMES), first(("units",))
    velocities, accelerations = first(VELOCITIES), first(ACCELERATIONS)
    ours = {*EXACT, "waypoints"} if "waypoint_times" in arrays else set()
    unused = [str(name) for name in arrays if name not in used | ours]
    titles, listed = (tuple(map(str, np.ravel([] if part is None else part))) for part in (names, units))
    for part, noun in ((titles, "joint name"), (listed * (len(listed) > 1), "unit")):
        if part and len(part) != table.shape[1]:
            raise StudyError(
                f"{where} has {plural(len(part), noun)} for {plural(table.shape[1], 'column')} of positions"
            )
    return Samples(
        positions=table,
        names=titles,
        times=None if times is None else _matrix(times, where, (len(table),)),
        velocities=None if velocities is None else _matrix(velocities, where, table.shape),
        accelerations=None if accelerations is None else _matrix(accelerations, where, table.shape),
        notes=(f"not used: array {', '.join(map(repr, unused[:8]))}",) if unused else (),
        units=listed * table.shape[1] if len(listed) == 1 else listed,
    )


def floats(values: Any) -> Floats:
    """Take real numbers of any kind.

    Raises
    ------
    TypeError, ValueError
        If they are complex, dates or no numbers at all.
    """
    array = np.asarray(values)
    if array.dtype.kind in "cmMV":
        raise ValueError(f"values of {array.dtype} are no real numbers")
    with np.errstate(all="ignore"):
        return array.astype(float)


def _matrix(values: Any, where: str, shape: tuple[int, ...] | None) -> Floats:
    try:
        array = floats(values)
    except (TypeError, ValueError, OverflowError):
        raise StudyError(f"{where}: an array of positions, rates or times holds no numbers") from None
    wrong = array.ndim != 2 if shape is None else array.shape != shape
    if wrong or not array.size or not np.isfinite(array).all():
        expected = "shape (n_rows, n_joints)" if shape is None else f"shape {shape}"
        raise StudyError(f"{where}: expected finite numbers of {expected}, got shape {array.shape}")
    return array


def samples_from_parquet(path: Path) -> Samples:
    """Read a table of numbers, or a LeRobot episode, whose positions stand in lists under `observation.state`.

    Raises
    ------
    StudyError
        If the package that reads Parquet is missing, the file is none, or it holds several episodes.
    """
    where = f"file {path.name!r}"
    try:
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        raise StudyError(f"{where}: reading Parquet needs the package 'pyarrow'; pip install pyarrow") from None
    try:
        file = pq.ParquetFile(io.BytesIO(read_file(path)), pre_buffer=False)
        groups = [file.metadata.row_group(k) for k in range(file.metadata.num_row_groups)]
        values = file.metadata.num_rows * file.metadata.num_columns  # a damaged column's own number ends the process
        _check_size(max(PYTHON_VALUE * values, *(group.total_byte_size for group in groups), 0, 0), path)
        table = file.read(use_threads=False)  # a thread that fails on damage ends the process
        columns = {name: table.column(name).to_pylist() for name in table.column_names}
    except StudyError:
        raise
    except Exception as error:  # a damaged table raises whatever the part that reads it makes of it
        raise StudyError(f"{where} is no Parquet file that can be read: {error}") from None
    if len(set(columns.get("episode_index", [0]))) > 1:
        raise StudyError(f"{where} holds several episodes; write one of them to a file of its own")
    if "observation.state" in columns:
        arrays = {name: columns[name] for name in ("observation.state", "timestamp") if name in columns}
        unused = [name for name in columns if name not in arrays]
        samples = samples_from_arrays(arrays, where)
        return samples.noting(f"not used: column {', '.join(map(repr, unused[:8]))}") if unused else samples
    numeric = [name for name, values in columns.items() if all(isinstance(value, int | float) for value in values)]
    if not numeric or not len(table):
        raise StudyError(f"{where} has no columns of numbers")
    return sampled_columns(numeric, _matrix([columns[name] for name in numeric], where, None).T)
