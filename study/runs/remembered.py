"""The line-up of every case of a results file: that of the last run of the case, which `study report` shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from study.errors import StudyError
from study.store.codec import settings_from, settings_text
from study.store.results import Cell
from study.store.store import Store

LINEUP = "line-up"
NOTHING: dict[str, Any] = {"cells": [], "sources": {}}


def remember_lineup(store: Store, cells: Sequence[Cell], sources: Mapping[str, str]) -> None:
    """Note the cells of a run; cases that it leaves out keep the cells of their own last run.

    Parameters
    ----------
    store : Store
    cells : sequence of Cell
    sources : mapping of str to str
        For every case, the name or path it was loaded from.
    """
    groups = groupby(cells, lambda cell: [cell.case, cell.planner, cell.label, settings_text(cell.settings)])
    runs = [[*shared, [cell.settings.seed for cell in members]] for shared, members in groups]
    before = store.noted(LINEUP) or NOTHING
    kept = [run for run in before["cells"] if run[0] not in sources]
    store.note(LINEUP, {"cells": [*kept, *runs], "sources": {**before["sources"], **sources}})


def remembered_lineup(path: Path) -> tuple[list[Cell], dict[str, str]]:
    """Cells of the last run of every case, and the names or paths that the cases were loaded from.

    Raises
    ------
    StudyError
        If there is no results file, or its line-up cannot be read.
    """
    with Store(path, write=False) as store:
        noted = store.noted(LINEUP) or NOTHING
    try:
        cells = [
            Cell(str(case), str(planner), str(label), settings_from(settings, seed))
            for case, planner, label, settings, seeds in noted["cells"]
            for seed in seeds
        ]
        return cells, {str(case): str(source) for case, source in noted["sources"].items()}
    except (ValueError, TypeError, KeyError, AttributeError, StudyError) as error:
        raise StudyError(f"results file {path}: its line-up cannot be read ({error}); run `study run` again") from error
