"""Steps shared by the commands: the run with its progress bar, the tables, the report and the recordings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from study.analysis.case_summary import summarise
from study.cases.library import Case
from study.cli import run_tables
from study.cli.folder import STORE_NAME, audit_flags, keep_to_oneself, write
from study.cli.screen import SafeConsole, progress_bar, running
from study.errors import Interrupted, StudyError, plural
from study.runs.dask import dask_executor
from study.runs.job import Job
from study.runs.progress import Progress
from study.runs.runner import RunOptions, default_jobs, run_jobs
from study.store.results import Result
from study.store.store import Store

INFEASIBLE = 3
"""Exit status where no feasible motion was found."""

Out = Annotated[Path, typer.Option("--out", help="Folder of the results, the report and the recordings.")]
Jobs = Annotated[int | None, typer.Option(help="Worker processes; all processors by default.")]
Fresh = Annotated[bool, typer.Option("--fresh", help="Run stored cells again too.")]
Memory = Annotated[int | None, typer.Option(help="MB that a worker may take beyond its libraries (Linux).", min=16)]
Dask = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Run on the workers of a Dask scheduler; `local` starts one.")
]


@dataclass(frozen=True)
class Workers:
    """Processes that run jobs, and how.

    Attributes
    ----------
    count : int, optional
        One for each processor by default.
    fresh : bool
        Whether stored jobs are run again.
    memory : int, bytes, optional
        Limit of every worker.
    dask : str, optional
        Address of a scheduler, or `local`; None for processes of our own.
    """

    count: int | None = None
    fresh: bool = False
    memory: int | None = None
    dask: str | None = None

    @staticmethod
    def of(count: int | None, fresh: bool, memory: int | None, dask: str | None) -> Workers:
        """Take the options of a command; memory in MB.

        Raises
        ------
        StudyError
            If there is to be no worker.
        """
        if count is not None and count < 1:
            raise StudyError(f"the number of jobs must be at least 1, got {count}")
        return Workers(count, fresh, None if memory is None else memory * 10**6, dask)

    @contextmanager
    def executor(self) -> Iterator[Executor | None]:
        """Connect to the workers; None where the runner starts its own."""
        if self.dask is None:
            yield None
            return
        with dask_executor(self.dask, self.count or default_jobs()) as executor:
            yield executor


@dataclass(frozen=True)
class Watch:
    """Receivers of a run's progress.

    Attributes
    ----------
    finished : callable (job, outcome)
        Told of every outcome once it is stored.
    progress : callable (job, progress), optional
        Told a few times a second where the running searches stand.
    """

    finished: Callable[[Any, Any], None] = lambda job, outcome: None
    progress: Callable[[Any, Progress], None] | None = None


def run_missing(
    jobs: Sequence[Job[Any]],
    store: Store,
    console: Console,
    workers: Workers,
    watch: Watch | None = None,
    word: str = "cell",
    of: str = "",
) -> None:
    """Run the jobs that are not stored yet, with a bar.

    Parameters
    ----------
    jobs : sequence of Job
    store : Store
    console : Console
    workers : Workers
    watch : Watch, optional
    word, of : str
        Name of a job for people, and what follows it.

    Raises
    ------
    Interrupted
        On Ctrl-C.
    """
    watch = watch or Watch()
    missing = list(jobs) if workers.fresh else store.missing(jobs)
    counted = f"{plural(len(jobs), word)}{of}"
    console.print(f"{counted}, {len(jobs) - len(missing)} stored already")
    done, waiting = 0, {id(job): job for job in missing}
    at_once = workers.count or default_jobs()
    with progress_bar(console) as progress:
        task = progress.add_task(running(waiting.values(), at_once), total=len(missing))

        def finished(job: Job[Any], outcome: Any) -> None:
            nonlocal done
            done += 1
            waiting.pop(id(job), None)
            progress.update(task, advance=1, description=running(waiting.values(), at_once))
            watch.finished(job, outcome)

        try:
            with workers.executor() as executor:
                options = RunOptions(workers.fresh, workers.memory, watch.progress)
                count = workers.count
                run_jobs(missing, store, executor=executor, workers=count, options=options, on_outcome=finished)
        except KeyboardInterrupt:  # it may come between storing and counting
            kept = done if workers.fresh else len(jobs) - len(store.missing(jobs))
            raise Interrupted(
                f"interrupted: {kept} of {counted} {'is' if len(jobs) == 1 else 'are'} stored in {store.path}; "
                "run the same command again to go on, or `study report` to see them"
            ) from None
        progress.update(task, description="finished")


@contextmanager
def watching(cases: Mapping[str, Case], live: bool, known: Sequence[Result] = ()) -> Iterator[Watch]:
    """Give who is to be told how the run goes: with `live` an open viewer, otherwise nobody.

    Parameters
    ----------
    cases : mapping of str to Case
    live : bool
    known : sequence of Result
        Stored already; the viewer shows them at once.

    Raises
    ------
    StudyError
        If the viewer or a display is missing.
    """
    if not live:
        yield Watch()
        return
    keep_to_oneself()
    from study import recording  # here: rerun is slow to import

    with recording.live_recording() as (viewer, _):
        for result in known:
            viewer.add(cases[result.cell.case], result)
        yield Watch(
            finished=lambda job, result: viewer.add(cases[job.subject], result),
            progress=lambda job, progress: viewer.show(cases[job.subject], job.cell, progress),
        )


def show(
    cases: Mapping[str, Case],
    results: Sequence[Result],
    out: Path,
    console: SafeConsole,
    with_report: bool = True,
    interactive: bool = False,
    details: bool = False,
) -> None:
    """Print the answer and a table of all cases, or of one case every method; with `details` every method of every case.

    Writes the report and the recordings too, if so wanted, `interactive` as pages too.
    """
    summaries, flagged = summarise(cases, results), audit_flags(out)
    files = {"results": out / STORE_NAME}
    if with_report:
        with console.status("writing the report and the recordings"):
            page, recordings = write(summaries, out, flagged, interactive)
        files |= {"report": page, "recordings": recordings}
    with console.paged():
        if len(summaries) > 1:
            console.print(*run_tables.answer_lines(summaries), sep="\n")
            console.print(run_tables.answer_table(console, summaries))
        if details or len(summaries) == 1:
            for summary in summaries:
                console.print(
                    run_tables.methods_table(console, summary, flagged), *run_tables.reasons(summary), sep="\n"
                )
        for name, path in files.items():
            console.print(f"{name}: {path}")
        if with_report:
            console.print("`study view CASE` opens a recording" + "; --details prints every method" * (not details))


def names_in(texts: Sequence[str] | None) -> list[str]:
    """Names of an option that may be given several times, each time with several names between commas."""
    return [name.strip() for text in texts or () for name in text.split(",") if name.strip()]
