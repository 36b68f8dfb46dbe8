"""Rule on a row of printed segment durations: does it add up, does its motion keep the limits, how do ours compare."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from study.experiment.cases import Case
from study.experiment.published import Cell
from study.forensics import wrong_sum
from study.problem import Floats
from study.reproduction import rules
from study.reproduction.motion_runs import Summary, judged
from study.reproduction.rules import half_unit
from study.reproduction.verdicts import Outcome, Ruling, strongest


@dataclass(frozen=True, eq=False)
class Row:
    """A printed row of durations.

    Attributes
    ----------
    segments : sequence of Cell
    total : Cell, optional
    case : Case
    joint : int, optional
        Counted from 0, where the row is of one joint.
    """

    segments: Sequence[Cell]
    total: Cell | None
    case: Case
    joint: int | None = None

    @property
    def durations(self) -> Floats:
        """Printed durations, shape (n_segments,), s."""
        return np.array([cell.value for cell in self.segments])


def rule(row: Row, ours: Summary | None, remark: str = "") -> list[tuple[Cell, Ruling]]:
    """Rule on every cell of a row.

    Parameters
    ----------
    row : Row
    ours : Summary, optional
        Our feasible runs; None where none was feasible.
    remark : str
        Put behind the reason, such as what the fastest motion is.
    """
    broken = infeasible(row)
    printed_total = (
        row.total.value if row.total is not None and row.total.value is not None else float(row.durations.sum())
    )
    text = row.total.printed if row.total is not None else f"{printed_total:.4f}"
    if ours is None:
        compared = Ruling(Outcome.WORSE, "no feasible run", "none of our runs keeps the limits", False)
    else:
        why = "; ".join(filter(None, (ours.text, remark)))
        compared = rules.duration(text, ours.total, why, (ours.best, ours.totals[-1]))
    found = []
    for k, cell in enumerate(row.segments):
        value = "" if ours is None else f"{ours.durations[k]:.4f} s"
        found.append((cell, strongest(broken, _segment(compared, value))))
    if row.total is not None:
        found.append((row.total, strongest(added_up(row), broken, compared)))
    return found


def _segment(compared: Ruling, value: str) -> Ruling:
    return Ruling(
        compared.outcome, value, "its row's verdict: a segment by itself is neither better nor worse", compared.agrees
    )


def added_up(row: Row) -> Ruling | None:
    """Rule that the printed total is not the sum of its segments; None if it is."""
    if row.total is None or row.total.value is None:
        return None
    decimals = max(0, round(-np.log10(2 * half_unit(row.segments[0].printed))))
    finding = wrong_sum([float(value) for value in row.durations], row.total.value, decimals)
    return finding and rules.contradicts(finding.inequality)


def infeasible(row: Row) -> Ruling | None:
    """Rule that the printed motion breaks a limit, unless adding half a unit to every duration mends it."""
    verdict = judged(row.case, row.durations, row.joint)
    if verdict.feasible:
        return None
    longer = row.durations + np.array([half_unit(cell.printed) for cell in row.segments])
    if judged(row.case, longer, row.joint).feasible:
        return None
    return Ruling(Outcome.INFEASIBLE, why=verdict.reasons[0])
