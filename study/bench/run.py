"""All measurements of one bench, as one record that reads from and writes to JSON."""

from __future__ import annotations

import json
import platform
import resource
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import TypeAdapter

from study import engine
from study.bench.end_to_end import end_to_end_rows
from study.bench.growth import Point, growth_points
from study.bench.kernels import kernel_rows
from study.bench.measuring import Measurement
from study.bench.output import output_rows
from study.bench.references import reference_rows
from study.bench.searches import search_rows
from study.errors import StudyError
from study.files import write_file
from study.io.text import read_text
from study.runs.environment import environment

VERSION = 2
QUICK_REPETITIONS, REPETITIONS = 5, 15
Told = Callable[[str], None]


@dataclass(frozen=True)
class Bench:
    """Measurements, with the machine and the settings.

    Attributes
    ----------
    environment : mapping of str to str
    quick : bool
    compile_seconds : mapping of str to float
        Time to make each kernel ready: compiled anew, or read from numba's cache where an earlier run left it.
    rows : tuple of Measurement
    growth : tuple of Point
    peak_bytes : int
        Largest memory of the whole process so far.
    """

    environment: Mapping[str, str]
    quick: bool
    compile_seconds: Mapping[str, float]
    rows: tuple[Measurement, ...]
    growth: tuple[Point, ...]
    peak_bytes: int


def measure(quick: bool, told: Told) -> Bench:
    """Measure everything, one part after the other.

    Parameters
    ----------
    quick : bool
        Fewer repetitions, and two cases for the deterministic planners.
    told : callable (part)
        Hears what is about to be measured.
    """
    n = QUICK_REPETITIONS if quick else REPETITIONS
    told("kernels")
    seconds = _compile_seconds()
    rows: list[Measurement] = [*kernel_rows(n)]
    told("searches")
    rows += search_rows(n)
    told("end to end")
    rows += end_to_end_rows(n)
    told("deterministic planners")
    rows += reference_rows(min(n, 3), quick)
    told("report and recording")
    rows += output_rows(min(n, 3))
    told("growth")
    growth = growth_points(3 if quick else n)
    return Bench(environment(), quick, seconds, tuple(rows), tuple(growth), _peak_bytes())


def _compile_seconds() -> dict[str, float]:
    if not engine.installed():
        return {}
    from study.curves.compiled.peaks import warm_up  # here: it imports numba

    return warm_up()


def _peak_bytes() -> int:
    """Largest resident memory of this process so far; the system counts it in bytes on macOS and in KiB elsewhere."""
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if platform.system() == "Darwin" else most * 1024


def write(bench: Bench, path: Path) -> None:
    """Write a bench as JSON.

    Raises
    ------
    StudyError
        If the file cannot be written.
    """
    rows = [asdict(row) | {"met": row.met} for row in bench.rows]
    write_file(path, json.dumps(asdict(bench) | {"version": VERSION, "python": sys.version, "rows": rows}, indent=1))


def read(path: Path) -> Bench:
    """Read a bench that `write` wrote.

    Raises
    ------
    StudyError
        If the file is missing or is no bench of this version.
    """
    try:
        record = json.loads(read_text(path))
        if record["version"] != VERSION:
            raise StudyError(f"{path}: expected measurements of version {VERSION}, got version {record['version']}")
        return TypeAdapter(Bench).validate_python(record)
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise StudyError(
            f"{path}: not the measurements of a bench ({str(error).partition(chr(10))[0]}); write them with `study bench`"
        ) from None
