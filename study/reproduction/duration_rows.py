"""Rule on a row of printed segment durations: does it add up, does its motion keep the limits, how do ours compare."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from study.cases.library import Case
from study.cases.printed import Cell
from study.problem import Floats
from study.reproduction import rules
from study.reproduction.forensics import wrong_sum
from study.reproduction.motion_runs import Summary, judged
from study.reproduction.rules import half_unit
from study.reproduction.verdicts import Basis, Outcome, Ruling, strongest


def size(cell: Cell) -> float:
    """Printed number of a cell, by which the papers choose the joint that takes longest."""
    return cell.value or 0.0


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
    inferred : bool
        Whether the limits are ours, read off the paper's own durations.
    """

    segments: Sequence[Cell]
    total: Cell | None
    case: Case
    joint: int | None = None
    inferred: bool = False

    @property
    def durations(self) -> Floats:
        """Printed durations, shape (n_segments,), s."""
        return np.array([cell.value for cell in self.segments])


def rule(row: Row, ours: Summary | None, fastest: float, note: str = "") -> list[tuple[Cell, Ruling]]:
    """Rule on the total of a row; its segments carry no verdict of their own.

    Parameters
    ----------
    row : Row
    ours : Summary, optional
        Our feasible runs; None where none was feasible.
    fastest : float, s
        The fastest motion on the paper's curve.
    note : str
        Put behind the fastest motion.
    """
    ruled = [(cell, _segment(ours, k)) for k, cell in enumerate(row.segments)]
    if row.total is None:
        return ruled
    compared = ruling_of(row.total.printed, ours, f"fastest on this curve {fastest:.4f} s{note}")
    return [*ruled, (row.total, strongest(added_up(row), infeasible(row, fastest), compared))]


def ruling_of(text: str, ours: Summary | None, remark: str) -> Ruling:
    """Compare a printed time with our runs."""
    if ours is None:
        return Ruling(Outcome.WORSE, "no feasible run", f"none of our runs keeps the limits; {remark}", False)
    return rules.duration(text, ours.totals, f"{ours.text}; {remark}")


def _segment(ours: Summary | None, k: int) -> Ruling:
    value = "" if ours is None else f"{ours.durations[k]:.4f} s"
    return Ruling(Outcome.PART, value, basis=Basis.NOTHING)


def added_up(row: Row) -> Ruling | None:
    """Rule that the printed total is not the sum of its segments; None if it is."""
    if row.total is None or row.total.value is None:
        return None
    decimals = max(0, round(-np.log10(2 * half_unit(row.total.printed))))
    finding = wrong_sum([float(value) for value in row.durations], row.total.value, decimals)
    return None if finding is None else rules.contradicts(finding.inequality)


def infeasible(row: Row, fastest: float) -> Ruling | None:
    """Rule that the printed motion breaks a limit, unless the rounding of its durations explains it.

    It does where half a unit more in every duration mends it and the printed total, with its own half unit, leaves room for
    the fastest motion.
    """
    verdict = judged(row.case, row.durations, row.joint)
    if verdict.feasible:
        return None
    rounding = np.array([half_unit(cell.printed) for cell in row.segments])
    total = row.total.value if row.total is not None and row.total.value else float(row.durations.sum())
    room = total + (rounding.sum() if row.total is None else half_unit(row.total.printed))
    longer = judged(row.case, row.durations + rounding, row.joint)
    if longer.feasible and room >= fastest:
        return None
    thin = f"; half a unit more in every duration keeps it ({longer.worst_ratio:.5f}), the total's own digits do not"
    why = f"{verdict.reasons[0]}; fastest on this curve {fastest:.4f} s{thin if longer.feasible else ''}"
    outcome = Outcome.EXCEEDS_INFERRED if row.inferred else Outcome.INFEASIBLE
    return Ruling(outcome, why=why + ("; the limit is inferred by us" if row.inferred else ""), basis=Basis.FORMULA)
