"""A trajectory of anyone's, put beside a case or beside limits alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from study.cases.case import Case
from study.cases.paper_file import SI
from study.errors import StudyError, plural, unknown
from study.io.exact import holds_coefficients
from study.io.limits import LimitFile, read_limits
from study.io.one_joint import OneJoint
from study.io.passages import passages
from study.io.samples import Samples
from study.io.waypoints import ROUNDED, unwound
from study.limits import JointLimits
from study.planning import usual_settings
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Motion, Trajectory

RATES = ("velocity", "acceleration", "jerk")


def is_exact(file: Path) -> bool:
    """Whether a file holds a motion as exact polynomials."""
    return file.name.lower().endswith(".exact.json") or holds_coefficients(file)


def passing(motion: Motion, case: Case) -> Motion:
    """Motion with the times at which it passes the waypoints of a case; as it is where there is nothing to look for."""
    if not isinstance(motion, Trajectory) or motion.n_joints != case.problem.n_joints:
        return motion
    problem = case.problem
    times = passages(motion.knots, motion.coefficients, problem.waypoints, problem.tolerances)
    return replace(motion, waypoint_times=times)


def limits_alone(samples: Samples, files: Sequence[Path], units: str | None, where: str) -> tuple[Case, Samples]:
    """Make a case of nothing but limits, from the first sample to the last, and put the samples in its order and in rad and m.

    Parameters
    ----------
    samples : Samples
    files : sequence of Path
        Files of limits; later ones win.
    units : str, optional
        Of the samples, where their file does not say.
    where : str
        How a message begins.

    Raises
    ------
    StudyError
        If a file cannot be read, or a joint of the samples has no limits in any of them.
    """
    limits = read_limits(*files)
    samples = samples.numbered(limits.joints)
    names, warnings = _limited(samples, limits, where)
    known = [limits.joints[name] for name in names]
    kinds = tuple("m" if joint.sliding else "rad" for joint in known)
    samples = _once(_si(samples.of(names, where), kinds, units, where), where)
    bounds = JointLimits(
        **{name: _column(known, name) for name in (*RATES, *(f"min_{r}" for r in RATES), "lower", "upper")}
    )
    positions, notes = unwound(samples.positions, np.array([bool(joint.endless) for joint in known]), names)
    samples = replace(samples, positions=positions).noting(*notes)
    ends = np.clip(positions[[0, -1]], bounds.lower, bounds.upper)
    problem = Problem(
        name=where,
        waypoints=ends,
        limits=bounds,
        end=EndCondition.FREE,
        allow_dwell=True,
        joint_names=names,
        tolerance=np.abs(positions[[0, -1]] - ends),
    )
    case = Case(
        name=where,
        title="a trajectory against limits alone",
        problem=problem,
        curve="cubic-spline",
        settings=usual_settings(problem),
        units=kinds,
        warnings=warnings,
    )
    return case, samples


def _limited(samples: Samples, limits: LimitFile, where: str) -> tuple[list[str], tuple[str, ...]]:
    """Joints of the samples that have limits, and what must be said of the others."""
    read, width = limits.joints, samples.positions.shape[1]
    names = [name for name in samples.names if name in read] or (list(read) if len(read) == width else [])
    if not names:
        raise StudyError(f"{where}: none of its joints has limits; the files of limits know {', '.join(read)}")
    left = [name for name in samples.names if name not in names and name not in limits.followers]
    others = [f"not judged: joint {', '.join(map(repr, left))}, which no file of limits knows"] if left else []
    return names, (*limits.notes, *others)


def _once(samples: Samples, where: str) -> Samples:
    """Leave out samples that repeat the one before them, its time among the rest.

    Raises
    ------
    StudyError
        If two samples have the same time and differ, or a later one has an earlier time.
    """
    if samples.times is None or len(samples.times) < 2:
        return samples
    table = np.column_stack([samples.times, samples.positions, *samples.rates])
    same = np.append(False, (table[1:] == table[:-1]).all(axis=1))
    if not same.any():
        return samples
    rates = (None if rate is None else rate[~same] for rate in (samples.velocities, samples.accelerations))
    velocities, accelerations = rates
    note = f"not used: {plural(int(same.sum()), 'sample')} equal to the one before, the first of them sample {int(same.argmax()) + 1}"
    return replace(
        samples,
        times=samples.times[~same],
        positions=samples.positions[~same],
        velocities=velocities,
        accelerations=accelerations,
    ).noting(note)


def _column(known: Sequence[OneJoint], name: str) -> Floats:
    nothing = -np.inf if name == "lower" or name.startswith("min_") else np.inf
    values = [getattr(joint, name) for joint in known]
    if name.startswith("min_"):  # without a limit of its own a joint is as fast one way as the other
        highest = [getattr(joint, name.removeprefix("min_")) for joint in known]
        values = [-high if low is None and high is not None else low for low, high in zip(values, highest, strict=True)]
    return np.array([nothing if value is None else value for value in values])


def motion_of(samples: Samples, case: Case, units: str | None, where: str) -> Samples:
    """Put the columns of samples in the order of a case's joints, in rad and m, matched by name where there are names.

    Raises
    ------
    StudyError
        If a joint has no column, or a unit is unknown.
    """
    names = case.problem.joint_names
    if not samples.names:
        samples = _in_order(samples, len(names), where)
    elif not samples.si and not set(names) & set(samples.names):
        samples = _in_order(samples, len(names), where).noting(
            "no column has the name of a joint of the case, so the columns were taken in their order"
        )
    return _once(_si(samples.of(names, where), case.units, units, where), where)


def _in_order(samples: Samples, n_joints: int, where: str) -> Samples:
    """Columns without the names of joints: time, unless it is known, then positions, velocities and accelerations."""
    table, times = samples.positions, samples.times
    if times is not None and table.shape[1] == n_joints:
        return samples
    if times is None:
        table, times = table[:, 1:], table[:, 0]
    if samples.velocities is not None and table.shape[1] == n_joints:
        return replace(samples, names=(), times=times)
    orders = table.shape[1] // n_joints
    if table.shape[1] != orders * n_joints or not 1 <= orders <= 3 or samples.velocities is not None:
        raise StudyError(
            f"{where}: expected {1 + n_joints}, {1 + 2 * n_joints} or {1 + 3 * n_joints} columns (time, then positions, "
            f"velocities, accelerations of {n_joints} joints), got {1 + table.shape[1]}"
        )
    positions, *rates = np.split(table, orders, axis=1)
    velocities, accelerations = [*rates, None, None][:2]
    return replace(
        samples, positions=positions, names=(), times=times, velocities=velocities, accelerations=accelerations
    )


def _si(samples: Samples, kinds: Sequence[str], units: str | None, where: str) -> Samples:
    if samples.si:
        return samples
    if not units and not samples.units:
        samples = samples.noting("the file does not say its units: taken as rad and m; --units says otherwise")
    said = [unit.strip() for unit in units.split(",")] if units else list(samples.units) or ["rad"]
    said = said * len(kinds) if len(said) == 1 else said
    for unit in said:
        if unit not in SI:
            raise unknown("unit", unit, SI)
    if len(said) != len(kinds):
        raise StudyError(
            f"{where}: {plural(len(said), 'unit')} for {plural(len(kinds), 'joint')}; give one or one for each"
        )
    if units and any(mine not in ("", given) for mine, given in zip(samples.units, said, strict=False)):
        raise StudyError(
            f"{where}: its columns are in {', '.join(samples.units)}, but --units says {units}; make the two agree"
        )
    factors = [SI[unit][1] if SI[unit][0] == kind else 1.0 for unit, kind in zip(said, kinds, strict=True)]
    return samples.scaled(np.array(factors))


def with_room(problem: Problem, tolerance: float) -> Problem:
    """Widen limits of rates and of the arm by a share, the tolerance of waypoints by that share of every joint's span, and ranges
    by rounding."""
    limits = problem.limits.widened(tolerance)
    limits = replace(limits, lower=limits.lower - ROUNDED, upper=limits.upper + ROUNDED)
    room = np.maximum(problem.tolerances, tolerance * np.ptp(problem.waypoints, axis=0))
    return replace(problem, limits=limits, tolerance=room, arm=problem.arm and problem.arm.widened(tolerance))
