"""Histories in the format of IOHprofiler, which IOHanalyzer and iohinspector read.

References
----------
de Nobel, Ye, Vermetten, Wang, Doerr, Baeck: IOHexperimenter (2021): one JSON file per algorithm and function, and one
data file per dimension in which every run begins with a header line and evaluation 1.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np

from study.comparison.contestants import Contestant
from study.files import write_file
from study.io.filenames import file_stem
from study.problem import Floats

HEADER = "evaluations raw_y"


def write_ioh(folder: Path, contestants: Sequence[Contestant], dimensions: Mapping[str, int]) -> list[Path]:
    """Write the histories of all contestants; planners and levels are algorithms, cases are functions.

    Our histories hold whole populations, so nothing is known at evaluation 1, where the format begins every run. There,
    and while nothing is found, stands the largest value that any run of the case recorded.

    Parameters
    ----------
    folder : Path
        Made if need be.
    contestants : sequence of Contestant
    dimensions : mapping of str to int
        Segments of every case.

    Returns
    -------
    list of Path
        The JSON files.
    """
    cases = sorted({run.case for run in contestants})
    worst = {case: _worst([run for run in contestants if run.case == case]) for case in cases}
    return [
        _write(folder, run, cases.index(run.case) + 1, dimensions[run.case], worst[run.case])
        for run in contestants
        if run.histories
    ]


def _worst(contestants: Sequence[Contestant]) -> float:
    values = [history[:, 1] for run in contestants for history in run.histories]
    finite = [column[np.isfinite(column)] for column in values]
    return max((float(column.max()) for column in finite if column.size), default=0.0)


def _write(folder: Path, contestant: Contestant, number: int, dimension: int, worst: float) -> Path:
    name, case = file_stem(f"{contestant.planner}-{contestant.level}"), file_stem(contestant.case)
    data = Path(f"data_f{number}_{case}") / f"IOHprofiler_f{number}_DIM{dimension}.dat"
    home = folder / name
    rows = [from_first_evaluation(history, worst) for history in contestant.histories]
    write_file(home / data, "".join(_block(run) for run in rows))
    runs = [
        {"instance": seed + 1, "evals": int(spent), "best": {"evals": int(run[-1, 0]), "y": float(run[-1, 1]), "x": []}}
        for seed, (run, spent) in enumerate(zip(rows, contestant.spent, strict=True))
    ]
    document = {
        "version": "0.3.18",
        "suite": "time-optimal-study",
        "function_id": number,
        "function_name": case,
        "maximization": False,
        "algorithm": {"name": name, "info": f"time-optimal-study {version('time-optimal-study')}"},
        "experiment_attributes": [{"formulation": contestant.level}],
        "attributes": HEADER.split(),
        "scenarios": [{"dimension": dimension, "path": data.as_posix(), "runs": runs}],
    }
    path = home / f"IOHprofiler_f{number}_{case}.json"
    return write_file(path, json.dumps(document, indent=1))


def from_first_evaluation(history: Floats, worst: float) -> Floats:
    """Improvements of one run from evaluation 1 on, where the worst value stands if nothing is known, shape (n_rows, 2)."""
    known = history[np.isfinite(history[:, 1])]
    improving = np.concatenate([[True], np.diff(known[:, 1]) < 0]) if len(known) else np.empty(0, dtype=bool)
    rows = known[improving]
    if not len(rows) or rows[0, 0] > 1:
        rows = np.vstack([[1.0, worst], rows])
    return rows


def _block(rows: Floats) -> str:
    return f"{HEADER}\n" + "".join(f"{int(n)} {value!r}\n" for n, value in rows.tolist())
