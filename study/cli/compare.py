"""What `study compare` does: run what is missing, write the pages, say where they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.progress import TaskID

from study.cases.library import Case
from study.cli.terminal import progress
from study.comparison import sentences
from study.comparison.build import compare
from study.comparison.effort import FULL, QUICK
from study.errors import StudyError
from study.runs.environment import environment


def compare_command(
    cases: Mapping[str, Case], store: Path, full: bool, seeds: int | None, jobs: int | None, console: Console
) -> Path:
    """Build the comparison of some cases from a store.

    Parameters
    ----------
    cases : mapping of str to Case
    store : Path
        The results file; the pages stand beside it in `report/comparison`.
    full : bool
        The papers' budgets and 30 repetitions.
    seeds : int, optional
        Repetitions of everything, in the place of the usual ones.
    jobs : int, optional
        Worker processes; all processors by default.
    console : rich.console.Console

    Raises
    ------
    StudyError
        If the store cannot be used, a library is missing, or the pages cannot be written.
    """
    effort = FULL if full else QUICK
    if seeds is not None and seeds < 2:
        raise StudyError(f"a comparison on paired seeds needs at least 2 seeds, got {seeds}")
    if seeds is not None:
        effort = replace(effort, seeds=seeds, trial_seeds=seeds, function_seeds=seeds)
    with progress(console) as bar:
        tasks: dict[str, TaskID] = {}

        def told(part: str, done: int, total: int) -> None:
            if part not in tasks:
                tasks[part] = bar.add_task(part, total=total)
            bar.update(tasks[part], completed=done)

        found = compare(cases, effort, store, jobs, told)
    with console.status("writing the pages"):
        from study.comparison.pages import write_pages  # here: matplotlib is slow to import

        page = write_pages(found, store.parent / "report" / "comparison", environment())
    for sentence in sentences.summary(found):
        console.print(sentence, soft_wrap=True)
    console.print(f"comparison: {page}", soft_wrap=True)
    return page
