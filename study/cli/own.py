"""Commands for one's own robot: `study init`, `study plan`, `study compare`, `study schema` and `study torture`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from study.analysis.case_summary import summarise
from study.api import COMPARED, Planned
from study.api import plan as plan_motion
from study.cases.library import Case, case_names, load_case
from study.cases.obstacles import nearest
from study.cases.own_case import bare_content
from study.cli.check import report_verdict
from study.cli.example import EXAMPLE
from study.cli.inputs import LimitFiles, is_bare, load_any
from study.cli.run import (
    DEFAULT_OUT,
    INFEASIBLE,
    STORE_NAME,
    Interrupted,
    Out,
    audit_flags,
    make_console,
    run_missing,
    show,
)
from study.datafiles import make_file
from study.io.export import form_of, write_motion
from study.io.filenames import file_stem
from study.planning import Formulation, Synchronisation
from study.registry import unavailable_planners
from study.runs.environment import environment
from study.runs.lineup import Budget, make_cells, parse_specs
from study.store.results import Result
from study.store.store import Store, remembered_lineup

FORMS = (".yaml", ".csv", ".npz", ".exact.json")

File = Annotated[
    Path, typer.Argument(metavar="FILE", help="A case (YAML or JSON), or waypoints alone: CSV or a JointTrajectory.")
]
Units = Annotated[str | None, typer.Option(help="For waypoints alone: rad, deg, m or mm.")]
Rate = Annotated[
    float | None,
    typer.Option(
        help="Samples per second in the files written; the end point is always there. [default: 100, or what gives 10 to "
        "100,000 samples]"
    ),
]


def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The file to write.")] = Path("my_case.yaml"),
) -> None:
    """Write a commented example of a case to start from."""
    make_file(file, EXAMPLE.replace("NAME", json.dumps(file.stem)), overwrite=False)
    print(f"wrote {file}; edit it, then: study check {file}, study compare {file}")


def plan(
    file: File,
    planner: Annotated[str, typer.Option(help="A name from `study list`, or auto: by what limits exist.")] = "auto",
    save: Annotated[
        list[Path] | None,
        typer.Option(help="Files to write, .csv, .yaml, .json, .npz or .exact.json; all kinds below --out by default."),
    ] = None,
    out: Out = DEFAULT_OUT,
    rate: Rate = None,
    seed: Annotated[int, typer.Option(help="For searches.")] = 0,
    evaluations: Annotated[int, typer.Option(help="For searches.")] = 2000,
    time_limit: Annotated[float, typer.Option(help="Seconds for each planner.")] = 60.0,
    limits: LimitFiles = None,
    units: Units = None,
) -> None:
    """Plan one motion, have it judged and write it; ends with 3 where no feasible motion was found."""
    case, console = load_any(file, units, limits or []), make_console()
    for path in save or []:
        form_of(path)  # a wrong name is told before the work, not after it
    [spec] = parse_specs(planner) if planner != "auto" else [None]
    settings = replace(case.settings, seed=seed, evaluations=evaluations, time_limit=time_limit)
    if spec is not None:
        settings = replace(
            settings,
            formulation=Formulation(spec.formulation or settings.formulation),
            synchronisation=Synchronisation(spec.synchronisation or settings.synchronisation),
        )
    planned = plan_motion(case.problem, spec.planner if spec else "auto", settings)
    for name, why, result in planned.tried:
        console.print(f"planner {name}: {why}", soft_wrap=True)
        if result is not planned.result or not planned.feasible:
            console.print(f"  no feasible motion: {_why_not(result)}", soft_wrap=True)
    if planned.result.motion is None or not report_verdict(case, planned.motion, "", console):
        raise typer.Exit(_no_motion(case))
    _save(case, planned, save, out, rate, console)


def _why_not(result: Result) -> str:
    return "; ".join(result.verdict.reasons) if result.verdict else result.message or result.status.value


def _no_motion(case: Case) -> int:
    typer.echo(f"study: case {case.name!r}: no feasible motion was found; the reasons are above", err=True)
    return INFEASIBLE


def _save(
    case: Case, planned: Planned, save: Sequence[Path] | None, out: Path, rate: float | None, console: Console
) -> None:
    for path in save or [trajectory_file(out, case, form) for form in FORMS]:
        console.print(
            f"trajectory: {write_motion(planned.motion, case.problem, path, rate)}", soft_wrap=True, markup=False
        )


def trajectory_file(out: Path, case: Case, form: str) -> Path:
    """Where the trajectory of a case stands; what cannot be in a file's name is left out of it."""
    return out / "trajectories" / f"{file_stem(case.name)}{form}"


