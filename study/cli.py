"""The command `study`."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from study import terminal
from study.errors import StudyError
from study.experiment.cases import Case, case_names, load_case
from study.experiment.environment import environment
from study.experiment.lineup import (
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
from study.experiment.registry import planner_named, planner_names, unavailable_planners
from study.experiment.results import Cell, Result
from study.experiment.runner import run_cells
from study.experiment.store import Store, remembered_lineup
from study.experiment.summary import summarise

DEFAULT_OUT = Path("study-output")
STORE_NAME = "results.sqlite"

app = typer.Typer(
    help="Compare metaheuristic time-optimal trajectory planners with deterministic ones on five papers' own problems.\n\n"
    "Start with `study run`; it leaves a report and recordings in ./study-output.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)
cases_app = typer.Typer(help="Look at the cases.", no_args_is_help=True)
app.add_typer(cases_app, name="cases")


class Interrupted(Exception):
    """Ctrl-C, with the sentence to say."""


Out = Annotated[Path, typer.Option("--out", help="Folder of the results, the report and the recordings.")]
CaseList = Annotated[
    list[str] | None,
    typer.Option("--cases", help="Names or YAML files, separated by commas; the papers' five cases by default."),
]


def _console() -> Console:
    console = Console()
    return console if console.is_terminal else Console(width=160)


@app.callback(invoke_without_command=True)
def top(show_version: Annotated[bool, typer.Option("--version", help="Print the version and end.")] = False) -> None:
    """Take the options that come before a command."""
    if show_version:
        print(version("time-optimal-study"))
        raise typer.Exit


@app.command("list")
def list_all() -> None:
    """List cases and planners; the default ones are what `study run` takes."""
    console = _console()
    console.print(terminal.cases_table(load_case(name) for name in case_names()))
    broken = unavailable_planners()
    entries = [(name, broken[name] if name in broken else planner_named(name)) for name in planner_names()]
    console.print(terminal.planners_table(entries, [spec.planner for spec in default_lineup()]))


@app.command()
def run(
    seeds: Annotated[int | None, typer.Option(help=f"Runs of every search. [default: {QUICK_SEEDS}]")] = None,
    cases: CaseList = None,
    planners: Annotated[
        list[str] | None,
        typer.Option(
            help="NAME[:OPTION,...] separated by commas, with options penalty or scaled, per-joint or shared; "
            "`all` takes every installed planner."
        ),
    ] = None,
    out: Out = DEFAULT_OUT,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; all processors by default.")] = None,
    evaluations: Annotated[
        int | None, typer.Option(help=f"Evaluations of every search. [default: {QUICK_EVALUATIONS}]")
    ] = None,
    full: Annotated[bool, typer.Option("--full", help=f"The papers' own budgets and {FULL_SEEDS} seeds.")] = False,
    time_limit: Annotated[float, typer.Option(help="Seconds after which a planner is interrupted.")] = TIME_LIMIT,
    report: Annotated[bool, typer.Option(help="Write the report and the recordings.")] = True,
) -> None:
    """Run every case with every planner, then write tables, report and recordings.

    What is stored is not run again: run the same command to go on after an interruption.
    """
    loaded = _cases(cases)
    budget = _budget(seeds, evaluations, full, time_limit)
    lineup = _lineup(planners)
    cells = make_cells([case for case, _ in loaded.values()], lineup, budget)
    chosen = {name: case for name, (case, _) in loaded.items()}
    console = _console()
    with Store(out / STORE_NAME, chosen) as store:
        store.remember_lineup(cells, {name: source for name, (_, source) in loaded.items()})
        _run(cells, chosen, store, jobs, console)
        results = store.results(cells)
    _show(chosen, results, out, console, report)


def _cases(texts: Sequence[str] | None) -> dict[str, tuple[Case, str]]:
    """Load cases; for each the name or absolute path that loads it again."""
    names = [name.strip() for text in texts for name in text.split(",")] if texts else case_names(default_only=True)
    found: dict[str, tuple[Case, str]] = {}
    for name in filter(None, names):
        case = load_case(name)
        found[case.name] = (case, name if name == case.name else str(Path(name).resolve()))
    if not found:
        raise StudyError("no cases to run; name some with --cases, see `study list`")
    return found


def _budget(seeds: int | None, evaluations: int | None, full: bool, time_limit: float) -> Budget:
    usual_seeds, usual_evaluations = (FULL_SEEDS, None) if full else (QUICK_SEEDS, QUICK_EVALUATIONS)
    return Budget(
        usual_seeds if seeds is None else seeds, usual_evaluations if evaluations is None else evaluations, time_limit
    )


def _lineup(texts: Sequence[str] | None) -> tuple[Spec, ...]:
    if texts and texts != ["all"]:
        return parse_specs(",".join(texts))
    for reason in unavailable_planners().values():
        print(f"study: left out: {reason}", file=sys.stderr)
    return full_lineup() if texts else default_lineup()


def _run(cells: Sequence[Cell], cases: Mapping[str, Case], store: Store, jobs: int | None, console: Console) -> None:
    missing = store.missing(cells)
    console.print(f"{len(cells)} cells, {len(cells) - len(missing)} of them stored already")
    done = 0
    with terminal.progress(console) as progress:
        task = progress.add_task("running", total=len(missing))

        def finished(result: Result) -> None:
            nonlocal done
            done += 1
            progress.update(task, advance=1, description=f"{result.cell.case}: {result.cell.label}")

        try:
            run_cells(missing, cases, store, jobs=jobs, on_result=finished)
        except KeyboardInterrupt:
            raise Interrupted(
                f"interrupted: {len(cells) - len(missing) + done} of {len(cells)} cells are stored in {store.path}; "
                "run the same command again to go on"
            ) from None
        progress.update(task, description="finished")


def _show(
    cases: Mapping[str, Case], results: Sequence[Result], out: Path, console: Console, with_report: bool = True
) -> None:
    rows = summarise(cases, results)
    for case in cases.values():
        console.print(terminal.rows_table(case, (row for row in rows if row.case == case.name)))
    if with_report:
        with console.status("writing the report and the recordings"):
            page, recordings = _write(cases, results, out)
        console.print(
            f"report: {page}", f"recordings: {recordings} (open one with `study view CASE`)", sep="\n", soft_wrap=True
        )
    console.print(f"results: {out / STORE_NAME}", soft_wrap=True)


def _write(cases: Mapping[str, Case], results: Sequence[Result], out: Path) -> tuple[Path, Path]:
    os.environ["RERUN_ANALYTICS_ENABLED"] = "false"  # nothing leaves the machine; read when rerun is imported
    from study.report.page import build_report  # here: matplotlib and rerun are slow to import
    from study.report.recording import record_case

    for case in cases.values():
        record_case(case, [r for r in results if r.cell.case == case.name], _recording(out, case.name))
    return build_report(cases, results, out / "report", environment()), out / "recordings"


def _recording(out: Path, name: str) -> Path:
    folder = out / "recordings"
    folder.mkdir(parents=True, exist_ok=True)
    return folder / f"{name}.rrd"


@app.command()
def report(out: Out = DEFAULT_OUT) -> None:
    """Write tables, report and recordings of the last run again, from the stored results."""
    cells, sources = remembered_lineup(out / STORE_NAME)
    cases = {name: load_case(source) for name, source in sources.items()}
    with Store(out / STORE_NAME, cases, write=False) as store:
        results = store.results(cells)
    if not results:
        raise StudyError(f"no stored result in {out / STORE_NAME} belongs to the last run; run `study run` first")
    _show(cases, results, out, _console())


@app.command()
def view(case: Annotated[str, typer.Argument(metavar="CASE")], out: Out = DEFAULT_OUT) -> None:
    """Open the recording of a case in the rerun viewer."""
    path = out / "recordings" / f"{case}.rrd"
    if not path.exists():
        load_case(case)
        raise StudyError(
            f"there is no recording at {path}; run `study run --cases {case}` first, or name its folder with --out"
        )
    from study.report.recording import view as open_viewer

    open_viewer(path)


@app.command()
def check(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="CSV: time, then positions of all joints; optionally velocities, then accelerations."
        ),
    ],
    case: Annotated[str, typer.Option("--case", help="Name or YAML file of the case.")],
    units: Annotated[str, typer.Option(help="Of angles: rad or deg.")] = "rad",
) -> None:
    """Judge a trajectory of your own against a case; ends with 0 if it is feasible, with 3 if it is not."""
    from study.experiment.sampled import read_motion
    from study.judge import judge

    known = load_case(case)
    motion = read_motion(file, known.problem, units, tuple(unit == "rad" for unit in known.units))
    verdict = judge(known.problem, motion.trajectory)
    console = _console()
    console.print(f"read as {motion.method}", soft_wrap=True)
    console.print(
        f"waypoints passed at {', '.join(f'{t:.4f}' for t in motion.trajectory.waypoint_times)} s", soft_wrap=True
    )
    console.print(terminal.verdict_table(known.problem, verdict))
    console.print(f"duration {verdict.duration:.6f} s, largest share of a limit {verdict.worst_ratio:.6f}")
    for reason in verdict.reasons:
        console.print(f"infeasible: {reason}", soft_wrap=True)
    if not verdict.feasible:
        raise typer.Exit(3)
    console.print("feasible")


@app.command()
def ledger(paper: Annotated[str | None, typer.Option(help="Key of one paper; all five by default.")] = None) -> None:
    """Print every misprint, contradiction and gap found in the papers, and the reading taken."""
    from study.experiment.ledger import ledger as entries

    console = _console()
    for table in terminal.ledger_tables(entries(paper)):
        console.print(table)


@app.command()
def digest(out: Out = DEFAULT_OUT) -> None:
    """Print one checksum of all stored results, wall times left out; equal studies print the same."""
    with Store(out / STORE_NAME, {}, write=False) as store:
        print(store.digest())


@app.command()
def reproduce(
    paper: Annotated[
        str | None, typer.Argument(metavar="PAPER", help="woodworking, aubo, smwoa, sparrow, puma or a paper's key.")
    ] = None,
    all_papers: Annotated[bool, typer.Option("--all", help="All five papers.")] = False,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer seeds, the stated readings only; labelled as quick.")] = False,
    out: Out = DEFAULT_OUT,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; all processors by default.")] = None,
    commit: Annotated[bool, typer.Option("--commit", help="With --all: write the verdicts into the data of a checkout.")] = False,
) -> None:
    """Put every printed number of a paper beside ours, with a verdict; what has been run is not run again."""
    from study.reproduction.command import reproduce_command

    reproduce_command(paper, all_papers, quick, out, jobs, commit, _console())


@cases_app.command("show")
def show_case(name: Annotated[str, typer.Argument(metavar="NAME", help="Name or YAML file.")]) -> None:
    """Print a case: waypoints, limits, sources and notes."""
    for table in terminal.case_tables(load_case(name)):
        _console().print(table)


def main() -> None:
    """Run the command; what a user can mend ends in one sentence and exit code 2."""
    try:
        app()
    except StudyError as error:
        print(f"study: {error}", file=sys.stderr)
        sys.exit(2)
    except Interrupted as interruption:
        print(f"study: {interruption}", file=sys.stderr)
        sys.exit(130)
