"""The tables of the report: one list of columns each for the page, CSV and Parquet."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

from study.analysis.case_summary import CaseSummary
from study.analysis.featured import group_of
from study.analysis.formatting import DASH, bare_seconds, count, percent, share, wall
from study.analysis.methods import Kind, MethodSummary
from study.analysis.tables import Column, records, write_table
from study.cases.library import Case
from study.io.export import write_motion
from study.io.filenames import file_stem
from study.io.sampling import Sampling, usual_rate
from study.judge import RATES, Verdict
from study.runs.lineup import QUICK_EVALUATIONS, TIME_LIMIT
from study.store.results import Result

Method = tuple[CaseSummary, MethodSummary, str]
"""A method of a case, and what loads the case again: its name or the path of a case of one's own."""


def _plain(value: object) -> str:
    return DASH if value in (None, "") else str(value)


RESULTS: tuple[Column[Method], ...] = (
    Column("case", "", lambda row: row[0].case.name, kind=str),
    Column("rank", "#", lambda row: row[1].rank, _plain, int, "place among feasible methods, by median time"),
    Column(
        "method",
        "Method",
        lambda row: row[1].label,
        kind=str,
        hint="planner and, after a colon, what is done otherwise than is usual for the case",
    ),
    Column(
        "median_s",
        "Median, s",
        lambda row: row[1].duration,
        bare_seconds,
        float,
        "what one run brings: median time over the feasible runs; of an infeasible method the time of its motion",
    ),
    Column(
        "best_s",
        "Best, s",
        lambda row: row[1].best,
        bare_seconds,
        float,
        "the luckiest seed: shortest time of a feasible run",
    ),
    Column(
        "gap",
        "Gap",
        lambda row: row[1].gap,
        percent,
        float,
        "median above the shortest feasible time known here, on whatever path",
    ),
    Column(
        "behind_same_kind",
        "Behind its kind",
        lambda row: row[1].behind_same_kind,
        percent,
        float,
        "median above the shortest feasible time known here for the same kind of path",
    ),
    Column(
        "above_bound",
        "Above bound",
        lambda row: row[1].above_bound,
        percent,
        float,
        "median above the proved lower bound of any motion through the waypoints",
    ),
    Column(
        "path", "Path", lambda row: row[1].freedom or "", _plain, str, "what the method was free to change, see below"
    ),
    Column(
        "feasible",
        "Feasible",
        lambda row: f"{row[1].feasible_runs}/{row[1].runs}",
        kind=str,
        hint="runs that passed the judge, of all runs: one for each seed",
    ),
    Column("runs", "", lambda row: row[1].runs, kind=int),
    Column("feasible_runs", "", lambda row: row[1].feasible_runs, kind=int),
    Column(
        "worst_ratio",
        "Limit use",
        lambda row: row[1].worst_ratio,
        share,
        float,
        "largest peak over its limit; above 1 a limit is broken",
    ),
    Column(
        "evaluations",
        "Evals",
        lambda row: row[1].evaluations or None,
        count,
        int,
        "curve evaluations of a run, median over runs; of one joint each where every joint is searched alone",
    ),
    Column(
        "wall_s",
        "Wall",
        lambda row: row[1].wall_time or None,
        wall,
        float,
        "computing time of a run, median over runs",
    ),
    Column(
        "group",
        "Kind",
        lambda row: group_of(row[1], row[0].best.own),
        kind=str,
        hint="searches, which need a seed, by where they come from: the case's own paper, the papers, or no paper (modern); "
        "deterministic; published",
    ),
    Column("kind", "", lambda row: row[1].kind, kind=str),
    Column("claimed_s", "", lambda row: row[1].claimed, kind=float),
    Column("reason", "", lambda row: row[1].reason, kind=str),
    Column("driving", "", lambda row: row[0].driving.get(row[1].label, ""), kind=str),
    Column("command", "", lambda row: command(row[0].case, *row[1:]), kind=str),
)
COLUMNS = tuple(column for column in RESULTS if column.head)
"""Columns of the results on the page."""

