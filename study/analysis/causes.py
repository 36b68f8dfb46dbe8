"""Where the time goes: the ladder of a case summed up by cause, for a table of all cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from study.analysis.ladder import Rung
from study.analysis.methods import CURVE, FIXED_PATH, FREE_PATH


@dataclass(frozen=True)
class Causes:
    """What each kind of step of one ladder gains; negative is less time, None is a kind that it does not have.

    Attributes
    ----------
    first, last : Rung
        Where the ladder begins and ends on the case's curve; the gains on the curve lead from one to the other.
    optimiser, rule : float, optional, s
        Sum over the rungs that change how durations are searched for, and how joints are synchronised.
    fixed, free : float, optional, s
        Largest gain off the curve, against `last`.
    bound : float, optional, s
        What no motion through the waypoints undercuts.
    """

    first: Rung
    last: Rung
    optimiser: float | None
    rule: float | None
    fixed: float | None
    free: float | None
    bound: float | None


def causes_of(rungs: Sequence[Rung]) -> Causes | None:
    """Sum a ladder up; None without two rungs on the curve."""
    on_curve = [rung for rung in rungs if rung.path == CURVE]
    if len(on_curve) < 2:
        return None
    return Causes(
        first=on_curve[0],
        last=on_curve[-1],
        optimiser=_sum(on_curve[1:], "optimiser"),
        rule=_sum(on_curve[1:], "synchronisation rule"),
        fixed=_most(rungs, FIXED_PATH),
        free=_most(rungs, FREE_PATH),
        bound=next((rung.seconds for rung in rungs if not rung.path), None),
    )


def _sum(rungs: Sequence[Rung], kind: str) -> float | None:
    changes = [rung.change or 0.0 for rung in rungs if rung.cause.startswith(kind)]
    return sum(changes) if changes else None


def _most(rungs: Sequence[Rung], path: str) -> float | None:
    changes = [rung.change for rung in rungs if rung.path == path and rung.feasible and rung.change is not None]
    return min(changes, default=None)
