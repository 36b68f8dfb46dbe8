"""Anyone's trajectory as a candidate for a record: read, slowed where it must be, judged without room, and written."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from study.cases.case import Case
from study.cases.recorded import is_exact, motion_of, passing
from study.cases.suites import Suite
from study.errors import StudyError
from study.io.exact import exact_text, read_exact
from study.io.recordings import read_samples
from study.io.sampled import joined
from study.judge import Verdict, judge
from study.trajectory import Motion

ENDING = ".exact.json"


@dataclass(frozen=True, eq=False)
class Submission:
    """A trajectory under the judge.

    Attributes
    ----------
    case : Case
    motion : Motion
        Slowed down by `stretch`.
    stretch : float
        Smallest factor after which the limits of rates are kept; 1 where they are kept as it is.
    verdict : Verdict
        Of the slowed motion, with no more room than any planner's motion has.
    """

    case: Case
    motion: Motion
    stretch: float
    verdict: Verdict


def submission(file: Path, case: Case, units: str | None = None) -> Submission:
    """Read a trajectory in any format that `study check` reads, and judge it.

    Samples are joined as controllers join them. A motion that breaks limits of rates is slowed by the smallest factor, as
    every peer's is; what misses a waypoint or leaves the range stays refused.

    Raises
    ------
    StudyError
        If the file cannot be read, or holds no trajectory of the case's joints.
    """
    where = f"file {file.name!r}"
    if is_exact(file):
        motion = passing(read_exact(file), case)
    else:
        samples = motion_of(read_samples(file), case, units, where)
        motion = joined(samples, case.problem, where, None).trajectory
    verdict = judge(case.problem, motion)
    stretch = verdict.stretch if case.problem.scalable else 1.0
    if stretch > 1.0:
        motion = motion.scaled(stretch)
        verdict = judge(case.problem, motion)
    return Submission(case, motion, stretch, verdict)


def record_text(given: Submission, suite: Suite, by: str) -> str:
    """Write a record: the exact motion, and what was found of it.

    Raises
    ------
    StudyError
        If the motion is not feasible, or nobody is named.
    """
    if not given.verdict.feasible:
        raise StudyError(f"the motion is no record: {given.verdict.reasons[0]}")
    if not by.strip():
        raise StudyError("say who found the motion, with --by")
    said = {
        "problem": given.case.name,
        "version": suite.version,
        "checksum": suite.checksum,
        "by": by.strip(),
        "duration": given.verdict.duration,
        "stretch": given.stretch,
    }
    return json.dumps({**json.loads(exact_text(given.motion, given.case.problem)), "record": said}) + "\n"


def refuted(file: Path, cases: dict[str, Case]) -> str:
    """Say what is wrong with a contributed record when it is judged again; empty where it holds."""
    said = json.loads(file.read_text(encoding="utf-8"))["record"]
    if said["problem"] not in cases:
        return f"there is no problem {said['problem']!r}"
    verdict = judge(cases[said["problem"]].problem, read_exact(file))
    if not verdict.feasible:
        return verdict.reasons[0]
    off = abs(verdict.duration / said["duration"] - 1.0)
    return "" if off < 1e-9 else f"its motion takes {verdict.duration:.9g} s, not {said['duration']:.9g} s"
