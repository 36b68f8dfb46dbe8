"""Findings as flat records, and their CSV and Parquet files."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pcsv
import pyarrow.parquet as pq

from study.comparison.ablations import AblationFinding
from study.comparison.audit import FunctionFinding, TrajectoryFinding
from study.comparison.claims import Against, Counterpart
from study.comparison.contestants import Contestant
from study.comparison.differences import Omnibus, Pairing
from study.comparison.performance import Performance
from study.comparison.runtime import TARGETS
from study.comparison.statistics import Interval

Record = dict[str, object]


def target_name(target: float) -> str:
    """Name a target as a column does."""
    return f"{100 * target:g} %"


def run_records(found: Sequence[Contestant], flags: Mapping[str, str]) -> list[Record]:
    """One record for every run; the seed is its place."""
    return [
        {
            "level": one.level,
            "case": one.case,
            "planner": one.planner,
            "flag": flags.get(one.planner, ""),
            "seed": seed,
            "duration_s": _finite(one.durations[seed]),
            "feasible": bool(np.isfinite(one.durations[seed])),
            "evaluations": int(one.spent[seed]),
            "wall_s": float(one.wall[seed]),
        }
        for one in found
        for seed in range(len(one.durations))
    ]


def performance_records(found: Sequence[Performance], flags: Mapping[str, str]) -> list[Record]:
    """One record for every contestant and target."""
    return [
        {
            "level": one.contestant.level,
            "case": one.contestant.case,
            "planner": one.contestant.planner,
            "flag": flags.get(one.contestant.planner, ""),
            "median_gap": _finite(one.gap),
            "best_gap": _finite(one.best_gap),
            "runs": len(one.contestant.durations),
            "feasible_runs": one.feasible,
            "median_wall_s": float(np.median(one.contestant.wall)),
            "target": target_name(target),
            "reached": float(one.reached[k]),
            "average_evaluations": _finite(one.evaluations[k]),
            "average_seconds": _finite(one.seconds[k]),
        }
        for one in found
        for k, target in enumerate(TARGETS)
    ]


def pairing_records(found: Sequence[Pairing], flags: Mapping[str, str]) -> list[Record]:
    """One record for every planner and control on every case."""
    return [
        {
            "level": one.level,
            "case": one.case,
            "planner": one.planner,
            "flag": flags.get(one.planner, ""),
            "control": one.control,
            "a12": one.a12,
            **_interval("difference", one.difference),
            "signed_rank_p_holm": one.signed_rank,
            "rank_sum_p_holm": one.rank_sum,
        }
        for one in found
    ]


def rank_records(found: Sequence[Omnibus], flags: Mapping[str, str]) -> list[Record]:
    """One record for every planner of every omnibus test."""
    return [
        {
            "level": one.level,
            "planner": name,
            "flag": flags.get(name, ""),
            "mean_rank": float(one.friedman.mean_ranks[i]),
            "control": one.control,
            "p_against_control_holm": float(one.against_control[i]),
            "friedman_p": one.friedman.p,
            "critical_difference": one.difference,
        }
        for one in found
        for i, name in enumerate(one.planners)
    ]


def audit_records(found: Sequence[FunctionFinding], flags: Mapping[str, str]) -> list[Record]:
    """One record for every search on the functions."""
    return [
        {
            "search": one.search,
            "flag": flags.get(one.search, ""),
            "ratio_shifted": one.shifted,
            "ratio_rotated": one.rotated,
            "ratio_diagonal": one.diagonal,
            **{f"ratio {name}": value for name, value in one.doses.items()},
            **{f"ratio_shifted {name}": value for name, value in one.by_function.items()},
        }
        for one in found
    ]


def view_records(found: Sequence[TrajectoryFinding], flags: Mapping[str, str]) -> list[Record]:
    """One record for every search, case, formulation and view."""
    return [
        {
            "search": one.search,
            "flag": flags.get(one.search, ""),
            "case": one.case,
            "formulation": one.formulation,
            "view": one.view,
            "median_as_they_are_s": _finite(one.as_they_are),
            "median_seen_s": _finite(one.seen),
            "a12": one.a12,
            "rank_sum_p_holm": one.p,
            "depends": one.depends,
        }
        for one in found
    ]


def ablation_records(found: Sequence[AblationFinding]) -> list[Record]:
    """One record for every improvement on every task."""
    return [
        {
            "paper": one.paper,
            "improvement": one.improvement,
            "task": one.task,
            "view": one.view,
            "kind": "trajectory" if one.trajectory else "function",
            "plain_median": _finite(one.plain),
            "improved_median": _finite(one.improved),
            "a12": one.a12,
            **_interval("difference", one.difference),
            "difference_unit": "share of the plain median" if one.trajectory else "decades of error",
            "signed_rank_p_holm": one.p,
            "effect": one.effect,
        }
        for one in found
    ]


def claim_records(found: Sequence[Counterpart], flags: Mapping[str, str]) -> list[Record]:
    """One record for every headline claim."""
    return [
        {
            "paper": one.headline.paper,
            "case": one.headline.case,
            "planner": one.planner,
            "flag": flags.get(one.planner, ""),
            "printed_saving": one.printed_saving,
            "against": one.headline.against,
            "printed_total_s": one.total,
            "published_feasible": one.published_feasible,
            "our_median_s": _finite(one.our_total),
            "our_feasible_runs": one.feasible,
            "our_runs": len(one.ours.durations),
            "baseline": one.headline.baseline,
            **_against("baseline", one.against_baseline),
            **_against("random", one.against_random),
            "optimum_s": one.reference.value,
            "above_optimum": _finite(one.above_optimum),
            "printed_above_optimum": one.printed_above_optimum,
            "wall_s": float(np.median(one.ours.wall)),
            "ruckig_s": _finite(one.ruckig.median) if one.ruckig else None,
            "ruckig_wall_s": float(np.median(one.ruckig.wall)) if one.ruckig else None,
        }
        for one in found
    ]


def _interval(name: str, found: Interval | None) -> Record:
    ends = (found.estimate, found.lower, found.upper) if found else (None, None, None)
    return dict(zip((name, f"{name}_low", f"{name}_high"), ends, strict=True))


def _against(name: str, found: Against) -> Record:
    difference = _interval(f"difference_against_{name}", found.difference)
    return difference | {f"a12_against_{name}": found.a12, f"signed_rank_p_holm_against_{name}": found.p}


def write_tables(folder: Path, tables: Mapping[str, Sequence[Record]]) -> None:
    """Write every table as CSV and Parquet into a folder that exists."""
    for name, records in tables.items():
        table = pa.Table.from_pylist(list(records))
        pcsv.write_csv(table, folder / f"{name}.csv")
        pq.write_table(table, folder / f"{name}.parquet")


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None
