"""Outcomes of trials, put together for the audit and the ablations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from study.comparison.trials import Trial, TrialOutcome

FLOOR = 1e-8
"""Errors below it count as it, so that a ratio of two numbers that are both as good as zero is 1."""

SIGNIFICANT = 0.05
Outcomes = Mapping[Trial, TrialOutcome]


def grouped(outcomes: Outcomes) -> dict[tuple[str, str, str, str], np.ndarray]:
    """Values by (search, task, formulation, view), in the order of the seeds."""
    values: dict[tuple[str, str, str, str], list[float]] = {}
    for trial in sorted(outcomes, key=lambda trial: trial.seed):
        values.setdefault((trial.search, trial.task, trial.formulation, trial.view), []).append(outcomes[trial].value)
    return {key: np.array(group) for key, group in values.items()}


def failures(outcomes: Iterable[Outcomes]) -> dict[str, int]:
    """Searches that broke down in trials, and how often."""
    counts: dict[str, int] = {}
    for part in outcomes:
        for trial, end in part.items():
            if end.reason:
                counts[trial.search] = counts.get(trial.search, 0) + 1
    return counts
