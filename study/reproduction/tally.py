"""Counts of verdicts by the evidence behind them, which are never added up across kinds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from study.cases.published import main_claims
from study.reproduction.book import Entry
from study.reproduction.verdicts import CANNOT_STAND, CLAIM, Basis, Outcome

AGREEING = (Outcome.REPRODUCED, Outcome.CONSISTENT)
KEPT = (*AGREEING, Outcome.BETTER)
"""Verdicts that speak for a claim: our runs agree with it or do better."""

OPEN = (Outcome.UNDECIDED, Outcome.NOT_REPRODUCIBLE)
Counts = Mapping[Basis, Mapping[Outcome, int]]


def counted(pairs: Sequence[tuple[Basis, Outcome]]) -> Counts:
    """Count verdicts by basis and outcome, in the order of the enumerations."""
    gathered = Counter(pairs)
    return {
        basis: {outcome: gathered[basis, outcome] for outcome in Outcome if gathered[basis, outcome]}
        for basis in Basis
        if any(basis is known for known, _ in gathered)
    }


def counts_of(entries: Sequence[Entry]) -> Counts:
    """Count entries by basis and outcome."""
    return counted([(entry.ruling.basis, entry.ruling.outcome) for entry in entries])


def sentences(counts: Counts) -> list[str]:
    """Say what became of the print, one sentence for each kind of evidence."""
    said = []
    for basis, what in (
        (Basis.RUNS, "results and statements that runs of ours test"),
        (Basis.FITTED, "results and statements that runs test with constants fitted to the same table"),
        (Basis.PRINT, "numbers that other printed numbers check"),
        (Basis.FORMULA, "numbers and statements that a formula, the kinematics or the judge checks"),
    ):
        outcomes = counts.get(basis, {})
        if outcomes:
            agree = sum(outcomes.get(outcome, 0) for outcome in AGREEING)
            rest = ", ".join(f"{number} {outcome}" for outcome, number in outcomes.items() if outcome not in AGREEING)
            word = "are reproduced" if basis in (Basis.RUNS, Basis.FITTED) else "are consistent"
            said.append(f"Of {sum(outcomes.values())} {what} {agree} {word}{f'; {rest}' if rest else ''}.")
    wrong = sum(
        number for outcomes in counts.values() for outcome, number in outcomes.items() if outcome in CANNOT_STAND
    )
    return [*said, f"{wrong} printed numbers or statements cannot stand as they are printed, whatever they rest on."]


def line(entries: Sequence[Entry]) -> str:
    """Count entries in one line, kind by kind."""
    kinds = counts_of(entries).items()
    return "; ".join(
        f"{basis}: " + ", ".join(f"{n} {outcome}" for outcome, n in outcomes.items()) for basis, outcomes in kinds
    )


@dataclass(frozen=True, eq=False)
class Decided:
    """One of a paper's main claims with the entries that decide it.

    Attributes
    ----------
    claim : str
    entries : sequence of Entry
    """

    claim: str
    entries: Sequence[Entry]

    @property
    def failing(self) -> Entry | None:
        """First of the tests that speak against the claim; None where none does."""
        against = (entry for entry in self.entries if entry.ruling.outcome not in (*KEPT, *OPEN))
        return next(against, None)

    @property
    def fate(self) -> str:
        """Tell in a few words what became of the claim, what its tests rest on and how many tell nothing."""
        agreeing = [entry for entry in self.entries if entry.ruling.outcome in KEPT]
        untold = Counter(entry.ruling.outcome for entry in self.entries if entry.ruling.outcome in OPEN)
        better = sum(entry.ruling.outcome is Outcome.BETTER for entry in agreeing)
        told = len(self.entries) - untold.total()
        if not told:
            said = "is open"
        elif len(agreeing) == told:
            said = "stands"
        else:
            said = f"stands in part, by {len(agreeing)} of {told} tests" if agreeing else "does not stand"
        bases = {entry.ruling.basis for entry in agreeing}
        parts = [
            "by calculation alone, no run stands behind it" * (bool(bases) and not bases & {Basis.RUNS, Basis.FITTED}),
            f"our runs do better in {better}" * (better > 0),
            "with constants fitted to the same table" * (Basis.FITTED in bases),
            *(f"{number} {outcome}" for outcome, number in untold.items()),
        ]
        return "; ".join([said, *filter(None, parts)])


def decided(paper: str, entries: Sequence[Entry]) -> list[Decided]:
    """Put the verdicts beside a paper's main claims; a claim ruled on twice by one name stands with both."""
    prose = [entry for entry in entries if entry.place.table == CLAIM]
    gathered = []
    for main in main_claims(paper):
        names = [name.partition(" / ") for name in main.decided]
        chosen = [
            e for name, _, column in names for e in prose if e.place.row == name and column in ("", e.place.column)
        ]
        gathered.append(Decided(main.claim, chosen))
    return gathered
