"""The line-up of the last run, noted in the results file so that `study report` shows the same cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path

from study.errors import StudyError
from study.store.codec import settings_from, settings_text
from study.store.results import Cell
from study.store.store import Store

LINEUP = "line-up"


def remember_lineup(store: Store, cells: Sequence[Cell], sources: Mapping[str, str]) -> None:
    """Note the cells of a run.

    Parameters
    ----------
    store : Store
    cells : sequence of Cell
    sources : mapping of str to str
        For every case, the name or path it was loaded from.
    """
    groups = groupby(cells, lambda cell: [cell.case, cell.planner, cell.label, settings_text(cell.settings)])
    runs = [[*shared, [cell.settings.seed for cell in members]] for shared, members in groups]
    store.note(LINEUP, {"cells": runs, "sources": dict(sources)})


def remembered_lineup(path: Path) -> tuple[list[Cell], dict[str, str]]:
    """Cells of the last run into a file, and the names or paths that its cases were loaded from.

    Raises
    ------
    StudyError
        If there is no results file, or its line-up cannot be read.
    """
    with Store(path, write=False) as store:
        noted = store.noted(LINEUP) or {"cells": [], "sources": {}}
    try:
        cells = [
            Cell(str(case), str(planner), str(label), settings_from(settings, int(seed)))
            for case, planner, label, settings, seeds in noted["cells"]
            for seed in seeds
        ]
        return cells, {str(case): str(source) for case, source in noted["sources"].items()}
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise StudyError(f"results file {path}: its line-up cannot be read ({error}); run `study run` again") from error
