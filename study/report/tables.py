"""The tables of the report: one set of records for the page, CSV and Parquet; the only file that imports pyarrow."""

from __future__ import annotations

import csv
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from study.analysis.formatting import DASH, bare_seconds, count, percent, share, wall
from study.analysis.rows import Entry
from study.cases.library import Case
from study.judge import RATES
from study.runs.lineup import QUICK_EVALUATIONS, TIME_LIMIT

Value = str | int | float | bool | None
Record = dict[str, Value]


@dataclass(frozen=True)
class Column:
    """A column of the results table: its key in the files, its head on the page and how a value reads there."""

    key: str
    head: str
    hint: str
    text: Callable[[Value], str]
    numeric: bool = True


def _plain(value: Value) -> str:
    return DASH if value in (None, "") else str(value)


def _number(form: Callable[[float | None], str]) -> Callable[[Value], str]:
    return lambda value: form(float(value) if isinstance(value, int | float) else None)


COLUMNS = (
    Column("rank", "#", "place among feasible methods, by median time", _plain),
    Column(
        "method",
        "Method",
        "planner and, after a colon, what is done otherwise than is usual for the case",
        _plain,
        False,
    ),
    Column(
        "median_s",
        "Median, s",
        "what one run brings: median time over the feasible runs; of an infeasible method the time of its motion",
        _number(bare_seconds),
    ),
    Column("best_s", "Best, s", "the luckiest seed: shortest time of a feasible run", _number(bare_seconds)),
    Column(
        "gap_same_path",
        "Gap",
        "median above the shortest feasible time known here for the same kind of path",
        _number(percent),
    ),
    Column(
        "gap_to_bound",
        "To bound",
        "median above the proved lower bound of any motion through the waypoints",
        _number(percent),
    ),
    Column("path", "Path", "what the method was free to change, see below", _plain, False),
    Column("feasible", "Feasible", "runs that passed the judge, of all runs: one for each seed", _plain, False),
    Column("worst_ratio", "Limit use", "largest peak over its limit; above 1 a limit is broken", _number(share)),
    Column(
        "evaluations",
        "Evals",
        "curve evaluations of a run, median over runs; of one joint each where every joint is searched alone",
        _number(lambda v: count(v) if v else DASH),
    ),
    Column("wall_s", "Wall", "computing time of a run, median over runs", _number(lambda v: wall(v) if v else DASH)),
    Column("kind", "Kind", "search (with a seed), deterministic or published", _plain, False),
)


ARROW = {str: pa.string(), int: pa.int64(), float: pa.float64(), bool: pa.bool_()}
SCHEMAS: dict[str, dict[str, type]] = {
    "results": {
        **dict.fromkeys(("case",), str), "rank": int, **dict.fromkeys(("method", "kind", "path"), str),
        **dict.fromkeys(("median_s", "best_s", "gap_same_path", "gap_any_path", "gap_to_bound"), float), "feasible": str,
        **dict.fromkeys(("runs", "feasible_runs"), int), "worst_ratio": float, "evaluations": int,
        **dict.fromkeys(("wall_s", "claimed_s"), float), **dict.fromkeys(("reason", "command"), str),
    },
    "runs": {
        **dict.fromkeys(("case", "method"), str), "seed": int, "status": str, "duration_s": float, "feasible": bool,
        **dict.fromkeys(("worst_ratio", "waypoint_error"), float),
        **dict.fromkeys(("continuity", "evaluations", "iterations"), int), "wall_s": float, "message": str,
    },
    "limits": {
        **dict.fromkeys(("case", "method", "joint", "rate"), str),
        **dict.fromkeys(("peak", "limit", "ratio", "at_s"), float), "segment": int,
    },
    "segments": {"case": str, "method": str, "segment": int, "start_s": float, "duration_s": float},
}  # fmt: skip
"""Columns of every file and what they hold."""


AGAIN = "again"
"""Folder of the commands below, so that the report they are copied from stays as it is."""


def command(case: Case, entry: Entry, source: str = "") -> str:
    """Shell command that makes a row again, in a folder of its own; empty where the paper prints nothing to judge.

    Parameters
    ----------
    case : Case
    entry : Entry
    source : str
        What loads the case: its name by default, a path for a case of one's own.
    """
    if entry.row.representative is None:
        return ""
    parts = ["study", "run", "--cases", source or case.name, "--planners"]
    if not entry.results:  # every run judges what the paper prints; this is the quickest one
        return shlex.join([*parts, "centre", "--out", AGAIN])
    settings = entry.results[0].cell.settings
    parts.append(entry.label)
    if entry.row.kind == "search":
        parts += ["--seeds", str(max(one.cell.settings.seed for one in entry.results) + 1)]
    if settings.evaluations != QUICK_EVALUATIONS:
        parts += ["--evaluations", str(settings.evaluations)]
    if settings.time_limit != TIME_LIMIT:
        parts += ["--time-limit", f"{settings.time_limit:g}"]
    return shlex.join([*parts, "--out", AGAIN])


