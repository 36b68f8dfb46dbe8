"""The verdicts, and what a printed number gets when it has been looked at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum


class Outcome(Enum):
    """What became of a printed number."""

    REPRODUCED = "reproduced"
    BETTER = "better"
    WORSE = "worse"
    INFEASIBLE = "infeasible as published"
    IMPOSSIBLE = "impossible as printed"
    CONTRADICTS = "contradicts itself"
    NOT_REPRODUCIBLE = "cannot be reproduced"
    USED = "used as given"


RULES: dict[Outcome, str] = {
    Outcome.REPRODUCED: (
        "A result of random runs: ours lies within a factor of ten of it, or both are numerically zero. Means and extremes "
        "are measured from the function's least value where it is known. A printed total time: it lies between the fastest and the "
        "slowest feasible total of our seeds, or within 1e-3 of our median. Anything else: ours differs by at most 1e-3 of it, "
        "or by no more than its last digit can say. A count of generations: within a factor of 1.5. A statement about an "
        "order: our runs have the same order, and where two samples are compared the rank-sum test gives p < 0.05."
    ),
    Outcome.BETTER: (
        "Outside that range on the good side: a smaller error or scatter, or a shorter motion that keeps every limit. It "
        "ranks our run of the method against the print, and says nothing of what the authors could have reached."
    ),
    Outcome.WORSE: "Outside that range on the bad side; a statement about an order that our runs do not confirm.",
    Outcome.INFEASIBLE: (
        "The judge finds that the printed durations break a limit by more than 1e-6 and by more than their rounding explains, "
        "or the printed time is shorter than the fastest motion on the paper's curve. Single segments share their row's "
        "verdict."
    ),
    Outcome.IMPOSSIBLE: (
        "No runs could give this number: an inequality of arithmetic fails, and stands beside it with its numbers. All "
        "printed digits are allowed half a unit of the last one."
    ),
    Outcome.CONTRADICTS: (
        "Another printed number, or arithmetic on printed numbers (a sum, a percentage, a conversion), says otherwise."
    ),
    Outcome.NOT_REPRODUCIBLE: "The paper does not say what would be needed; what is missing stands beside it.",
    Outcome.USED: "An input: waypoints, limits, settings. Our runs use it as printed, and nothing contradicts it.",
}
"""The stated rule of every verdict. Where several hold, the first of: impossible, contradicts, infeasible, the others."""

PRECEDENCE = (Outcome.IMPOSSIBLE, Outcome.CONTRADICTS, Outcome.INFEASIBLE)


@dataclass(frozen=True)
class Ruling:
    """A verdict with its reason.

    Attributes
    ----------
    outcome : Outcome
    ours : str
        Our number as text; empty where there is none.
    why : str
        One sentence, or the inequality that fails.
    agrees : bool, optional
        Whether our number meets the rule for `reproduced`, whatever else is wrong with the print.
    reading : str
        Under which reading ours was made.
    others : mapping of str to str
        Our number under the other readings.
    """

    outcome: Outcome
    ours: str = ""
    why: str = ""
    agrees: bool | None = None
    reading: str = ""
    others: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Place:
    """Where a number stands: a table's cell, or a claim in the prose (whose column is empty)."""

    table: str
    row: str
    column: str = ""


Rulings = dict[Place, "Ruling"]

CLAIM = "prose"
"""The `table` of places in the prose; the row is then the claim's id."""


def claim(identity: str) -> Place:
    """Place of a claim."""
    return Place(CLAIM, identity)


def used(why: str = "") -> Ruling:
    """Rule that an input is used as given."""
    return Ruling(Outcome.USED, why=why)


def missing(why: str, ours: str = "") -> Ruling:
    """Rule that the paper leaves out what would be needed."""
    return Ruling(Outcome.NOT_REPRODUCIBLE, ours, why)


def strongest(*rulings: Ruling | None) -> Ruling:
    """Choose among several rulings on one number by the stated precedence, and keep our number beside it.

    Parameters
    ----------
    rulings : Ruling or None
        The comparison last, so that its number is kept.
    """
    found = [ruling for ruling in rulings if ruling is not None]
    for outcome in PRECEDENCE:
        for ruling in found:
            if ruling.outcome is outcome:
                last = found[-1]
                return Ruling(outcome, ruling.ours or last.ours, ruling.why, last.agrees, last.reading, last.others)
    return found[-1]
