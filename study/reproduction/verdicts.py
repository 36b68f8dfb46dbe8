"""Verdicts on printed numbers and statements, and the evidence that each of them rests on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from study.choices import Choice


class Basis(Choice):
    """Evidence behind a verdict; counts of different kinds are never added."""

    RUNS = "runs"
    FITTED = "fitted"
    PRINT = "consistent in print"
    FORMULA = "formula or kinematics"
    INPUT = "input taken as given"
    NOTHING = "nothing to compare"


BASES: dict[Basis, str] = {
    Basis.RUNS: "our own runs of the method, with constants that were not chosen on the table they are compared with",
    Basis.FITTED: (
        "our own runs with constants that were chosen because they fit this very table: such constants exist, which is "
        "no sign that the authors used them; the cited algorithm stands beside with its own count"
    ),
    Basis.PRINT: (
        "arithmetic on printed numbers alone: sums, reductions, conversions, inequalities; no run stands behind it"
    ),
    Basis.FORMULA: (
        "a formula of the paper, its arm's kinematics or the judge, computed anew; no search stands behind it"
    ),
    Basis.INPUT: "nothing is tested: our runs take the number over, or the reason says where they do not",
    Basis.NOTHING: "what would be needed for a comparison is not printed",
}


class Outcome(Choice):
    """Verdict on a printed number or statement."""

    REPRODUCED = "reproduced"
    SAME_ORDER = "same order of magnitude"
    CONSISTENT = "consistent"
    BETTER = "better"
    WORSE = "worse"
    NOT_CONFIRMED = "not confirmed"
    UNDECIDED = "undecided"
    INFEASIBLE = "infeasible as published"
    EXCEEDS_INFERRED = "exceeds the inferred limit"
    IMPOSSIBLE = "impossible as printed"
    CONTRADICTS = "contradicts itself"
    NOT_REPRODUCIBLE = "cannot be reproduced"
    USED = "used as given"
    PART = "part of its row"


RULES: dict[Outcome, str] = {
    Outcome.REPRODUCED: (
        "Our runs agree. A benchmark mean, deviation or extreme: it lies in the middle 95 % of the same "
        "statistic of as many "
        "runs as the paper made, drawn again and again from ours, and within a factor of ten of ours; or "
        "both are numerically "
        "zero, which means below 1e-162, where squares are no longer doubles; or they are closer than the values of the "
        "function lie in double precision near its least one. A "
        "time: within 0.1 % of our median, or in the middle 90 % of our runs (of means or bests of as "
        "many runs where the "
        "paper prints those) and within 5 % of its middle. A reduction in per cent: within one point of "
        "ours, and by the "
        "rank-sum test where it is a reduction against another search. A count of generations: at one of the four "
        "definitions of convergence it keeps what the paper says (`within` and `at least` to the letter, "
        "`about` within a "
        "quarter). A statement about an order: the rank-sum test gives p < 0.05 in every comparison; a rank: "
        "among the places that ties leave open."
    ),
    Outcome.SAME_ORDER: "A benchmark result outside that range, but within a factor of ten of ours.",
    Outcome.CONSISTENT: (
        "Other printed numbers, or a formula or the kinematics of the paper, give the same to half a unit "
        "of the last digit, or "
        "its digits are cut off there instead of rounded; with `about`, `nearly` and the like, within 5 %."
    ),
    Outcome.BETTER: (
        "Outside every range above on the good side: a smaller error or scatter, or a shorter motion that "
        "keeps every limit. It "
        "ranks our run of the method against the print, and says nothing of what the authors could have reached."
    ),
    Outcome.WORSE: "Outside every range above on the bad side.",
    Outcome.NOT_CONFIRMED: "A statement or a count that our runs, or the paper's own formula, do not bear out.",
    Outcome.UNDECIDED: (
        "Our runs cannot tell: fewer than ten on a side and no significant difference, a scatter wider than 5 %, or a "
        "search that had not arrived when its budget ended."
    ),
    Outcome.INFEASIBLE: (
        "The judge finds that the printed durations break a printed limit by more than 1e-6 and by more "
        "than their rounding "
        "explains, or the printed time is shorter than the fastest motion on the paper's curve."
    ),
    Outcome.EXCEEDS_INFERRED: (
        "The same, where the limit is not printed but inferred by us from the paper's own durations. It "
        "is no fault of the "
        "print and stands in no headline count."
    ),
    Outcome.IMPOSSIBLE: (
        "No runs could give this number: an inequality of arithmetic fails, and stands beside it with its numbers. All "
        "printed digits are allowed half a unit of the last one."
    ),
    Outcome.CONTRADICTS: (
        "Another printed number, or arithmetic on printed numbers (a sum, a percentage, a conversion), says otherwise."
    ),
    Outcome.NOT_REPRODUCIBLE: "The paper does not say what would be needed; what is missing stands beside it.",
    Outcome.USED: "An input: waypoints, limits, settings. Nothing is tested.",
    Outcome.PART: (
        "One segment of a row of durations, neither better nor worse by itself: the verdict stands at the row's sum."
    ),
}
"""Stated rule of every verdict; where several hold, the first of: impossible, contradicts, infeasible, the others."""

CONVERGENCE = (
    "A run has converged, at x, in the first generation after which its best value stays within x of its whole descent "
    "(first feasible value minus last) of its last value. The papers read figures and define nothing, "
    "so x = 0.1, 1, 2 and 5 % "
    "stand side by side, in this order, from exact generations; a `≥` marks medians of runs that "
    "still descended in the last "
    "twentieth of their budget."
)

PRECEDENCE = (Outcome.IMPOSSIBLE, Outcome.CONTRADICTS, Outcome.INFEASIBLE, Outcome.EXCEEDS_INFERRED)

CANNOT_STAND = (Outcome.IMPOSSIBLE, Outcome.CONTRADICTS, Outcome.INFEASIBLE)
"""Verdicts that the print itself earns; the headline counts them together."""


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
        Whether our number agrees, whatever else is wrong with the print.
    reading : str
        Under which reading ours was made.
    others : mapping of str to str
        Our number under the other readings.
    basis : Basis
        What the verdict rests on.
    spread : str
        Range of our runs.
    """

    outcome: Outcome
    ours: str = ""
    why: str = ""
    agrees: bool | None = None
    reading: str = ""
    others: Mapping[str, str] = field(default_factory=dict)
    basis: Basis = Basis.RUNS
    spread: str = ""

    def beside(self, others: Mapping[str, str]) -> Ruling:
        """Put our numbers under other readings beside it."""
        return replace(self, others=others)


