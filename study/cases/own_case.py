"""From a file about one's own robot to a case: names, units and limits put together from all the files that it names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from study.cases.case import Case
from study.cases.own_arm import arm_of
from study.cases.own_demands import demands_of, segments_between, tightest
from study.cases.own_file import OwnCase, OwnDirections, OwnRates
from study.cases.own_waypoints import (
    chosen_columns,
    moved_segments,
    placed,
    stepping_ends,
    tidied_demands,
    unlimited_joints,
    unused_columns,
)
from study.cases.paper_file import SI
from study.curves import curve_named
from study.datafiles import checked
from study.errors import StudyError, in_words_of, joint_error, listed, plural
from study.io.limits import LimitFile, read_limits
from study.io.one_joint import OneJoint
from study.io.recordings import read_samples
from study.io.samples import Samples
from study.limits import LARGEST, OPTIONAL
from study.planning import usual_curve, usual_settings
from study.problem import EndCondition, Floats, JointLimits, Problem
from study.robots import robot_named

Words = tuple[Sequence[str], Sequence[str], Sequence[float]]
"""Names and units of the joints, and how many rad or m each unit is."""

_RATES = ("velocity", "acceleration", "jerk")


OWN_EVALUATIONS = 15000
"""Budget of the searches on a case of one's own under `study run --full`: as many as the woodworking paper spends."""


def own_case(content: Mapping[str, Any], path: Path) -> Case:
    """Make a case of what a file about one's own robot says.

    Parameters
    ----------
    content : mapping
        What the file says, as `study.cases.own_file.OwnCase` describes it.
    path : Path
        Of the file; names of other files are looked up beside it.

    Raises
    ------
    StudyError
        If a field is missing, unknown or impossible, or a file that it names is.
    """
    where = f"file {path.name!r}"
    file = checked(OwnCase, content, where)
    rows = read_samples(path.parent / file.waypoints) if isinstance(file.waypoints, str) else None
    limit_files = [file.limits.files] if isinstance(file.limits.files, str) else file.limits.files
    limits = read_limits(*(path.parent / name for name in limit_files))
    read, warnings = limits.joints, [*limits.notes]
    if rows is not None:
        rows = chosen_columns(file, rows, limits)
    names = _names(file, rows, limits, where)
    if rows is not None:
        warnings += [f"{file.waypoints}: {note}" for note in (*rows.notes, *unused_columns(file, rows, names))]
    table = rows.of(names, where).positions if rows else np.array(_rectangle(file.waypoints, where), dtype=float)
    if (large := (np.abs(table) > LARGEST).any(axis=1)).any():
        raise StudyError(
            f"{where}: waypoint {large.argmax() + 1} is infinite or too large; give numbers up to {LARGEST:g}"
        )
    if len(table) == 1:
        raise StudyError(f"{where}: there is only one waypoint; a motion needs at least two")
    units = _units(file, rows, read, names, table.shape[1], where)
    factors = np.array([SI[unit][1] for unit in units])
    known = [read.get(name, OneJoint()) for name in names]
    words = names, units, factors.tolist()
    bounds = _limits(file.limits, known, factors, words, where)
    table, notes = placed(file, table if rows and rows.si else table * factors, known, bounds, names)
    _check_range(table, bounds, words, where)
    kept, demands = tidied_demands(file, table, demands_of(file, factors, len(table), where), where)
    demands["segment_limits"] = moved_segments(_segment_limits(file, factors, words, len(table), where), kept)
    robot = _robot(file.robot, path, names)
    demands["arm"] = arm_of(file, robot, names, where)
    problem = _problem(file, path, kept.waypoints, bounds, demands, words)
    warnings += [*notes, *kept.notes, *unlimited_joints(problem, read), *stepping_ends(file, problem)]
    problem = problem if file.speed is None else problem.at_speed(file.speed)
    sources = {"waypoints": str(file.waypoints) if rows else path.name, "limits": ", ".join(limit_files) or path.name}
    return _case(file, path, robot, problem, tuple(units), sources, tuple(warnings))


def _check_range(table: Floats, bounds: JointLimits, words: Words, where: str) -> None:
    outside = np.argwhere((table < bounds.lower) | (table > bounds.upper))
    if len(outside):
        row, joint = map(int, outside[0])
        values = table[row, joint], bounds.lower[joint], bounds.upper[joint]
        sentence = f"waypoint {row + 1} puts {{joint}} at {{0}}, outside its range [{{1}}, {{2}}]"
        raise StudyError(f"{where}: {in_words_of(joint_error(sentence, joint, *values), *words)}")


