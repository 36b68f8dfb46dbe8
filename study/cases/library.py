"""The papers' cases: what stands in `data/cases`, checked at the door."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from study.arm import ArmLimits
from study.cases.case import Case, Published
from study.cases.own_case import own_case
from study.cases.paper_file import SI, CaseFile, Limits, Printed, Rates, Unit, in_si, varied
from study.cases.suite_file import suite_case
from study.curves import curve_named
from study.datafiles import checked, data_folder, read_yaml
from study.errors import StudyError, unknown
from study.files import named
from study.io.documents import parsed
from study.planning import Formulation, RunSettings, Synchronisation
from study.problem import EndCondition, Floats, JointLimits, Problem, frozen_array
from study.robots.masses import heavy_arm, without_friction

__all__ = ["Case", "Published", "case_names", "load_case", "own_case"]

PAPERS_OWN = {"paper", "planner", "settings", "published"}
"""Fields that only a case of a paper has."""


def case_names(default_only: bool = False) -> list[str]:
    """Name the cases that the data holds, or only those that `study run` takes without being asked.

    Raises
    ------
    StudyError
        If a file of the data is broken.
    """
    return [name for name, case in _library().items() if case.default or not default_only]


def load_case(name_or_path: str | Path) -> Case:
    """Load a case by name, or from a file of one's own.

    Parameters
    ----------
    name_or_path : str or Path
        A name that `case_names` gives, `SUITE:NAME` for a problem of a suite, or the path of a YAML or JSON file: one as in `data/cases`, or the shorter form
        for one's own robot, `study.cases.own_file.OwnCase`.

    Raises
    ------
    StudyError
        If there is no such case or file, or a field of the file is missing, unknown or impossible.
    """
    path = named(name_or_path)
    if path.suffix.lower() in (".yaml", ".yml", ".json") or len(path.parts) > 1:
        content = parsed(path)
        if not isinstance(content, dict):
            came = "nothing" if content is None else "a list" if isinstance(content, list) else repr(content)[:60]
            raise StudyError(
                f"file {str(path)!r} must hold named fields (a YAML mapping), got {came}; see `study init` for an example"
            )
        return next(iter(_cases_of(content, path).values())) if PAPERS_OWN & content.keys() else own_case(content, path)
    if ":" in str(name_or_path):
        return suite_case(str(name_or_path))
    cases = _library()
    if str(name_or_path) not in cases:
        raise unknown("case", str(name_or_path), cases)
    return cases[str(name_or_path)]


@cache
def _library() -> dict[str, Case]:
    cases: dict[str, Case] = {}
    for path in sorted((data_folder() / "cases").glob("*.yaml")):
        in_file = _cases_in(path)
        if doubled := cases.keys() & in_file.keys():
            raise StudyError(f"file {path.name!r}: case {min(doubled)!r} is defined in another file too; rename one")
        cases |= in_file
    return cases


def _cases_in(path: Path) -> dict[str, Case]:
    return _cases_of(read_yaml(path), path)


def _cases_of(content: Mapping[str, Any], path: Path) -> dict[str, Case]:
    where = f"file {path.name!r}"
    base = checked(CaseFile, content, where)
    files = [base]
    files += [checked(CaseFile, varied(base, name), f"{where}, variant {name!r}") for name in base.variants]
    return {file.name: _case(file, f"{where}, case {file.name!r}") for file in files}


def _case(file: CaseFile, where: str) -> Case:
    try:
        return _built(file)
    except ValueError as error:
        raise StudyError(f"{where}: field {error}") from None
    except StudyError as error:
        raise StudyError(f"{where}: {error}") from None


def _built(file: CaseFile) -> Case:
    problem = Problem(
        name=file.name,
        waypoints=in_si(file.waypoints.values, file.units, "waypoints.values"),
        limits=_limits(file.limits, file.units),
        end=EndCondition[file.end.upper()],
        duration_bounds=(file.duration_bounds.lower, file.duration_bounds.upper),
        arm=_arm(file),
    )
    printed = file.settings
    return Case(
        name=file.name,
        title=file.title,
        paper=file.paper,
        problem=problem,
        curve=curve_named(file.curve).name,
        settings=RunSettings(
            curve=file.curve,
            evaluations=printed.population * printed.iterations,
            population=printed.population,
            formulation=Formulation(printed.formulation),
            synchronisation=Synchronisation(printed.synchronisation),
        ),
        planner=file.planner,
        robot=file.robot,
        units=tuple(SI[unit][0] for unit in file.units),
        published=tuple(_published(entry, problem, i) for i, entry in enumerate(file.published)),
        notes=tuple(file.notes),
        default=file.default,
        fixed_joints={joint - 1: value for joint, value in file.fixed_joints.items()},
        position_range=_position_range(file.limits, file.units),
        sources=_sources(file),
        limits_label=file.limits_label,
        variant_of=file.variant_of,
    )


def _arm(file: CaseFile) -> ArmLimits | None:
    if file.limits.torque is None:
        return None
    arm, values = heavy_arm(file.robot or ""), file.limits.torque.values
    return ArmLimits(
        without_friction(arm.mechanism), arm.effort if values == "effort" else np.array(values, dtype=float)
    )


def _limits(limits: Limits, units: list[Unit]) -> JointLimits:
    def rates(field_name: str, given: Rates | None) -> Floats:
        if given is None:
            return np.array(np.inf)
        return in_si(given.values, given.units or units, f"limits.{field_name}.values")

    judged = limits.position is not None and limits.position.judged
    span = _position_range(limits, units) if judged else None
    lower, upper = (np.array(-np.inf), np.array(np.inf)) if span is None else span
    return JointLimits(
        rates("velocity", limits.velocity),
        rates("acceleration", limits.acceleration),
        rates("jerk", limits.jerk),
        lower,
        upper,
    )


def _position_range(limits: Limits, units: list[Unit]) -> Floats | None:
    if limits.position is None:
        return None
    span = [limits.position.lower, limits.position.upper]
    return frozen_array(in_si(span, limits.position.units or units, "limits.position"), "position range")


def _published(entry: Printed, problem: Problem, index: int) -> Published:
    if entry.joint is not None and entry.joint > problem.n_joints:
        raise ValueError(f"published.{index}.joint: there are {problem.n_joints} joints, got {entry.joint}")
    if entry.durations is not None and len(entry.durations) != problem.n_segments:
        raise ValueError(
            f"published.{index}.durations: must have one number for each of {problem.n_segments} segments, "
            f"got {len(entry.durations)}"
        )
    return Published(
        label=entry.label,
        total=entry.total,
        durations=None if entry.durations is None else frozen_array(entry.durations, "durations"),
        joint=None if entry.joint is None else entry.joint - 1,
        source=entry.source,
    )


def _sources(file: CaseFile) -> dict[str, str]:
    limits = {
        f"{name} limits": getattr(file.limits, name)
        for name in ("velocity", "acceleration", "jerk", "position", "torque")
    }
    parts = {
        "waypoints": file.waypoints,
        **limits,
        "duration bounds": file.duration_bounds,
        "settings": file.settings,
    }
    return {name: part.source or f"ours: {part.ours}" for name, part in parts.items() if part is not None}
