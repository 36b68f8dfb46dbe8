"""Commands that run the study and show its stored results: `study run`, `report`, `view` and `digest`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from study.cases.library import Case, case_names, load_case
from study.cases.suites import PAPERS
from study.cli.folder import DEFAULT_OUT, STORE_NAME, SUITE_NOTE, last_run, suite_noted
from study.cli.screen import complain, make_console
from study.cli.shared import Dask, Fresh, Jobs, Memory, Out, Workers, names_in, run_missing, show, watching
from study.errors import StudyError, plural
from study.io.filenames import file_stem
from study.registry import peer_names, unavailable_planners
from study.runs.execute import cell_jobs, stored_results
from study.runs.lineup import (
    FULL_SEEDS,
    QUICK_EVALUATIONS,
    QUICK_SEEDS,
    TIME_LIMIT,
    Budget,
    Spec,
    default_lineup,
    full_lineup,
    make_cells,
    parse_specs,
)
from study.runs.remembered import remember_lineup
from study.store.store import Store

Details = Annotated[bool, typer.Option("--details", help="Print every method of every case.")]
CaseList = Annotated[
    list[str] | None,
    typer.Option(
        "--cases", help="Names or YAML files, separated by commas, or `all`; the papers' five cases by default."
    ),
]


def run(
    seeds: Annotated[int | None, typer.Option(help=f"Runs of every search. [default: {QUICK_SEEDS}]")] = None,
    cases: CaseList = None,
    planners: Annotated[
        list[str] | None,
        typer.Option(
            "--planners",
            "--planner",
            help="NAME[:OPTION,...] separated by commas, with options penalty or scaled, per-joint or shared; "
            "`all` takes every installed planner.",
        ),
    ] = None,
    suite: Annotated[
        str | None,
        typer.Option(
            "--suite", metavar="SUITE", help="Problems of a suite and its line-up, see `study list --suites`."
        ),
    ] = None,
    lineup: Annotated[
        str | None, typer.Option(metavar="NAME", help="With --suite: deterministic or growth, in the place of its own.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="With --suite: the problems marked quick, small budgets and few seeds.")
    ] = False,
    out: Out = DEFAULT_OUT,
    jobs: Jobs = None,
    evaluations: Annotated[
        int | None, typer.Option(help=f"Evaluations of every search. [default: {QUICK_EVALUATIONS}]")
    ] = None,
    full: Annotated[bool, typer.Option("--full", help=f"The papers' own budgets and {FULL_SEEDS} seeds.")] = False,
    time_limit: Annotated[float, typer.Option(help="Seconds after which a planner is interrupted.")] = TIME_LIMIT,
    report: Annotated[bool, typer.Option(help="Write the report and the recordings.")] = True,
    live: Annotated[
        bool,
        typer.Option(
            "--live",
            help="Watch in the rerun viewer: the running searches several times a second, with their candidates and the "
            "best motion so far, and every cell as soon as it is finished, with how its search got there.",
        ),
    ] = False,
    details: Details = False,
    fresh: Fresh = False,
    memory: Memory = None,
    dask: Dask = None,
) -> None:
    """Run every case with every planner, then write tables, report and recordings.

    What is stored is not run again: run the same command to go on after an interruption.
    """
    if suite is not None and (suite, lineup) != (PAPERS, None):
        _suite_alone(cases, full, live)
        from study.cli.suite_run import Asked, run_suite  # here: its measures are slow to import

        asked = Asked(quick, names_in(planners), lineup, seeds, evaluations, time_limit)
        run_suite(suite, asked, out, Workers.of(jobs, fresh, memory, dask), make_console())
        return
    if quick or lineup:
        raise StudyError("--quick and --lineup go with --suite; without one `study run` is quick, and --full is not")
    loaded = _cases(cases)
    budget = _budget(seeds, evaluations, full, time_limit)
    chosen_planners = _lineup(planners)
    workers = Workers.of(jobs, fresh, memory, dask)
    cells = make_cells([case for case, _ in loaded.values()], chosen_planners, budget)
    chosen = {name: case for name, (case, _) in loaded.items()}
    console = make_console()
    with Store(out / STORE_NAME) as store:
        store.note(SUITE_NOTE, None)
        remember_lineup(store, cells, {name: source for name, (_, source) in loaded.items()})
        for name, reason in unavailable_planners().items():
            if (not planners or planners == ["all"]) and name not in peer_names():
                complain(f"left out: {reason}")
        with watching(chosen, live, stored_results(store, cells, chosen) if live else ()) as watch:
            run_missing(cell_jobs(cells, chosen), store, console, workers, watch)
        results = stored_results(store, cells, chosen)
    show(chosen, results, out, console, report, details=details)


def _suite_alone(cases: Sequence[str] | None, full: bool, live: bool) -> None:
    """Refuse options that say something else than a suite does."""
    given = {"--cases": cases, "--full": full, "--live": live}
    if clash := [name for name, value in given.items() if value]:
        raise StudyError(f"--suite says which problems are run and how, so {clash[0]} does not go with it")


def _cases(texts: Sequence[str] | None) -> dict[str, tuple[Case, str]]:
    """Load cases; for each the name or absolute path that loads it again."""
    names = names_in(texts) if texts else case_names(default_only=True)
    names = case_names() if names == ["all"] else names
    cases: dict[str, tuple[Case, str]] = {}
    for name in names:
        case = load_case(name)
        cases[case.name] = (case, name if name == case.name else str(Path(name).resolve()))
    if not cases:
        raise StudyError("no cases to run; name some with --cases, see `study list`")
    return cases


def _budget(seeds: int | None, evaluations: int | None, full: bool, time_limit: float) -> Budget:
    usual_seeds, usual_evaluations = (FULL_SEEDS, None) if full else (QUICK_SEEDS, QUICK_EVALUATIONS)
    return Budget(
        usual_seeds if seeds is None else seeds, usual_evaluations if evaluations is None else evaluations, time_limit
    )


def _lineup(texts: Sequence[str] | None) -> tuple[Spec, ...]:
    if texts and texts != ["all"]:
        return parse_specs(",".join(texts))
    return full_lineup() if texts else default_lineup()


def report(
    out: Out = DEFAULT_OUT,
    details: Details = False,
    interactive: Annotated[
        bool,
        typer.Option(
            "--interactive",
            help="Also pages with the recordings' own viewer inside, which work without a network: about 20 MB, "
            "and some more for every case.",
        ),
    ] = False,
) -> None:
    """Write tables, report and recordings again from the stored results, every case as it was run last.

    After a run that was killed they show the cells that were finished: each was stored the moment it ended, and
    recordings are made from the store, so none has to be mended.
    """
    if (out / STORE_NAME).is_file() and suite_noted(out):
        from study.cli.suite_run import show_last_suite  # here: its measures are slow to import

        show_last_suite(out, make_console())
        return
    cases, _, results = last_run(out)
    if not results:
        raise StudyError(f"no stored result in {out / STORE_NAME} belongs to the last run; run `study run` first")
    show(cases, results, out, make_console(), interactive=interactive, details=details)


def view(
    case: Annotated[str, typer.Argument(metavar="CASE", help="Its name, as `study list` prints it.")],
    out: Out = DEFAULT_OUT,
) -> None:
    """Open the recording of a case in the rerun viewer."""
    path = out / "recordings" / f"{file_stem(case)}.rrd"
    if not path.exists():
        load_case(case)
        raise StudyError(
            f"there is no recording at {path}; run `study run --cases {case}` first, or name its folder with --out"
        )
    from study.recording import view as open_viewer

    open_viewer(path)


def digest(out: Out = DEFAULT_OUT) -> None:
    """Print one checksum of all stored results, wall times left out; equal studies print the same."""
    with Store(out / STORE_NAME, write=False) as store:
        print(store.digest())
        if cut_short := store.cut_short():
            complain(f"{plural(cut_short, 'result')} decided by a time limit may differ elsewhere")
