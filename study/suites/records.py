"""Best known times of a suite's problems, by kind of motion: who found them, and what is proved."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from study.analysis.formatting import percent
from study.cases.case import Case
from study.cases.suite_file import suites_folder
from study.cases.suites import Suite
from study.curves import curve_named
from study.datafiles import Strict, checked
from study.errors import StudyError
from study.io.documents import parsed
from study.judge import judge
from study.planning import Freedom
from study.store.results import Result

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


def improved(
    known: Mapping[str, ProblemRecords], results: Iterable[Result], kinds: Mapping[str, Freedom | None]
) -> dict[str, ProblemRecords]:
    """Records with what results bring below the best times and above the bounds; ties stay with who was first.

    Parameters
    ----------
    known : mapping of str to ProblemRecords
    results : iterable of Result
        Feasible motions, as the judge passed them, and bounds.
    kinds : mapping of str to Freedom, optional
        Kind of motion of every planner; None for a bound.
    """
    records = dict(known)
    for result in results:
        name, kind = result.cell.case, kinds[result.cell.planner]
        old = records.get(name, ProblemRecords())
        if kind is None:
            bound = result.lower_bound
            if bound and bound > (old.bound or 0.0) * (1 + 1e-9):
                records[name] = old.model_copy(update={"bound": bound, "bound_by": result.cell.planner})
        elif result.feasible and (kind not in old.best or result.duration < old.best[kind].duration * (1 - 1e-9)):
            record = Record(duration=result.duration, by=_finder(result), durations=_durations(result, kind))
            records[name] = old.model_copy(update={"best": {**old.best, kind: record}})
    return dict(sorted(records.items()))


def _finder(result: Result) -> str:
    settings = result.cell.settings
    if not result.evaluations:
        return result.cell.planner
    return f"{result.cell.planner}, seed {settings.seed}, {settings.evaluations} evaluations"


def _durations(result: Result, kind: Freedom) -> list[float] | None:
    given = kind is Freedom.CURVE and result.durations is not None
    return [float(each) for each in result.durations] if given and result.durations is not None else None


def contradictions(records: Mapping[str, ProblemRecords], cases: Mapping[str, Case]) -> list[str]:
    """Sentences on records that cannot be: below the proved bound, or another time than their durations give when judged."""
    sentences = []
    for name, each in records.items():
        for kind, record in each.best.items():
            if each.bound and record.duration < each.bound * (1 - 1e-6):
                sentences.append(
                    f"{name}, {kind}: {record.duration:.9g} s is below the proved bound {each.bound:.9g} s"
                )
            if record.durations and (reason := _refuted(record, cases[name])):
                sentences.append(f"{name}, {kind}: {reason}")
    return sentences


def _refuted(record: Record, case: Case) -> str:
    durations = np.array(record.durations)
    verdict = judge(case.problem, curve_named(case.curve).motion(case.problem.waypoints, durations))
    if not verdict.feasible:
        return "; ".join(verdict.reasons)
    off = abs(verdict.duration / record.duration - 1.0)
    return f"its durations give {verdict.duration:.9g} s, not {record.duration:.9g} s" if off > 1e-9 else ""


def records_text(suite: Suite, records: Mapping[str, ProblemRecords]) -> str:
    """Write records as they are committed: JSON, one line for each problem."""
    head = f'"suite": {json.dumps(suite.name)}, "checksum": {json.dumps(suite.checksum)}'
    lines = [f" {json.dumps(name)}: {each.model_dump_json(exclude_none=True)}" for name, each in records.items()]
    return "{" + head + ', "problems": {\n' + ",\n".join(lines) + "\n}}\n"


def records_table(suite: Suite) -> str:
    """Best known times and bounds as a table in Markdown, a row for each problem."""
    heads = ["problem", *(f"{kind}, s" for kind in Freedom), "found by", "bound, s", "above it"]
    lines = [heads, ["---"] + ["---:"] * len(Freedom) + ["---", "---:", "---:"]]
    for name, each in records_of(suite).items():
        times = [f"{each.best[kind].duration:.5g}" if kind in each.best else "–" for kind in Freedom]
        best = min(each.best.values(), key=lambda record: record.duration, default=None)
        above = "–" if best is None or not each.bound else percent(best.duration / each.bound - 1.0)
        bound = "–" if each.bound is None else f"{each.bound:.5g}"
        lines.append([name, *times, "–" if best is None else best.by, bound, above])
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
