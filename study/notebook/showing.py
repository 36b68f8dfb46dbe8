"""The recording of a plan, in place in a notebook or in a window."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from study.analysis.case_summary import summarise_case
from study.cases.library import Case
from study.errors import StudyError
from study.files import named
from study.io.filenames import file_stem
from study.planning import usual_settings
from study.problem import Problem
from study.recording import record_case, show_in_notebook, view
from study.robots import robot_named
from study.store.results import Result


def shown(problem: Problem, results: Iterable[Result], file: str | Path | None, robot: str | Path | None) -> Path:
    """Record the motions and show them; where that cannot be done here, say why in one sentence.

    Parameters
    ----------
    problem : Problem
    results : iterable of Result
        Of this problem; of several of one planner the last counts.
    file, robot : str or Path, optional
        As for `study.api.Planned.show`.

    Returns
    -------
    Path
        The recording.

    Raises
    ------
    StudyError
        If it cannot be written, or the arm has other joints than the problem.
    """
    path = named(f"{file_stem(problem.name)}.rrd" if file is None else file)
    once = {result.cell.label: result for result in results}
    record_case(summarise_case(_case(problem, robot), once.values()), path)
    try:
        (show_in_notebook if in_notebook() else view)(path)
    except StudyError as error:
        print(error)
    return path


def in_notebook() -> bool:
    """Whether a notebook's kernel runs this."""
    module = sys.modules.get("IPython")
    shell = module.get_ipython() if module is not None else None
    return getattr(shell, "kernel", None) is not None


def _case(problem: Problem, robot: str | Path | None) -> Case:
    settings, arm = usual_settings(problem), None
    if robot is not None:
        arm = str(named(robot).resolve()) if Path(robot).suffix else str(robot)
        joints = robot_named(arm, tuple(problem.joint_names)).n_joints
        if joints != problem.n_joints:
            raise StudyError(f"robot {str(robot)!r} has {joints} moving joints, the problem has {problem.n_joints}")
    return Case(
        name=problem.name,
        title="a problem from Python",
        paper="own",
        problem=problem,
        curve=settings.curve,
        settings=settings,
        planner="",
        robot=arm,
        units=("rad",) * problem.n_joints,
        published=(),
        notes=(),
    )
