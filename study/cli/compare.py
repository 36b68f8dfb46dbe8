"""Command `study compare`: planners on a problem of one's own, or the papers' searches with tests and an audit."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from study.api import COMPARED
from study.cases.library import Case, case_names, load_case, own_case
from study.cases.obstacles import may_be_driven, nearest
from study.cli.check import report_verdict, warn
from study.cli.folder import DEFAULT_OUT, STORE_NAME, audit_flags, write_pages
from study.cli.inputs import Cycle, Duration, Joints, LimitFiles, Points, Rate, Speed, Wishes, content_of, load_any
from study.cli.own import FORMS, Accept, Units, no_motion, save_motion, trajectory_file
from study.cli.screen import complain, make_console
from study.cli.shared import Dask, Fresh, Jobs, Memory, Out, Workers, names_in, run_missing, show
from study.errors import StudyError
from study.files import write_file
from study.io.filenames import file_stem
from study.registry import unavailable_planners
from study.runs.environment import environment
from study.runs.execute import cell_jobs, stored_results
from study.runs.job import Job
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.remembered import remember_lineup
from study.store.results import Result
from study.store.store import Store


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
        list[str] | None,
        typer.Option("--planners", "--planner", help=f"As in `study run`. [default: {', '.join(COMPARED)}]"),
    ] = None,
    seeds: Annotated[int | None, typer.Option(help="Runs of every search. [default: 3 with FILE]")] = None,
    evaluations: Annotated[int, typer.Option(help="Of every search, with FILE.")] = 2000,
    time_limit: Annotated[float, typer.Option(help="Seconds after which a planner is interrupted.")] = 20.0,
    jobs: Jobs = None,
    out: Out = DEFAULT_OUT,
    duration: Duration = None,
    speed: Speed = None,
    cycle: Cycle = None,
    points: Points = None,
    rate: Rate = None,
    report: Annotated[bool, typer.Option(help="Write the report and the recording.")] = True,
    limits: LimitFiles = None,
    units: Units = None,
    joints: Joints = None,
    cases: Annotated[
        list[str] | None,
        typer.Option(help="Without FILE: names of cases, separated by commas; the papers' five by default."),
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="Without FILE: the papers' own budgets and 30 repetitions of everything.")
    ] = False,
    accept: Accept = False,
    fresh: Fresh = False,
    memory: Memory = None,
    dask: Dask = None,
) -> None:
    """Put your own problem to several planners, or, without FILE, compare the papers' searches with tests and an audit.

    With FILE it leaves tables, report, recording and the best trajectory. Without, pages with targets, tests, the
    invariance audit, ablations and the papers' claims; what is stored is not run again.
    """
    workers = Workers.of(jobs, fresh, memory, dask)
    wishes = Wishes(duration, speed, cycle, rate, points)
    if file is None:
        if wishes != Wishes():
            raise StudyError("--duration, --speed, --cycle, --points and --rate go with FILE")
        _compare_papers(cases, out, full, seeds, workers)
        return
    if cases or full:
        raise StudyError("--cases and --full go with a comparison of the papers' searches, which takes no FILE")
    seeds = 3 if seeds is None else seeds
    console, content = make_console(), content_of(file, wishes, units, limits or [], joints)
    case = load_any(file) if content is None else own_case(content, file)
    warn(case, console)
    source = str(file.resolve()) if content is None else _kept_case(case, file, content, out)
    cells = make_cells([case], _compared(planners), Budget(seeds, evaluations, time_limit))
    with Store(out / STORE_NAME) as store:
        remember_lineup(store, cells, {case.name: source})
        run_missing(cell_jobs(cells, {case.name: case}), store, console, workers)
        results = stored_results(store, cells, {case.name: case})
    best = _best(case, results, console)
    if best is not None and best.motion is not None:
        files = [trajectory_file(out, case, form) for form in FORMS]
        said = save_motion(case, best.motion, files, wishes.sampling, accept)
        report_verdict(case, best.motion, console, {"planner": best.cell.label} | said)
    show({case.name: case}, results, out, console, report)
    if best is None:
        raise typer.Exit(no_motion(case))


def _compare_papers(cases: list[str] | None, out: Path, full: bool, seeds: int | None, workers: Workers) -> None:
    chosen = {case.name: case for case in map(load_case, names_in(cases) or case_names(default_only=True))}
    _build_pages(chosen, out / STORE_NAME, full, seeds, workers)
    write_pages(out, audit_flags(out))


def _build_pages(cases: Mapping[str, Case], path: Path, full: bool, seeds: int | None, workers: Workers) -> None:
    """Run what is missing and write the pages beside the store, in `report/comparison`."""
    from study.comparison.build import compare  # here: the comparison is slow to import
    from study.comparison.effort import FULL, QUICK
    from study.comparison.overview import summary

    console = make_console()
    effort = FULL if full else QUICK
    if seeds is not None and seeds < 2:
        raise StudyError(f"a comparison on paired seeds needs at least 2 seeds, got {seeds}")
    if seeds is not None:
        effort = replace(effort, seeds=seeds, trial_seeds=seeds, function_seeds=seeds)
    with Store(path) as store:

        def run(part: str, wanted: Sequence[Job[Any]]) -> None:
            run_missing(wanted, store, console, workers, word="job", of=f" of the {part}")

        findings = compare(cases, effort, store, run)
    with console.status("writing the pages"):
        from study.comparison.pages import write_pages as write_comparison  # here: matplotlib is slow to import

        page = write_comparison(findings, path.parent / "report" / "comparison", environment())
    for sentence in summary(findings):
        console.print(sentence)
    console.print(f"comparison: {page}")


def _compared(planners: Sequence[str] | None) -> tuple[Any, ...]:
    if planners:
        return parse_specs(",".join(planners))
    broken = unavailable_planners()
    for name in COMPARED:
        if name in broken:
            complain(f"left out: {broken[name]}")
    return parse_specs(",".join(name for name in COMPARED if name not in broken))


def _best(case: Case, results: Sequence[Result], console: Console) -> Result | None:
    """Fastest feasible result that hits no obstacle."""
    for result in sorted(results, key=lambda result: result.duration):
        if not result.feasible or result.verdict is None or result.motion is None:
            continue
        clearance = nearest(case, result.motion)
        if clearance is None or may_be_driven(result.verdict, clearance):
            return result
        console.print(f"{result.cell.label}: {clearance.sentence}")
    return None


def _kept_case(case: Case, file: Path, content: dict[str, Any], out: Path) -> str:
    """Write down what file and options came to, so that `study report` can load it again from anywhere."""

    def absolute(name: Any) -> Any:
        return str((file.parent / name).resolve()) if isinstance(name, str) and Path(name).suffix else name

    limits = dict(content["limits"])
    files = limits.get("from", [])
    limits |= {"from": [absolute(name) for name in ([files] if isinstance(files, str) else files)]}
    kept = content | {"name": case.name, "limits": limits}
    kept |= {key: absolute(content[key]) for key in ("waypoints", "robot") if key in content}
    path = out / "cases" / f"{file_stem(case.name)}.json"
    write_file(path, json.dumps(kept, indent=1) + "\n")
    return str(path.resolve())
