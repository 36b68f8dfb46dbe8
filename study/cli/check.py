"""`study check`: is this case right, or does this trajectory solve it?"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from study.api import automatic
from study.cases.library import Case, load_case
from study.cases.obstacles import may_be_driven, nearest
from study.cautions import cautions, ends_said
from study.cli import terminal
from study.cli.inputs import FORMS, LimitFiles, is_bare, load_any
from study.cli.shared import INFEASIBLE, make_console
from study.errors import StudyError, plural
from study.io.sampled import passages, read_motion
from study.judge import judge
from study.registry import planner_about
from study.trajectory import Motion, Trajectory


def check(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="A case of your own (YAML or JSON); or, with --limits, waypoints alone; or, with --case, a trajectory: CSV "
            "with time, then positions of all joints, optionally velocities, then accelerations; or an .exact.json file.",
        ),
    ],
    case: Annotated[
        str | None, typer.Option("--case", help="Name or file of the case that a trajectory solves.")
    ] = None,
    units: Annotated[
        str | None, typer.Option(help="Of angles in a trajectory's CSV: rad or deg; of waypoints alone: also m or mm.")
    ] = None,
    limits: LimitFiles = None,
) -> None:
    """Check a case and say what was understood; or judge a trajectory: 0 if it is feasible, 3 if it is not."""
    console = make_console()
    if case is None:
        _explain(_case(file, units, limits or []), console)
        return
    if limits:
        raise StudyError("--limits goes with a file of waypoints alone; the case that --case names has its own limits")
    known = load_case(case)
    motion, method = _motion(file, known, units or "rad")
    if not report_verdict(known, motion, method, console):
        raise typer.Exit(INFEASIBLE)
    console.print("feasible")


def _case(file: Path, units: str | None, limits: Sequence[Path]) -> Case:
    if not limits and (file.suffix.lower() not in FORMS or is_bare(file)):
        raise StudyError(
            f"file {str(file)!r} is no case (YAML or JSON); if it holds waypoints alone, add --limits, and if it holds a "
            "trajectory, name the case that it solves with --case"
        )
    return load_any(file, units, limits)


def _motion(file: Path, case: Case, units: str) -> tuple[Motion, str]:
    """The motion in a file and how it was understood."""
    if file.suffix.lower() == ".json":
        from study.io.exact import read_exact

        motion = read_exact(file)
        if isinstance(motion, Trajectory) and motion.n_joints == case.problem.n_joints:
            times = passages(motion.knots, motion.coefficients, case.problem.waypoints)
            motion = Trajectory(motion.knots, motion.coefficients, times)
        return motion, "exact polynomials"
    sampled = read_motion(file, case.problem, units, tuple(unit == "rad" for unit in case.units))
    return sampled.trajectory, sampled.method


def report_verdict(case: Case, motion: Motion, method: str, console: Console) -> bool:
    """Print what the judge finds of a motion; whether it is feasible and hits no obstacle."""
    verdict = judge(case.problem, motion)
    if method:
        console.print(f"read as {method}", soft_wrap=True)
    console.print(
        f"waypoints passed at {terminal.times_text(motion.waypoint_times, motion.duration)} s", soft_wrap=True
    )
    console.print(terminal.verdict_table(case.problem, verdict))
    console.print(f"duration {verdict.duration:.9g} s, largest share of a limit {verdict.worst_ratio:.6f}")
    for reason in verdict.reasons:
        console.print(f"infeasible: {reason}", soft_wrap=True)
    found = nearest(case, motion)
    if found is not None:
        console.print(f"{'' if found.clear else 'infeasible: '}{found.sentence}", soft_wrap=True)
    return may_be_driven(verdict, found)


def _explain(case: Case, console: Console) -> None:
    """Say what was read and what will be done with it."""
    for caution in cautions(case.problem):
        console.print(f"warning: {caution}", style="bold red", soft_wrap=True)
    for table in terminal.case_tables(case):
        console.print(table)
    problem = case.problem
    console.print(
        f"{plural(problem.n_joints, 'joint')}, {problem.n_waypoints} waypoints; the motion {ends_said(problem)}",
        soft_wrap=True,
    )
    for name in automatic(problem):
        console.print(f"planner auto tries {name}: {planner_about(name)}", soft_wrap=True)
    console.print(f"planners that choose segment durations use the curve {case.curve}")
    console.print("the case is complete")