Run = tuple[Case, MethodSummary, Result]
RUNS: tuple[Column[Run], ...] = (
    Column("case", "", lambda row: row[0].name, kind=str),
    Column("method", "", lambda row: row[1].label, kind=str),
    Column("seed", "", lambda row: row[2].cell.settings.seed, kind=int),
    Column("status", "", lambda row: row[2].status.value, kind=str),
    Column("duration_s", "", lambda row: row[2].verdict and row[2].verdict.duration, kind=float),
    Column("feasible", "", lambda row: row[2].feasible, kind=bool),
    Column("worst_ratio", "", lambda row: row[2].verdict and row[2].verdict.worst_ratio, kind=float),
    Column("waypoint_error", "", lambda row: row[2].verdict and row[2].verdict.waypoint_error.max(), kind=float),
    Column("continuity", "", lambda row: row[2].verdict and row[2].verdict.continuity, kind=int),
    Column("evaluations", "", lambda row: row[2].evaluations, kind=int),
    Column("iterations", "", lambda row: row[2].iterations, kind=int),
    Column("wall_s", "", lambda row: row[2].wall_time, kind=float),
    Column("message", "", lambda row: _message(row[2]), kind=str),
)

Rate = tuple[Case, MethodSummary, Verdict, int, int]
"""Verdict on a method's representative motion, with the numbers of a rate and of a joint."""

LIMITS: tuple[Column[Rate], ...] = (
    Column("case", "", lambda row: row[0].name, kind=str),
    Column("method", "", lambda row: row[1].label, kind=str),
    Column("joint", "", lambda row: row[0].problem.joint_names[row[4]], kind=str),
    Column("rate", "", lambda row: RATES[row[3]], kind=str),
    Column("peak", "", lambda row: row[2].peaks[row[3:]], kind=float),
    Column("limit", "", lambda row: row[0].problem.limits.rates[row[3:]], kind=float),
    Column("ratio", "", lambda row: row[2].ratios[row[3:]], kind=float),
    Column("at_s", "", lambda row: row[2].times[row[3:]], kind=float),
    Column("segment", "", lambda row: row[2].segments[row[3:]] + 1, kind=int),
)

Segment = tuple[Case, MethodSummary, int, float, float]
"""Number of a segment of a method's representative motion, counted from 0, with its start and end, s."""

SEGMENTS: tuple[Column[Segment], ...] = (
    Column("case", "", lambda row: row[0].name, kind=str),
    Column("method", "", lambda row: row[1].label, kind=str),
    Column("segment", "", lambda row: row[2] + 1, kind=int),
    Column("start_s", "", lambda row: row[3], kind=float),
    Column("duration_s", "", lambda row: row[4] - row[3], kind=float),
)


def _message(run: Result) -> str:
    return "; ".join(run.verdict.reasons) if run.verdict and run.verdict.reasons else run.message


def _rates(case: Case, method: MethodSummary) -> Iterator[Rate]:
    verdict = method.representative.verdict if method.representative else None
    if verdict is not None and method.joint is None:
        for order in range(len(RATES)):
            yield from ((case, method, verdict, order, joint) for joint in range(case.problem.n_joints))


def _segments(case: Case, method: MethodSummary) -> Iterator[Segment]:
    if method.motion is not None and method.joint is None:
        yield from ((case, method, k, *ends) for k, ends in enumerate(pairwise(method.motion.waypoint_times)))


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
    runs = [(*pair, run) for pair in pairs if pair[1].kind is not Kind.PUBLISHED for run in pair[1].results]
    tables: dict[str, tuple[Sequence[Column[Any]], Iterable[Any]]] = {
        "results": (RESULTS, [(each, m, sources.get(each.case.name, "")) for each in summaries for m in each.methods]),
        "runs": (RUNS, runs),
        "limits": (LIMITS, chain.from_iterable(_rates(*pair) for pair in pairs)),
        "segments": (SEGMENTS, chain.from_iterable(_segments(*pair) for pair in pairs)),
    }
    for kind, (columns, rows) in tables.items():
        write_table(folder / f"{name}-{kind}", records(columns, rows), columns)


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