def _problem(
    file: OwnCase, path: Path, waypoints: Floats, limits: JointLimits, demands: dict[str, Any], words: Words
) -> Problem:
    where, names = f"file {path.name!r}", tuple(words[0])
    try:
        problem = Problem(
            name=file.name or path.stem,
            waypoints=waypoints,
            limits=limits,
            end=EndCondition[file.end.upper()] if file.end else OPTIONAL,
            duration_bounds=(b.lower, b.upper) if (b := file.duration_bounds) else OPTIONAL,
            joint_names=names,
            **demands,
        )
    except StudyError as error:
        raise StudyError(f"{where}: {in_words_of(error, *words)}" if error.about_joint else str(error)) from None
    if problem.moving.any() and not np.isfinite(problem.limits.rates[:, problem.moving]).any():
        still = "" if problem.moving.all() else ", and the joints that have limits stand still"
        raise StudyError(
            f"{where}: {listed([names[k] for k in np.flatnonzero(problem.moving)])} moves without any limit{still}, so there is no "
            "shortest time; give a velocity limit"
        )
    return problem


def _case(
    file: OwnCase,
    path: Path,
    robot: str | None,
    problem: Problem,
    units: tuple[str, ...],
    sources: Mapping[str, str],
    warnings: tuple[str, ...],
) -> Case:
    if (file.obstacles or file.self_collision) and robot is None:
        raise StudyError(f"file {path.name!r}: obstacles need a robot to know where the arm is; name one under 'robot'")
    curve = curve_named(file.curve or usual_curve(problem)).name
    return Case(
        name=problem.name,
        title=file.title or f"{plural(problem.n_joints, 'joint')} through {problem.n_waypoints} waypoints",
        problem=problem,
        curve=curve,
        settings=replace(usual_settings(problem), curve=curve, evaluations=OWN_EVALUATIONS),
        robot=robot,
        units=tuple(SI[unit][0] for unit in units),
        typed=units,
        notes=tuple(file.notes),
        sources=sources,
        obstacles=np.array([[box.lower, box.upper] for box in file.obstacles], dtype=float).reshape(-1, 2, 3),
        arm_radius=file.arm_radius,
        self_collision=file.self_collision,
        warnings=warnings,
    )


def _rectangle(rows: Any, where: str) -> list[list[float]]:
    width = len(rows[0]) if rows else 0
    for number, row in enumerate(rows, start=1):
        if len(row) != width:
            raise StudyError(f"{where}: waypoint {number} has {plural(len(row), 'number')}, the first has {width}")
    if not width:
        raise StudyError(f"{where}: there are no waypoints; give at least two, one row for each")
    return list(rows)


def _names(file: OwnCase, rows: Samples | None, limits: LimitFile, where: str) -> tuple[str, ...]:
    """Names of the joints: the case's own, else the waypoint file's, else those of the limits if their number fits."""
    read = limits.joints
    width = rows.positions.shape[1] if rows else len(file.waypoints[0]) if file.waypoints else 0
    names = tuple(file.joints or (rows.names if rows else ()) or (read if len(read) == width else ()))
    if not names and read:
        raise StudyError(
            f"{where}: the limits name {len(read)} joints ({', '.join(read)}), the waypoints have {width} columns without "
            "names; list the columns' names under 'joints'"
        )
    if names and not (rows and rows.names) and len(names) != width:
        raise StudyError(
            f"{where}: {plural(len(names), 'joint name')} for {plural(width, 'column')} of waypoints; name every column"
        )
    if len(set(names)) != len(names):
        raise StudyError(f"{where}: two joints have the same name: {', '.join(names)}; rename one")
    absent = [name for name in names if name not in read] if read else []
    if absent and not file.limits.velocity and not file.limits.acceleration and not file.limits.jerk:
        for note in limits.notes:
            if repr(absent[0]) in note:
                raise StudyError(f"{where}: no limits for joint {absent[0]!r}: {note}")
        near = get_close_matches(absent[0], set(read) - set(names), n=1, cutoff=0.7)
        raise StudyError(
            f"{where}: no limits for joint {absent[0]!r}; the files of limits know {', '.join(read)}"
            + (f"; did you mean {near[0]!r}?" if near else "; name the joints to be planned under 'joints' or --joints")
        )
    return names or tuple(f"joint {k + 1}" for k in range(width))