@dataclass(frozen=True)
class Place:
    """Place of a number: a table's cell, or a claim in the prose.

    Attributes
    ----------
    table, row : str
        Of a claim `prose` and its id.
    column : str
        Of a claim that is ruled on twice `in print` or `by runs`; otherwise empty.
    """

    table: str
    row: str
    column: str = ""


Rulings = dict[Place, Ruling]

CLAIM = "prose"
"""The `table` of places in the prose; the row is then the claim's id."""

IN_PRINT, BY_RUNS = "in print", "by runs"
"""Columns of a claim that arithmetic and our runs both rule on."""


def claim(identity: str, column: str = "") -> Place:
    """Place of a claim."""
    return Place(CLAIM, identity, column)


def used(why: str = "") -> Ruling:
    """Rule that an input is used as given."""
    return Ruling(Outcome.USED, why=why, basis=Basis.INPUT)


def missing(why: str, ours: str = "") -> Ruling:
    """Rule that the paper leaves out what would be needed."""
    return Ruling(Outcome.NOT_REPRODUCIBLE, ours, why, basis=Basis.NOTHING)


def strongest(*rulings: Ruling | None) -> Ruling:
    """Choose among several rulings on one number by the stated precedence, and keep our number beside it.

    Parameters
    ----------
    rulings : Ruling or None
        The comparison last, so that its number is kept.
    """
    given = [ruling for ruling in rulings if ruling is not None]
    last = given[-1]
    for outcome in PRECEDENCE:
        for ruling in given:
            if ruling.outcome is outcome:
                return replace(last, outcome=outcome, ours=ruling.ours or last.ours, why=ruling.why, basis=ruling.basis)
    return last