def result_record(case: Case, entry: Entry, source: str = "") -> Record:
    """One row of the results table; times in s, shares as plain numbers; `source` is what loads the case."""
    row = entry.row
    return {
        "case": case.name,
        "rank": entry.rank,
        "method": entry.label,
        "kind": row.kind,
        "path": entry.path,
        "median_s": _float(entry.duration),
        "best_s": _float(row.best),
        "gap_same_path": _float(entry.gap),
        "gap_any_path": _float(row.gap),
        "gap_to_bound": _float(entry.gap_to_bound),
        "feasible": f"{row.feasible_runs}/{row.runs}",
        "runs": row.runs,
        "feasible_runs": row.feasible_runs,
        "worst_ratio": _float(row.worst_ratio),
        "evaluations": row.evaluations,
        "wall_s": _float(row.wall_time),
        "claimed_s": _float(row.claimed),
        "reason": row.reason,
        "command": command(case, entry, source),
    }


def run_records(case: Case, entry: Entry) -> list[Record]:
    """One record for every seed of a method."""
    return [
        {
            "case": case.name,
            "method": entry.label,
            "seed": one.cell.settings.seed,
            "status": one.status.value,
            "duration_s": _float(one.verdict.duration) if one.verdict else None,
            "feasible": bool(one.verdict and one.verdict.feasible),
            "worst_ratio": _float(one.verdict.worst_ratio) if one.verdict else None,
            "waypoint_error": _float(one.verdict.waypoint_error.max()) if one.verdict else None,
            "continuity": one.verdict.continuity if one.verdict else None,
            "evaluations": one.evaluations,
            "iterations": one.iterations,
            "wall_s": _float(one.wall_time),
            "message": "; ".join(one.verdict.reasons) if one.verdict and one.verdict.reasons else one.message,
        }
        for one in entry.results
    ]


def limit_records(case: Case, entry: Entry) -> list[Record]:
    """One record for every joint and rate of a method's representative motion."""
    verdict = entry.row.representative.verdict if entry.row.representative else None
    if verdict is None or entry.row.joint is not None:
        return []
    limits = case.problem.limits.rates
    return [
        {
            "case": case.name,
            "method": entry.label,
            "joint": name,
            "rate": rate,
            "peak": _float(verdict.peaks[order, joint]),
            "limit": _float(limits[order, joint]),
            "ratio": _float(verdict.ratios[order, joint]),
            "at_s": _float(verdict.times[order, joint]),
            "segment": int(verdict.segments[order, joint]) + 1,
        }
        for order, rate in enumerate(RATES)
        for joint, name in enumerate(case.problem.joint_names)
    ]


def segment_records(case: Case, entry: Entry) -> list[Record]:
    """One record for every segment of a method's representative motion."""
    if entry.motion is None or entry.row.joint is not None:
        return []
    times = entry.motion.waypoint_times
    return [
        {"case": case.name, "method": entry.label, "segment": k + 1, "start_s": float(a), "duration_s": float(b - a)}
        for k, (a, b) in enumerate(pairwise(times))
    ]


def write_tables(
    folder: Path, name: str, cases: Sequence[tuple[Case, Sequence[Entry]]], sources: Mapping[str, str]
) -> None:
    """Write results, runs, limits and segments of some cases as CSV and Parquet.

    Parameters
    ----------
    folder : Path
    name : str
        Beginning of the file names.
    cases : sequence of (Case, entries)
    sources : mapping of str to str
        What loads a case, where that is not its name.
    """
    pairs = [(case, entry) for case, entries in cases for entry in entries]
    tables = {
        "results": [result_record(*pair, sources.get(pair[0].name, "")) for pair in pairs],
        "runs": [record for pair in pairs for record in run_records(*pair)],
        "limits": [record for pair in pairs for record in limit_records(*pair)],
        "segments": [record for pair in pairs for record in segment_records(*pair)],
    }
    for kind, records in tables.items():
        with (folder / f"{name}-{kind}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(SCHEMAS[kind])
            writer.writerows([[raw(record[key]) for key in SCHEMAS[kind]] for record in records])
        schema = pa.schema([(key, ARROW[of]) for key, of in SCHEMAS[kind].items()])
        pq.write_table(pa.Table.from_pylist(records, schema=schema), folder / f"{name}-{kind}.parquet")


def raw(value: Value) -> str:
    """Write a value exactly as the CSV file does."""
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def _float(value: float | None) -> float | None:
    return None if value is None else float(value)
