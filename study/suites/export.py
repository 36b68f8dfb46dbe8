"""Runs of a suite in the formats of benchmarking platforms: IOHprofiler's, COCO's archives, and one Parquet file.

References
----------
Hansen, Auger, Ros, Mersmann, Tusar, Brockhoff: COCO, Optim. Methods Softw. 36 (2021): `.info` files name the runs, `.dat` and `.tdat`
files hold them, with a line for every improvement.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import groupby
from pathlib import Path

import numpy as np

from study.cases.suites import Suite
from study.choices import Choice
from study.comparison.contestants import Contestant, Level
from study.comparison.ioh import from_first_evaluation, write_ioh
from study.errors import StudyError
from study.files import replacing, write_file
from study.problem import Floats
from study.suites.measures import FAILED, Field
from study.suites.runs import Run, write_runs

PRECISION = 1e-8
"""Share above the best known that COCO counts as its final target."""

COLUMNS = (
    "% f evaluations | g evaluations | best noise-free fitness - Fopt (1.0) + sum g_i+ | measured fitness | best measured fitness"
    " or single-digit g-values | x1 | x2..."
)


class Platform(Choice):
    """Format of an export."""

    IOH = "ioh"
    COCO = "coco"
    PARQUET = "parquet"


def export(suite: Suite, field: Field, platform: Platform, folder: Path) -> list[Path]:
    """Write runs into a folder, made if need be; the platforms take searches alone, Parquet all runs.

    Returns
    -------
    list of Path
        Files that name the others.

    Raises
    ------
    StudyError
        If there is no run to write, or the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StudyError(f"{str(folder)!r} cannot be written: {error.strerror}; choose another folder") from None
    if platform is Platform.PARQUET:
        path = folder / f"{suite.name}.parquet"
        with replacing(path) as part:
            write_runs(part, field.runs)
        return [path]
    searches = {name: runs for name, runs in field.by_method.items() if runs[0].evaluations}
    if not searches:
        raise StudyError(
            f"no search among the runs of suite {suite.name!r}; {platform} takes searches, parquet all runs"
        )
    return _WRITERS[platform](suite, field, searches, folder)


Searches = Mapping[str, list[Run]]


def _by_problem(runs: Iterable[Run]) -> list[tuple[str, list[Run]]]:
    ordered = sorted(runs, key=lambda run: (run.problem, run.seed))
    return [(name, list(group)) for name, group in groupby(ordered, lambda run: run.problem)]


def _algorithm(run: Run) -> str:
    return f"{run.planner}-{run.evaluations}"


def _anytime(run: Run) -> Floats:
    """Evaluations and best duration so far, s; where no curve was kept the end alone, and nothing of a failure."""
    if not run.feasible:
        return np.empty((0, 2))
    return run.curve if run.curve_above else np.array([[run.cost, run.duration]], dtype=float)


def _ioh(suite: Suite, field: Field, searches: Searches, folder: Path) -> list[Path]:
    """IOHprofiler: an algorithm for every search and budget, a function for every problem, durations in s."""
    contestants = [
        Contestant(
            problem.removeprefix(f"{suite.name}:"),
            _algorithm(group[0]),
            Level.SCALED,
            durations=np.array([run.duration if run.feasible else np.inf for run in group]),
            totals=np.array([run.duration for run in group]),
            histories=tuple(map(_anytime, group)),
            spent=np.array([run.cost for run in group], dtype=float),
            wall=np.array([run.wall_time for run in group]),
        )
        for runs in searches.values()
        for problem, group in _by_problem(runs)
    ]
    return write_ioh(
        folder, contestants, {run.problem.removeprefix(f"{suite.name}:"): run.segments for run in field.runs}
    )


def _coco(suite: Suite, field: Field, searches: Searches, folder: Path) -> list[Path]:
    """COCO: a folder for every search and budget, a function for every problem, the segments as dimension, seeds as instances.

    Values are durations over the best known of the curve, so that Fopt is 1 and COCO's targets are shares above it; a failure stands
    with `FAILED`, and so does evaluation 1, of which nothing is known.
    """
    numbers = {name: number for number, name in enumerate(sorted({run.problem for run in field.runs}), start=1)}
    return [
        _function(suite, field, group, numbers[problem], folder / _algorithm(group[0]))
        for runs in searches.values()
        for problem, group in _by_problem(runs)
    ]


def _function(suite: Suite, field: Field, runs: list[Run], number: int, home: Path) -> Path:
    first = runs[0]
    best = field.best.get((first.problem, first.kind), np.inf)
    data = Path(f"data_f{number}") / f"bbobexp_f{number}_DIM{first.segments}"
    rows = [_rows(run, best) for run in runs]
    text = "".join(f"{COLUMNS}\n" + "".join(map(_line, each.tolist())) for each in rows)
    for ending in (".dat", ".tdat"):
        write_file(home / f"{data}{ending}", text)
    ends = [f"{run.seed + 1}:{run.cost}|{each[-1, 1] - PRECISION:.1e}" for run, each in zip(runs, rows, strict=True)]
    head = (
        f"suite = 'time-optimal-study-{suite.name}', funcId = {number}, DIM = {first.segments}, Precision = {PRECISION:.3e}, "
        f"algId = '{_algorithm(first)}', coco_version = '', logger = 'time-optimal-study', data_format = 'bbob-new2'"
    )
    about = f"% {first.problem}, suite checksum {suite.checksum}, best known {best!r} s"
    lines = [head, about, ", ".join([f"{data.as_posix()}.dat", *ends])]
    return write_file(home / f"bbobexp_f{number}.info", "\n".join(lines) + "\n")


def _rows(run: Run, best: float) -> Floats:
    """Evaluations and shares above the best known, from evaluation 1 to the last, shape (n_rows, 2)."""
    history = _anytime(run)
    shares = np.column_stack([history[:, 0], np.clip(history[:, 1] / best - 1.0, 0.0, FAILED)])
    rows = from_first_evaluation(shares, FAILED)
    return rows if rows[-1, 0] >= run.cost else np.vstack([rows, [run.cost, rows[-1, 1]]])


def _line(row: list[float]) -> str:
    evaluations, share = row
    return f"{int(evaluations)} 0 {share:+.9e} {1.0 + share:+.9e} {1.0 + share:+.9e}\n"


_WRITERS: Mapping[Platform, Callable[[Suite, Field, Searches, Path], list[Path]]] = {
    Platform.IOH: _ioh,
    Platform.COCO: _coco,
}
