"""The invariance audit: its searches, its findings on functions and trajectory problems, and the flags they raise."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from study.analysis.formatting import ratio
from study.comparison.audit_functions import ALARM, PRINTED, FunctionFinding, function_findings
from study.comparison.audit_trajectories import TrajectoryFinding, trajectory_findings
from study.comparison.outcomes import Outcomes
from study.planners.segment_times import SegmentTimePlanner
from study.registry import planner_named, planner_names, unavailable_planners
from study.search.state import Search


@dataclass(frozen=True)
class Audit:
    """Findings of the audit; `flags` names the searches whose result depends on the view, and why."""

    functions: Sequence[FunctionFinding]
    trajectories: Sequence[TrajectoryFinding]
    flags: Mapping[str, str]


def audit_of(functions: Outcomes, trajectories: Outcomes) -> Audit:
    """Judge the searches by the outcomes of their trials."""
    on_functions, on_trajectories = function_findings(functions), trajectory_findings(trajectories)
    return Audit(on_functions, on_trajectories, flags_of(on_functions, on_trajectories))


def audited_searches(printed: bool) -> dict[str, Search[Any]]:
    """Searches of all installed segment-time planners, by planner name; as-printed readings only if asked for."""
    broken = unavailable_planners()
    planners = {name: planner_named(name) for name in planner_names() if name not in broken}
    return {
        name: planner.search
        for name, planner in planners.items()
        if isinstance(planner, SegmentTimePlanner) and (printed or not name.endswith(PRINTED))
    }


def flags_of(functions: Iterable[FunctionFinding], trajectories: Iterable[TrajectoryFinding]) -> dict[str, str]:
    """Name every search whose result depends on the view, with the reasons."""
    reasons: dict[str, list[str]] = {}
    for finding in functions:
        tested = (
            ("the optimum leaves the origin", finding.shifted),
            ("the optimum leaves the diagonal", finding.diagonal),
        )
        for event, growth in tested:
            if growth > ALARM:
                text = f"on functions its error grows {ratio(growth)}-fold when {event}"
                reasons.setdefault(finding.search, []).append(text)
    cases: dict[str, set[str]] = {}
    for seen in trajectories:
        if seen.depends:
            cases.setdefault(seen.search, set()).add(seen.case)
    for name, several in cases.items():
        text = f"on {', '.join(sorted(several))} its result depends on how the durations are written"
        reasons.setdefault(name, []).append(text)
    return {name: "; ".join(texts) for name, texts in reasons.items()}
