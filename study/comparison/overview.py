"""The whole comparison in sentences, and its limits."""

from __future__ import annotations

from study.analysis.formatting import listed, plural
from study.comparison.ablations import matters
from study.comparison.audit_functions import functions_audited
from study.comparison.audit_trajectories import trajectories_audited
from study.comparison.build import Comparison
from study.comparison.claims_shown import claimed_together
from study.comparison.ranking import ranking
from study.comparison.statistics import smallest_pair_p


def summary(comparison: Comparison) -> list[str]:
    """Sum up the whole comparison."""
    together = [claimed_together(comparison.claims)] if comparison.claims else []
    return [
        *together,
        *map(ranking, comparison.omnibus),
        functions_audited(comparison.audit.functions),
        trajectories_audited(comparison.audit.trajectories),
        matters(comparison.ablations),
    ]


def limitations(comparison: Comparison) -> list[str]:
    """List the limits of the comparison."""
    effort = comparison.effort
    items = [
        f"{plural(len(comparison.cases), 'case')} from five papers; what ranks high here need not elsewhere.",
        "The reference of every case is the best known on its paper's curve family with all joints together; for it no "
        "proof of optimality is given here, and methods with other curves or paths are not measured against it.",
        "Populations are recorded whole, so a target counts as reached at the end of the generation that reached it.",
        "Seconds to target spread a run's wall time evenly over its evaluations.",
        f"Wall times are of runs beside one another on all processors, Ruckig's the median of {effort.seeds} calls; they "
        "depend on the machine, and no test uses them.",
        "Errors on functions below 1e-8 count as 1e-8.",
    ]
    if effort.seeds < 20:
        items.insert(
            0,
            f"Quick mode: {effort.seeds} repetitions of every planner and {effort.trial_seeds} of every trial; a signed rank "
            f"test of as many pairs cannot give a p below {smallest_pair_p(effort.seeds):.3g} and "
            f"{smallest_pair_p(effort.trial_seeds):.3g}, before any adjustment, so that what is not significant here may well be "
            "there. Run it with --full for 30 repetitions and the papers' budgets.",
        )
    if comparison.failures:
        broken = listed([f"{name} ({count})" for name, count in sorted(comparison.failures.items())])
        items.append(f"Searches that broke down in trials, with the number of runs that ended early: {broken}.")
    return items
