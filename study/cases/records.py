"""Best known times of a suite's problems, by kind of motion, as they are committed: who found them, and what is proved."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field

from study.cases.suite_file import suites_folder
from study.cases.suites import Suite
from study.datafiles import Strict, checked
from study.errors import StudyError
from study.io.documents import parsed
from study.planning import Freedom

Seconds = Annotated[float, Field(gt=0)]


class Record(Strict):
    """Best known time of one kind of motion.

    Attributes
    ----------
    duration : float, s
    by : str
        Planner with its seed and budget, or the name of who submitted it.
    durations : list of float, s, optional
        Of the segments, where the motion is the case's curve; it is judged again from them.
    file : str, optional
        File beside this one that holds a submitted motion.
    """

    duration: Seconds
    by: str
    durations: list[Seconds] | None = None
    file: str | None = None


class ProblemRecords(Strict):
    """Records of a problem by kind of motion, and the highest proved bound of any motion, s."""

    best: dict[Freedom, Record] = Field(default_factory=dict)
    bound: float | None = None
    bound_by: str | None = None


class RecordsFile(Strict):
    """Records of a suite: `data/suites/records/SUITE.json`."""

    suite: str
    checksum: str
    problems: dict[str, ProblemRecords]


def records_file(suite: Suite) -> Path:
    """Place of a suite's records."""
    return suites_folder() / "records" / f"{suite.name}.json"


def records_of(suite: Suite) -> dict[str, ProblemRecords]:
    """Records of a suite, empty where there are none.

    Raises
    ------
    StudyError
        If the file is broken, or its records are of other problems.
    """
    path, known = records_file(suite), dict[str, ProblemRecords]()
    if path.is_file():
        known = checked(RecordsFile, parsed(path), f"file {path.name!r}").problems
    for file in sorted(path.with_suffix("").glob("*.exact.json")):
        name, record = _contributed(file)
        old = known.get(name, ProblemRecords())
        if Freedom.FREE not in old.best or record.duration < old.best[Freedom.FREE].duration:
            known = known | {name: old.model_copy(update={"best": {**old.best, Freedom.FREE: record}})}
    if unknown := sorted(known.keys() - suite.cases.keys()):
        raise StudyError(f"records {path.name!r}: suite {suite.name!r} has no problem {unknown[0]!r}")
    return known


def _contributed(file: Path) -> tuple[str, Record]:
    """Problem and record of a file that `study suite submit` wrote; whoever changes it is found out by the judge."""
    said = parsed(file).get("record")
    if not isinstance(said, dict) or not {"problem", "duration", "by"} <= said.keys():
        raise StudyError(f"file {file.name!r} is no record; write it with `study suite submit`")
    return str(said["problem"]), Record(duration=said["duration"], by=str(said["by"]), file=file.name)


def known_times(suite: Suite) -> dict[tuple[str, str], float]:
    """Best known times by problem and kind of motion, s."""
    return {
        (name, str(kind)): record.duration
        for name, records in records_of(suite).items()
        for kind, record in records.best.items()
    }
