"""Every method's motion as a file of samples, for people who want to drive it or plot it themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from study.analysis.rows import Entry
from study.cases.library import Case
from study.io.export import usual_rate, write_motion
from study.io.filenames import file_stem

RATE = 50.0
"""Samples per second of motions of seconds and minutes, Hz; `study plan` writes any other rate, and the exact polynomials."""
MOST_SAMPLES = 10_000


def motion_files(entries: Sequence[Entry]) -> dict[str, str]:
    """File names for the methods that have a motion to show, by label."""
    shown = [entry.label for entry in entries if entry.motion is not None and entry.row.joint is None]
    return {label: f"{file_stem(label)}.csv" for label in shown}


def write_motions(folder: Path, case: Case, entries: Sequence[Entry], files: Mapping[str, str]) -> None:
    """Write the representative motion of every method: time, positions, velocities and accelerations of all joints."""
    for entry in entries:
        if entry.label in files and entry.motion is not None and entry.row.joint is None:
            rate = usual_rate(entry.motion.duration, RATE, MOST_SAMPLES)
            write_motion(entry.motion, case.problem, folder / files[entry.label], rate)