def _units(
    file: OwnCase, rows: Samples | None, read: Mapping[str, OneJoint], names: Sequence[str], width: int, where: str
) -> list[Any]:
    if file.units is None:
        own = any(getattr(file.limits, field) is not None for field in (*_RATES, "position"))
        said = rows.of(names, where).units if rows and not own else ()
        if said and all(said):
            return list(said)
        if own or rows is None or not rows.si:
            raise StudyError(f"{where}: field 'units' is missing; state rad or deg, or m or mm for joints that slide")
        return ["m" if name in read and read[name].sliding else "rad" for name in names]
    units = [file.units] * width if isinstance(file.units, str) else file.units
    if len(units) != width:
        raise StudyError(
            f"{where}: {plural(len(units), 'unit')} for {plural(width, 'joint')}; give one for all or one for each"
        )
    said = rows.of(names, where).units if rows else ()
    for name, unit, other in zip(names, units, said, strict=False):
        if other not in ("", unit):
            raise StudyError(
                f"{where}: column '{name} [{other}]' is in {other}, but 'units' says {unit}; make the two agree"
            )
    for name, unit in zip(names, units, strict=True):
        sliding = read[name].sliding if name in read else None
        if sliding is not None and sliding != (SI[unit][0] == "m"):
            kind = "slides, so its unit is m or mm" if sliding else "turns, so its unit is rad or deg"
            raise StudyError(f"{where}: joint {name!r} {kind}, got {unit}; give a list of units, one for each joint")
    return units


def _limits(own: OwnRates, read: Sequence[OneJoint], factors: Floats, words: Words, where: str) -> JointLimits:
    given = {name: getattr(own, name) for name in _RATES}
    lowest = {f"min_{name}": rate.lower for name, rate in given.items() if isinstance(rate, OwnDirections)}
    highest = {name: rate.upper if isinstance(rate, OwnDirections) else rate for name, rate in given.items()}
    span = {} if own.position is None else {"lower": own.position.lower, "upper": own.position.upper}
    said = {"lower": None, "upper": None} | highest | lowest | span
    try:
        return JointLimits(**{name: _laid_over(value, name, read, factors, where) for name, value in said.items()})
    except StudyError as error:
        raise StudyError(f"{where}: {in_words_of(error, *words)}") from None


def _segment_limits(
    file: OwnCase, factors: Floats, words: Words, n_waypoints: int, where: str
) -> dict[int, JointLimits]:
    result: dict[int, JointLimits] = {}
    for part in file.segments:
        limits = _limits(part, [OneJoint()] * len(factors), factors, words, f"{where}: segments")
        for segment in segments_between(part.first, part.last, n_waypoints, where):
            result[segment] = tightest(result.get(segment, limits), limits)
    return result


def _laid_over(given: Any, name: str, read: Sequence[OneJoint], factors: Floats, where: str) -> Floats:
    """One number per joint: the case's own, in its units, else the file's, else none."""
    nothing = -np.inf if name == "lower" or name.startswith("min_") else np.inf
    values = given if isinstance(given, list) else [given] * len(read)
    if len(values) != len(read):
        raise StudyError(
            f"{where}: {plural(len(values), f'{name} limit')} for {plural(len(read), 'joint')}; give one for all or one for each"
        )
    said = [getattr(joint, name, None) for joint in read]
    chosen = zip(values, said, factors, strict=True)
    return np.array([own * k if own is not None else nothing if old is None else old for own, old, k in chosen])


def _robot(name: str | None, path: Path, joints: Sequence[str]) -> str | None:
    """One of the study's arms, or the path of a file beside the case's; the arm must have the problem's joints."""
    if name is None:
        return None
    robot = str((path.parent / name).resolve()) if Path(name).suffix else name
    arm = robot_named(robot, tuple(joints))
    if arm.n_joints != len(joints):
        raise StudyError(
            f"file {path.name!r}: robot {arm.name!r} has {arm.n_joints} moving joints, the waypoints have {len(joints)}; "
            "name the moving ones under 'joints', as the robot's file does"
        )
    return robot
