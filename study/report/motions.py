"""Every method's motion as a file of samples, for people who want to drive it or plot it themselves."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from study.experiment.cases import Case
from study.io.export import write_motion
from study.report.rows import Entry

RATE = 50.0
"""Samples per second, Hz; `study export` writes any other rate, and the exact polynomials."""

RESERVED = ("index", "all")


def motion_files(entries: Sequence[Entry]) -> dict[str, str]:
    """File names for the methods that have a motion to show, by label."""
    names: dict[str, str] = {}
    for entry in entries:
        if entry.motion is not None and entry.row.joint is None:
            names[entry.label] = file_name(entry.label, names.values()) + ".csv"
    return names


def write_motions(folder: Path, case: Case, entries: Sequence[Entry], files: Mapping[str, str]) -> None:
    """Write the representative motion of every method: time, positions, velocities and accelerations of all joints."""
    for entry in entries:
        if entry.label in files and entry.motion is not None and entry.row.joint is None:
            write_motion(entry.motion, case.problem, folder / files[entry.label], RATE)


def file_name(name: str, taken: Collection[str], reserved: Collection[str] = RESERVED) -> str:
    """Stem of a file for a name: letters, digits, dot, dash and underscore only, and not one that is taken.

    Parameters
    ----------
    name : str
    taken : collection of str
        Names or stems given out before; names that differ in case only count as the same, as on many disks.
    reserved : collection of str
        Stems that stand for something else.
    """
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "-", name).strip(".-") or "case"
    used = {Path(one).name.lower().removesuffix(".csv") for one in taken} | set(reserved)
    slug, number = stem, 2
    while slug.lower() in used:
        slug, number = f"{stem}-{number}", number + 1
    return slug


def file_stem(name: str) -> str:
    """A case's name as the name of its recording."""
    kept = "".join(letter if letter.isalnum() or letter in "-_. " else "_" for letter in name).strip(" .")
    return kept or "case"
