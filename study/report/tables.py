"""The tables of the report: one set of records for the page, CSV and Parquet."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from study.analysis.case_summary import CaseSummary
from study.analysis.featured import group_of
from study.analysis.formatting import DASH, bare_seconds, count, percent, share, wall
from study.analysis.methods import Kind, MethodSummary
from study.analysis.tables import Record, Value, write_table
from study.cases.library import Case
from study.io.export import write_motion
from study.io.filenames import file_stem
from study.io.sampling import Sampling, usual_rate
from study.judge import RATES
from study.runs.lineup import QUICK_EVALUATIONS, TIME_LIMIT


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
    Column("gap", "Gap", "median above the shortest feasible time known here, on whatever path", _number(percent)),
    Column(
        "behind_same_kind",
        "Behind its kind",
        "median above the shortest feasible time known here for the same kind of path",
        _number(percent),
    ),
    Column(
        "above_bound",
        "Above bound",
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
    Column(
        "group",
        "Kind",
        "searches, which need a seed, by where they come from: the case's own paper, the papers, or no paper (modern); "
        "deterministic; published",
        _plain,
        False,
    ),
)


SCHEMAS: dict[str, dict[str, type]] = {
    "results": {
        **dict.fromkeys(("case",), str), "rank": int, **dict.fromkeys(("method", "kind", "group", "path"), str),
        **dict.fromkeys(("median_s", "best_s", "gap", "behind_same_kind", "above_bound"), float), "feasible": str,
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


def command(case: Case, method: MethodSummary, source: str = "") -> str:
    """Shell command that makes a row again, in a folder of its own; empty where the paper prints nothing to judge.

    Parameters
    ----------
    case : Case
    method : MethodSummary
    source : str
        What loads the case: its name by default, a path for a case of one's own.
    """
    if method.representative is None:
        return ""
    parts = ["study", "run", "--cases", source or case.name, "--planners"]
    if method.kind is Kind.PUBLISHED:  # every run judges what the paper prints; this is the quickest one
        return shlex.join([*parts, "centre", "--out", AGAIN])
    settings = method.results[0].cell.settings
    parts.append(method.label)
    if method.kind is Kind.SEARCH:
        parts += ["--seeds", str(max(run.cell.settings.seed for run in method.results) + 1)]
    if settings.evaluations != QUICK_EVALUATIONS:
        parts += ["--evaluations", str(settings.evaluations)]
    if settings.time_limit != TIME_LIMIT:
        parts += ["--time-limit", f"{settings.time_limit:g}"]
    return shlex.join([*parts, "--out", AGAIN])


def result_record(case: Case, method: MethodSummary, source: str = "", own: MethodSummary | None = None) -> Record:
    """One row of the results table; times in s, shares as plain numbers.

    Parameters
    ----------
    case : Case
    method : MethodSummary
    source : str
        What loads the case.
    own : MethodSummary, optional
        The method of the case's own paper.
    """
    return {
        "case": case.name,
        "rank": method.rank,
        "method": method.label,
        "kind": method.kind,
        "group": group_of(method, own),
        "path": method.freedom or "",
        "median_s": _float(method.duration),
        "best_s": _float(method.best),
        "gap": _float(method.gap),
        "behind_same_kind": _float(method.behind_same_kind),
        "above_bound": _float(method.above_bound),
        "feasible": f"{method.feasible_runs}/{method.runs}",
        "runs": method.runs,
        "feasible_runs": method.feasible_runs,
        "worst_ratio": _float(method.worst_ratio),
        "evaluations": method.evaluations,
        "wall_s": _float(method.wall_time),
        "claimed_s": _float(method.claimed),
        "reason": method.reason,
        "command": command(case, method, source),
    }


def run_records(case: Case, method: MethodSummary) -> list[Record]:
    """One record for every seed of a method."""
    return [
        {
            "case": case.name,
            "method": method.label,
            "seed": run.cell.settings.seed,
            "status": run.status.value,
            "duration_s": _float(run.verdict.duration) if run.verdict else None,
            "feasible": bool(run.verdict and run.verdict.feasible),
            "worst_ratio": _float(run.verdict.worst_ratio) if run.verdict else None,
            "waypoint_error": _float(run.verdict.waypoint_error.max()) if run.verdict else None,
            "continuity": run.verdict.continuity if run.verdict else None,
            "evaluations": run.evaluations,
            "iterations": run.iterations,
            "wall_s": _float(run.wall_time),
            "message": "; ".join(run.verdict.reasons) if run.verdict and run.verdict.reasons else run.message,
        }
        for run in (method.results if method.kind is not Kind.PUBLISHED else ())
    ]


def limit_records(case: Case, method: MethodSummary) -> list[Record]:
    """One record for every joint and rate of a method's representative motion."""
    verdict = method.representative.verdict if method.representative else None
    if verdict is None or method.joint is not None:
        return []
    limits = case.problem.limits.rates
    return [
        {
            "case": case.name,
            "method": method.label,
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


def segment_records(case: Case, method: MethodSummary) -> list[Record]:
    """One record for every segment of a method's representative motion."""
    if method.motion is None or method.joint is not None:
        return []
    times = method.motion.waypoint_times
    return [
        {"case": case.name, "method": method.label, "segment": k + 1, "start_s": float(a), "duration_s": float(b - a)}
        for k, (a, b) in enumerate(pairwise(times))
    ]


def write_tables(folder: Path, name: str, summaries: Sequence[CaseSummary], sources: Mapping[str, str]) -> None:
    """Write results, runs, limits and segments of some cases as CSV and Parquet.

    Parameters
    ----------
    folder : Path
    name : str
        Beginning of the file names.
    summaries : sequence of CaseSummary
    sources : mapping of str to str
        What loads a case, where that is not its name.
    """
    pairs = [(summary.case, method) for summary in summaries for method in summary.methods]
    tables = {
        "results": [
            result_record(each.case, method, sources.get(each.case.name, ""), each.best.own)
            for each in summaries
            for method in each.methods
        ],
        "runs": [record for pair in pairs for record in run_records(*pair)],
        "limits": [record for pair in pairs for record in limit_records(*pair)],
        "segments": [record for pair in pairs for record in segment_records(*pair)],
    }
    for kind, records in tables.items():
        write_table(folder / f"{name}-{kind}", records, SCHEMAS[kind])


def _float(value: float | None) -> float | None:
    return None if value is None else float(value)


RATE = 50.0
"""Samples per second of motions of seconds and minutes, Hz; `study plan` writes any other rate, and the exact polynomials."""
MOST_SAMPLES = 10_000


def motion_files(methods: Sequence[MethodSummary]) -> dict[str, str]:
    """File names for the methods that have a motion to show, by label."""
    shown = [method.label for method in methods if method.motion is not None and method.joint is None]
    return {label: f"{file_stem(label)}.csv" for label in shown}


def write_motions(folder: Path, summary: CaseSummary, files: Mapping[str, str]) -> None:
    """Write the representative motion of every method: time, positions, velocities and accelerations of all joints."""
    for method in summary.whole:
        if method.label in files and method.motion is not None:
            rate = usual_rate(method.motion.duration, RATE, MOST_SAMPLES)
            write_motion(
                method.motion,
                summary.case.problem,
                folder / files[method.label],
                Sampling(rate),
                accept_unbounded_acceleration=True,
            )
