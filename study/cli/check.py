"""The command `study check`: a case explained, or anyone's trajectory judged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from study.api import automatic
from study.cases.library import Case, load_case
from study.cases.magnitudes import odd_magnitudes
from study.cases.obstacles import Nearest, may_be_driven, nearest
from study.cases.recorded import is_exact, limits_alone, motion_of, passing, with_room
from study.cautions import cautions, ends_said
from study.cli import terminal
from study.cli.inputs import Joints, LimitFiles, load_any
from study.cli.screen import make_console
from study.cli.shared import INFEASIBLE
from study.errors import StudyError, plural
from study.io.exact import read_exact
from study.io.recordings import holds_samples, read_samples
from study.io.sampled import Interpolation, breaches, joined
from study.io.samples import Samples
from study.judge import Verdict, judge
from study.path_findings import largest_deviation
from study.registry import planner_about
from study.trajectory import Motion

SAMPLED = 1e-3
"""Share by which limits may be exceeded between samples unless said otherwise: what their rounding may cost."""


def check(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="A case of your own (YAML or JSON); or, with --limits, waypoints alone; or, with --case or with --limits, a "
            "trajectory in any format that is read or written here.",
        ),
    ],
    case: Annotated[
        str | None, typer.Option("--case", help="Name or file of the case that a trajectory solves.")
    ] = None,
    units: Annotated[
        str | None,
        typer.Option(help="Of positions in a file that does not say them: rad, deg, m or mm, or one for each joint."),
    ] = None,
    limits: LimitFiles = None,
    joints: Joints = None,
    interpolation: Annotated[
        Interpolation | None,
        typer.Option(help="How a controller joins the samples of a trajectory; by default as ros2_controllers does."),
    ] = None,
    tolerance: Annotated[
        float, typer.Option(help="Share by which a sampled trajectory may exceed limits and miss waypoints.", min=0.0)
    ] = SAMPLED,
) -> None:
    """Check a case and say what was understood; or judge a trajectory: 0 if it is feasible, 3 if it is not."""
    console = make_console()
    samples = None if is_exact(file) or not (case or holds_samples(file)) else read_samples(file)
    if case is None and not is_exact(file) and (samples is None or not _timed(samples, interpolation)):
        _explain(_case(file, units, limits or [], joints), console)
        return
    if case is not None and limits:
        raise StudyError("give --case or --limits, not both: a case has its own limits")
    where = f"file {file.name!r}"
    if samples is None:
        motion, known = read_exact(file), _known(case, where)
        warn(known, console)
        feasible = report_verdict(known, passing(motion, known), console, {"read as": "exact polynomials"})
    else:
        if case is None and limits:
            known, samples = limits_alone(samples, limits, units, where)
        else:
            known = _known(case, where, " or its limits with --limits")
            samples = motion_of(samples, known, units, where)
        warn(known, console)
        feasible = _judge_samples(samples, known, where, interpolation, tolerance, console)
    if not feasible:
        raise typer.Exit(INFEASIBLE)
    console.print("feasible")


def _timed(samples: Samples, interpolation: Interpolation | None) -> bool:
    """Whether samples are a trajectory and no waypoints: rates are given, or an interpolation is asked for."""
    return samples.times is not None and (samples.velocities is not None or interpolation is not None)


def _known(case: str | None, where: str, other: str = "") -> Case:
    if case is None:
        raise StudyError(f"{where} holds a trajectory: name the case that it solves with --case{other}")
    return load_case(case)


def _judge_samples(
    samples: Samples,
    case: Case,
    where: str,
    interpolation: Interpolation | None,
    tolerance: float,
    console: Console,
) -> bool:
    """Say apart what holds at the samples and what a controller makes of them in between."""
    for note in samples.notes:
        console.print(f"note: {note}")
    at_samples = breaches(samples, case.problem, tolerance, where)
    for sentence in at_samples:
        console.print(f"infeasible at the samples: {sentence}")
    if not at_samples:
        console.print("at the samples every limit is kept")
    through = joined(samples, case.problem, where, interpolation)
    console.print(f"between the samples, joined as a controller may, a limit may be exceeded by {100 * tolerance:g} %:")
    return report_verdict(case, through.trajectory, console, {"read as": through.method}, tolerance) and not at_samples


def _case(file: Path, units: str | None, limits: Sequence[Path], joints: str | None) -> Case:
    if not limits and (holds_samples(file) or file.suffix.lower() not in (".yaml", ".yml", ".json")):
        raise StudyError(
            f"file {str(file)!r} is no case (YAML or JSON); if it holds waypoints alone, add --limits, and if it holds a "
            "trajectory, name the case that it solves with --case"
        )
    return load_any(file, units, limits, joints)


def warn(case: Case, console: Console) -> None:
    """Print what must be known before a motion of the case is driven, what of the files was not used, and what looks odd."""
    for caution in cautions(case.problem):
        console.print(f"warning: {caution}", style="bold red")
    for sentence in (*case.warnings, *odd_magnitudes(case)):
        console.print(f"note: {sentence}")


def report_verdict(
    case: Case,
    motion: Motion,
    console: Console,
    facts: Mapping[str, str] | None = None,
    room: float = 0.0,
    known: tuple[Verdict, Nearest | None] | None = None,
) -> bool:
    """Print whether a motion may be driven, what binds, and what the judge finds joint by joint.

    Parameters
    ----------
    case : Case
    motion : Motion
    console : Console
    facts : mapping of str to str, optional
        More lines of the card at the head.
    room : float
        Share by which limits may be exceeded.
    known : tuple of Verdict and Nearest, optional
        Verdict on the motion and its clearance, where they are known already.

    Returns
    -------
    bool
        Whether the motion is feasible and clear.
    """
    verdict, clearance = known or (judge(case.problem, motion), nearest(case, motion))
    allowed = judge(with_room(case.problem, room), motion) if room else verdict
    good = may_be_driven(allowed, clearance)
    units = " or ".join(dict.fromkeys(case.units))
    away = largest_deviation(case.problem, motion)
    off = f"at most {away:.4g} {units} from the straight lines between waypoints, in any joint"
    console.print(terminal.card(case, verdict, good, clearance, {"path": off, **(facts or {})}))
    for reason in () if allowed.feasible else verdict.reasons:
        console.print(f"infeasible: {reason}", style="red")
    if clearance is not None and not clearance.clear:
        console.print(f"infeasible: {clearance.sentence}", style="red")
    console.print(terminal.verdict_table(console, case.problem, verdict))
    console.print(f"waypoints passed at {terminal.times_text(motion.waypoint_times, motion.duration)} s")
    return good


def _explain(case: Case, console: Console) -> None:
    """Say what was read and what will be done with it."""
    warn(case, console)
    problem = case.problem
    console.print(
        f"{case.name}: {plural(problem.n_joints, 'joint')}, {problem.n_waypoints} waypoints; the motion {ends_said(problem)}; "
        "the case is complete"
    )
    console.print(*terminal.case_tables(console, case))
    for name in automatic(problem):
        console.print(f"planner auto tries {name}: {planner_about(name)}")
