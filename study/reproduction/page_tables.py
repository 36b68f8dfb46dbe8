"""Printed tables, reasons and readings as the pages show them: only exceptions marked, equal reasons said once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from study.cases.printed import Table
from study.reproduction.book import Entry
from study.reproduction.verdicts import Basis, Outcome

NAMED = 6
"""Places that stand with a reason by name."""

WIDE = 7
"""Columns above which a table with fewer rows than columns is turned, so that it fits the page."""


@dataclass(frozen=True, eq=False)
class Reason:
    """One reason and everything that it holds for.

    Attributes
    ----------
    outcome : Outcome
    basis : Basis
    why : str
    places : str
    count : int
    """

    outcome: Outcome
    basis: Basis
    why: str
    places: str
    count: int


@dataclass(frozen=True, eq=False)
class ShownTable:
    """A printed table as the page shows it.

    Attributes
    ----------
    table : Table
    slug : str
    heads : sequence of str
        Above the cells: the printed columns, or the printed rows of a table that is turned.
    lines : sequence of (head, entries)
    turned : bool
    usual : Entry
        An entry with the table's most frequent verdict, which cells do not repeat.
    reasons : sequence of Reason
    others : sequence of Entry
        With our numbers under other readings.
    """

    table: Table
    slug: str
    heads: Sequence[str]
    lines: Sequence[tuple[str, Sequence[Entry]]]
    turned: bool
    usual: Entry
    reasons: Sequence[Reason]
    others: Sequence[Entry]

    def marked(self, entry: Entry) -> bool:
        """Whether an entry's verdict is not the table's usual one."""
        return _kind(entry) != _kind(self.usual)


def shown_table(table: Table, entries: Sequence[Entry]) -> ShownTable:
    """Arrange a table's entries.

    Parameters
    ----------
    table : Table
    entries : sequence of Entry
        Of the whole paper.
    """
    own = [entry for entry in entries if entry.place.table == table.number]
    rows = list(dict.fromkeys(entry.place.row for entry in own))
    turned = len(table.columns) >= WIDE and len(rows) < len(table.columns)
    heads, fronts = (rows, list(table.columns)) if turned else (list(table.columns), rows)
    by_front = [(front, [e for e in own if front == (e.place.column if turned else e.place.row)]) for front in fronts]
    usual, _ = Counter(_kind(entry) for entry in own).most_common(1)[0]
    first = next(entry for entry in own if _kind(entry) == usual)
    slug = table.number.lower().replace(" ", "-")
    return ShownTable(table, slug, heads, by_front, turned, first, reasons(own), [e for e in own if e.ruling.others])


def reasons(entries: Iterable[Entry]) -> list[Reason]:
    """Group entries by verdict and reason, in the order of the first of each group."""
    groups: dict[tuple[Outcome, Basis, str], list[str]] = {}
    for entry in entries:
        if (
            entry.ruling.why
            and entry.ruling.outcome is not Outcome.REPRODUCED
            and entry.ruling.outcome is not Outcome.SAME_ORDER
        ):
            key = (entry.ruling.outcome, entry.ruling.basis, entry.ruling.why)
            groups.setdefault(key, []).append(" / ".join(filter(None, (entry.place.row, entry.place.column))))
    return [Reason(*key, named(places), len(places)) for key, places in groups.items()]


def named(places: Sequence[str]) -> str:
    """Name a few places and count the rest; the CSV names all."""
    rest = len(places) - NAMED
    return "; ".join(places[:NAMED]) + (f" and {rest} more" if rest > 0 else "")


def _kind(entry: Entry) -> tuple[Outcome, Basis]:
    return entry.ruling.outcome, entry.ruling.basis