def compare(
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE",
            help="A case (YAML or JSON), or waypoints alone: CSV or a JointTrajectory. Without it the papers' searches "
            "are compared on the papers' cases.",
        ),
    ] = None,
    planners: Annotated[
        list[str] | None, typer.Option(help=f"As in `study run`. [default: {', '.join(COMPARED)}]")
    ] = None,
    seeds: Annotated[int | None, typer.Option(help="Runs of every search. [default: 3 with FILE]")] = None,
    evaluations: Annotated[int, typer.Option(help="Of every search, with FILE.")] = 2000,
    time_limit: Annotated[float, typer.Option(help="Seconds after which a planner is interrupted.")] = 20.0,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; all processors by default.")] = None,
    out: Out = DEFAULT_OUT,
    rate: Rate = None,
    report: Annotated[bool, typer.Option(help="Write the report and the recording.")] = True,
    limits: LimitFiles = None,
    units: Units = None,
    cases: Annotated[
        list[str] | None,
        typer.Option(help="Without FILE: names of cases, separated by commas; the papers' five by default."),
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="Without FILE: the papers' own budgets and 30 repetitions of everything.")
    ] = False,
) -> None:
    """Put your own problem to several planners, or, without FILE, compare the papers' searches with tests and an audit.

    With FILE it leaves tables, report, recording and the best trajectory. Without, pages with targets, tests, the
    invariance audit, ablations and the papers' claims; what is stored is not run again.
    """
    if file is None:
        _compare_papers(cases, out, full, seeds, jobs)
        return
    seeds = 3 if seeds is None else seeds
    case, console = load_any(file, units, limits or []), make_console()
    source = str(file.resolve()) if not is_bare(file) else _kept_case(case, file, units, limits or [], out)
    cells = make_cells([case], _compared(planners), Budget(seeds, evaluations, time_limit))
    with Store(out / STORE_NAME, {case.name: case}) as store:
        store.remember_lineup(cells, {case.name: source})
        run_missing(cells, {case.name: case}, store, jobs, console)
        results = store.results(cells)
    show({case.name: case}, results, out, console, report)
    best = _best(case, results, console)
    if best is None or best.motion is None:
        raise typer.Exit(_no_motion(case))
    console.print(f"fastest feasible: {best.cell.label}", soft_wrap=True)
    for form in FORMS:
        path = write_motion(best.motion, case.problem, trajectory_file(out, case, form), rate)
        console.print(f"trajectory: {path}", soft_wrap=True)


def _compare_papers(cases: list[str] | None, out: Path, full: bool, seeds: int | None, jobs: int | None) -> None:
    from study.cli.compare import compare_command

    names = [name.strip() for text in cases or () for name in text.split(",") if name.strip()]
    chosen = {case.name: case for case in map(load_case, names or case_names(default_only=True))}
    try:
        compare_command(chosen, out / STORE_NAME, full, seeds, jobs, make_console())
    except KeyboardInterrupt:
        raise Interrupted(
            f"interrupted; what was run is stored in {out / STORE_NAME}: run the same command again to go on"
        ) from None
    _link_comparison(out)


def _link_comparison(out: Path) -> None:
    """Write the report again where there is one, so that its index leads to the comparison."""
    index = out / "report" / "index.html"
    if not index.is_file() or "comparison/index.html" in index.read_text(encoding="utf-8"):
        return
    from study.report.page import build_report  # here: matplotlib is slow to import

    cells, sources = remembered_lineup(out / STORE_NAME)
    cases = {name: load_case(source) for name, source in sources.items()}
    with Store(out / STORE_NAME, cases, write=False) as store:
        results = store.results(cells)
    if results:
        build_report(summarise(cases, results), out / "report", environment(), audit_flags(out), sources)


def _compared(planners: Sequence[str] | None) -> tuple[Any, ...]:
    if planners:
        return parse_specs(",".join(planners))
    broken = unavailable_planners()
    for name in COMPARED:
        if name in broken:
            typer.echo(f"study: left out: {broken[name]}", err=True)
    return parse_specs(",".join(name for name in COMPARED if name not in broken))


def _best(case: Case, results: Sequence[Result], console: Console) -> Result | None:
    """Fastest feasible result that hits no obstacle."""
    for result in sorted(results, key=lambda one: one.verdict.duration if one.verdict else float("inf")):
        if result.verdict is None or not result.verdict.feasible or result.motion is None:
            continue
        found = nearest(case, result.motion)
        if found is None or found.distance >= 0:
            return result
        console.print(f"{result.cell.label}: {found.sentence}", soft_wrap=True)
    return None


def _kept_case(case: Case, file: Path, units: str | None, limits: Sequence[Path], out: Path) -> str:
    """Write down what a bare file came to, so that `study report` can load it again."""
    content = bare_content(file, units, limits) | {"name": case.name, "waypoints": str(file.resolve())}
    path = out / "cases" / f"{file_stem(case.name)}.json"
    make_file(path, json.dumps(content, indent=1) + "\n")
    return str(path.resolve())


def schema() -> None:
    """Print the JSON Schema of a case file, for editors."""
    from study.cases.own_file import schema as case_schema

    print(json.dumps(case_schema(), indent=2))


def register(app: typer.Typer) -> None:
    """Add the commands."""
    for command in (init, plan, compare, schema):
        app.command()(command)
