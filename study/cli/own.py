"""Commands for a robot of one's own: `study init`, `study plan` and `study schema`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from study.api import TIERS, Planned
from study.api import plan as plan_motion
from study.cases.library import Case
from study.cases.obstacles import may_be_driven, nearest
from study.cli.check import SAMPLED, report_verdict, warn
from study.cli.example import EXAMPLE
from study.cli.folder import DEFAULT_OUT
from study.cli.inputs import Cycle, Duration, Joints, LimitFiles, Points, Rate, Speed, Wishes, load_any
from study.cli.screen import complain, make_console
from study.cli.shared import INFEASIBLE, Out
from study.errors import StudyError, listed
from study.files import write_file
from study.io.export import MESSAGES, form_of, points_of, write_motion
from study.io.filenames import file_stem
from study.io.sampled import joined
from study.io.sampling import Sampling
from study.judge import judge
from study.planning import Formulation, RunSettings, Status, Synchronisation
from study.runs.lineup import parse_specs
from study.slowing import SLOWED, slowed_said
from study.store.results import Result
from study.trajectory import Motion

FORMS = (".yaml", ".csv", ".npz", ".exact.json")

Files = Annotated[
    list[Path],
    typer.Argument(metavar="FILE...", help="Cases (YAML or JSON), or waypoints alone: CSV or a JointTrajectory."),
]
Units = Annotated[str | None, typer.Option(help="For waypoints alone: rad, deg, m or mm.")]

Accept = Annotated[
    bool,
    typer.Option(
        "--accept-unbounded-acceleration",
        help="Write trajectory files although a joint has no acceleration limit, so that no arm can follow the motion.",
    ),
]


def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The file to write.")] = Path("my_case.yaml"),
) -> None:
    """Write a commented example of a case to start from."""
    write_file(file, EXAMPLE.replace("NAME", json.dumps(file.stem)), overwrite=False)
    make_console().print(f"wrote {file}; edit it, then: study check {file}, study compare {file}")


def plan(
    files: Files,
    planner: Annotated[
        str, typer.Option("--planner", "--planners", help="best, fast, or a name from `study list`; auto is best.")
    ] = "auto",
    save: Annotated[
        list[Path] | None,
        typer.Option(help="Files to write, .csv, .yaml, .json, .npz or .exact.json; all kinds below --out by default."),
    ] = None,
    out: Out = DEFAULT_OUT,
    duration: Duration = None,
    speed: Speed = None,
    cycle: Cycle = None,
    points: Points = None,
    rate: Rate = None,
    seed: Annotated[int, typer.Option(help="For searches.")] = 0,
    evaluations: Annotated[int, typer.Option(help="For searches.")] = 2000,
    time_limit: Annotated[float, typer.Option(help="Seconds for each planner.")] = 60.0,
    limits: LimitFiles = None,
    units: Units = None,
    joints: Joints = None,
    accept: Accept = False,
) -> None:
    """Plan one motion, have it judged and write it; ends with 3 where no feasible motion was found."""
    wishes, ended = Wishes(duration, speed, cycle, rate, points), 0
    if save and len(files) > 1:
        raise StudyError("--save takes one FILE; the motions of several go below --out, named after their cases")
    for path in save or []:
        form_of(path)  # a wrong name is told before the work, not after it
    [spec] = parse_specs(planner) if planner not in TIERS else [None]
    for file in files:
        try:
            case = wishes.on(load_any(file, units, limits or [], joints))
            settings = replace(case.settings, seed=seed, evaluations=evaluations, time_limit=time_limit)
            if spec is not None:
                settings = replace(
                    settings,
                    formulation=Formulation(spec.formulation or settings.formulation),
                    synchronisation=Synchronisation(spec.synchronisation or settings.synchronisation),
                )
            name = spec.planner if spec else planner
            _plan_case(
                case, name, settings, save or [trajectory_file(out, case, form) for form in FORMS], wishes, accept
            )
        except StudyError as error:
            if len(files) == 1:
                raise
            complain(error)  # and the other files are planned all the same
            ended = 2
        except typer.Exit as status:
            ended = max(ended, status.exit_code) if ended != 2 else 2
    if ended:
        raise typer.Exit(ended)


def _plan_case(
    case: Case, planner: str, settings: RunSettings, files: Sequence[Path], wishes: Wishes, accept: bool
) -> None:
    """Plan one case, say how it went and write its files; ends where no feasible motion was found."""
    console = make_console()
    warn(case, console)
    with console.status(f"planning {case.name}"):
        planned = plan_motion(case.problem, planner, settings)
    facts = {"planner": f"{planned.planner}, {planned.why}"}
    if planned.result.motion is None:
        console.print(*_tried(planned), sep="\n")
        raise typer.Exit(no_motion(case))
    motion, known = planned.motion, (planned.verdict, nearest(case, planned.motion))
    if may_be_driven(*known):
        try:
            facts |= save_motion(case, motion, files, wishes.sampling, accept)
        except StudyError:
            report_verdict(case, motion, console, facts | {"files": "none written"}, known=known)
            raise
    good = report_verdict(case, motion, console, facts, known=known)
    console.print(*_tried(planned), sep="\n")
    if not good:
        raise typer.Exit(no_motion(case))


def _tried(planned: Planned) -> Iterator[str]:
    for name, about, result in planned.tried:
        slowed = slowed_said(planned.problem, result.details.get(SLOWED))
        yield f"tried {name} ({about}): {_outcome(result)}{slowed and '; '}{slowed}"


def _outcome(result: Result) -> str:
    late = "; a time limit was reached, so it may not be the best" if result.status is Status.TIMED_OUT else ""
    return f"{result.duration:.6g} s, feasible{late}" if result.feasible else f"no feasible motion: {result.reason}"


def no_motion(case: Case) -> int:
    """Say that no motion was found; the exit status."""
    complain(f"case {case.name!r}: no feasible motion was found; the reasons are above")
    return INFEASIBLE


def save_motion(case: Case, motion: Motion, files: Sequence[Path], sampling: Sampling, accept: bool) -> dict[str, str]:
    """Write a motion; the files, and what a controller that joins the samples makes of it, as lines for people."""
    for path in files:
        write_motion(motion, case.problem, path, sampling, accept_unbounded_acceleration=accept)
    times = sampling.times(motion, case.problem)
    through = joined(points_of(motion, case.problem, times), case.problem, "the samples", passing=motion.waypoint_times)
    share = judge(case.problem, through.trajectory).worst_ratio
    said = {"files": "\n".join(map(str, files)), "samples": f"{len(times)} samples; {through.method}"}
    unnamed = [name for j, name in enumerate(case.problem.joint_names) if name == f"joint {j + 1}"]
    if unnamed and any(form_of(path) in MESSAGES for path in files):
        said["names"] = f"{listed(unnamed)} in the files; a controller knows joints by its own names: give `joints`"
    if share > 1 + SAMPLED:
        said["caution"] = (
            f"joined by a controller they reach {share:.3g} of a limit; without --rate, --points or --cycle samples "
            "stand where the motion needs them, and --speed leaves room"
        )
    return said


def trajectory_file(out: Path, case: Case, form: str) -> Path:
    """Path of the trajectory of a case; characters that a file name cannot have are left out."""
    return out / "trajectories" / f"{file_stem(case.name)}{form}"


def schema() -> None:
    """Print the JSON Schema of a case file, for editors."""
    from study.cases.own_file import schema as case_schema

    print(json.dumps(case_schema(), indent=2))
