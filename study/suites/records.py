"""Best known times: results that beat them, sentences on contradictions, their text and their table."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

import numpy as np

from study.analysis.formatting import percent
from study.cases.case import Case
from study.cases.records import ProblemRecords, Record, records_of
from study.cases.suites import Suite
from study.curves import curve_named
from study.judge import judge
from study.planning import Freedom
from study.store.results import Result


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
