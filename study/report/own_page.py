"""The page of a case of one's own: its motion, its limits, files to take away, and how other planners did."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import numpy as np

from study.analysis.case_summary import CaseSummary
from study.analysis.featured import is_metaheuristic
from study.analysis.formatting import count, percent, plural, seconds, share, wall
from study.analysis.methods import Kind, MethodSummary
from study.cases.obstacles import DRIVEN
from study.judge import RATES
from study.report.case_page import CaseReport, contents_of
from study.report.filling import filled
from study.report.plot_style import Series

FORMS = {
    ".yaml": "ROS 2 JointTrajectory, for a joint_trajectory_controller",
    ".csv": "samples as a table",
    ".npz": "samples and polynomials for NumPy",
    ".exact.json": "the exact polynomial pieces",
}
"""Kinds of files of a motion, by the end of their names."""

COMPANY = 6
"""Other methods whose motions can be switched on in the profiles."""


@dataclass(frozen=True)
class OwnRow:
    """A case of one's own in a few words; empty where no motion may be driven.

    Attributes
    ----------
    method : MethodSummary, optional
        The fastest that may be driven.
    binding : str
        Limit that the motion uses most.
    driving : str
        Whether it may be driven, and what is known of collisions.
    search : str
        How the metaheuristics did.
    """

    method: MethodSummary | None
    binding: str
    driving: str
    search: str


def own_row(report: CaseReport) -> OwnRow:
    """Say the essentials of a case of one's own."""
    summary, winner = report.summary, report.summary.winner
    driving = "" if winner is None else summary.driving.get(winner.label, DRIVEN[True])
    return OwnRow(winner, _binding(summary, winner), driving, _searches(summary, winner))


def own_page(report: CaseReport, environment: Mapping[str, str], flags: Mapping[str, str]) -> str:
    """Page of a case of one's own."""
    summary, winner = report.summary, report.summary.winner
    methods = [
        method for method in summary.whole if method.motion is not None and method.feasible and method is not winner
    ]
    lead = winner or next((method for method in summary.whole if method.motion is not None), None)
    series = [
        _series(summary, method) for method in ([lead] if lead else []) + methods[:COMPANY] if method.motion is not None
    ]
    verdict = lead.representative.verdict if lead and lead.representative else None
    context = contents_of(report, series, hidden=True) | {
        "row": own_row(report),
        "lead": lead,
        "verdict": verdict,
        "files": report.trajectories,
        "flags": flags,
        "environment": environment,
    }
    return filled("own.html.j2", context)


def trajectory_files(folder: Path, slug: str) -> dict[str, str]:
    """Links from the report to the files of a motion that are there, by what they are."""
    known = {about: folder / f"{slug}{end}" for end, about in FORMS.items()}
    return {about: f"../{quote(folder.name)}/{quote(path.name)}" for about, path in known.items() if path.is_file()}


def _series(summary: CaseSummary, method: MethodSummary) -> Series:
    assert method.motion is not None  # noqa: S101 - chosen for it
    return Series(method.label, summary.slots[method.label], method.motion)


def _binding(summary: CaseSummary, method: MethodSummary | None) -> str:
    problem = summary.case.problem
    verdict = method.representative.verdict if method and method.representative else None
    if verdict is None or not np.isfinite(problem.limits.rates).any():
        return ""
    order, joint = divmod(int(np.nanargmax(verdict.ratios)), problem.n_joints)
    used, at = share(float(verdict.ratios[order, joint])), seconds(float(verdict.times[order, joint]))
    return f"{RATES[order]} of {problem.joint_names[joint]}: {used} of its limit, at {at}"


def _searches(summary: CaseSummary, winner: MethodSummary | None) -> str:
    """One sentence on the metaheuristics that ran."""
    ran = [method for method in summary.whole if method.kind is Kind.SEARCH and is_metaheuristic(method)]
    good = [method for method in ran if method.feasible]
    if not ran:
        return ""
    if not good or winner is None:
        return (
            f"No metaheuristic that ran ({', '.join(method.label for method in ran)}) found a motion within the limits."
            if not good
            else ""
        )
    best = min(good, key=lambda method: method.median or np.inf)
    if best is winner:
        return f"A metaheuristic, `{best.label}`, found this motion (median over {plural(best.runs, 'seed')})."
    behind = percent((best.median or 0.0) / (winner.median or 1.0) - 1.0)
    spent = f"median over {plural(best.runs, 'seed')}, {count(best.evaluations)} evaluations and {wall(best.wall_time)} each"
    plain = summary.best.optimiser
    same = (
        f"; on the same curve the deterministic `{plain.label}` takes {seconds(plain.median)}"
        if plain and plain.feasible
        else ""
    )
    return f"The best metaheuristic that ran, `{best.label}`, takes {seconds(best.median)}, {behind} against this motion ({spent}){same}."
