"""Remark on a motion that starts or ends with a step of velocity or acceleration, for the place beside its time."""

from __future__ import annotations

from functools import cache

import numpy as np

from study.analysis.case_summary import CaseSummary
from study.analysis.formatting import listed
from study.cases.library import Case, case_names, load_case
from study.judge import RATES
from study.problem import EndCondition
from study.trajectory import Motion

STEP = 1e-3
"""Share of a limit from which a rate at an end counts as a step."""


def end_steps(summary: CaseSummary) -> str:
    """Say with what rate the optimum on the curve starts and ends; empty where it rests, or where there is none."""
    case, optimiser = summary.case, summary.best.optimiser
    if optimiser is None or not optimiser.feasible or optimiser.motion is None:
        return ""
    motion = optimiser.motion
    steps = [
        f"{verb} {text}"
        for verb, time in (("starts", 0.0), ("ends", motion.duration))
        if (text := _step(case, motion, time))
    ]
    if not steps:
        return ""
    smooth = _smooth_variant(case.name)
    aside = f" `{smooth}` is the same case with zero acceleration at both ends." if smooth else ""
    return (
        f"‡ {case.name}: on the paper's curve a motion may step at its ends, and all methods in this row may use that; the "
        f"optimum {listed(steps)}.{aside}"
    )


def _step(case: Case, motion: Motion, time: float) -> str:
    """Largest of the lowest rates that are not zero at an instant, as a share of its limit."""
    limits = case.problem.limits.rates
    for order in (1, 2):
        values = motion(np.array([time]), order)[0]
        shares = np.abs(values) / limits[order - 1]
        joint = int(np.argmax(shares))
        if shares[joint] > STEP:
            unit = case.units[joint] + ("/s", "/s²")[order - 1]
            number = f"{values[joint]:.4g}".replace("-", "−")
            name = case.problem.joint_names[joint]
            return f"{name} at once with {RATES[order - 1]} {number} {unit} ({100 * shares[joint]:.3g} % of its limit)"
    return ""


@cache
def _smooth_variant(name: str) -> str:
    """Variant of a case that differs by rest in acceleration at both ends."""
    variants = [case for case in map(load_case, case_names()) if case.variant_of == name]
    return next((case.name for case in variants if case.problem.end is EndCondition.SMOOTH), "")
