"""Printed tables, reasons and readings as the pages show them: only exceptions marked, equal reasons said once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
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
    usual : mapping of str to Entry
        By printed column an entry with the verdict of most of its cells, which these do not repeat; columns without such
        a verdict are left out.
    reasons : sequence of Reason
    others : sequence of Entry
        With our numbers under other readings.
    """

    table: Table
    slug: str
    heads: Sequence[str]
    lines: Sequence[tuple[str, Sequence[Entry]]]
    turned: bool
    usual: Mapping[str, Entry]
    reasons: Sequence[Reason]
    others: Sequence[Entry]

    @property
    def everywhere(self) -> Entry | None:
        """An entry with the verdict that all columns share as their usual one; None where they differ."""
        kinds = {_kind(entry) for entry in self.usual.values()}
        alike = len(kinds) == 1 and set(self.usual) == set(self.table.columns)
        return next(iter(self.usual.values())) if alike else None

    def marked(self, entry: Entry) -> bool:
        """Whether an entry's verdict is not its column's usual one."""
        usual = self.usual.get(entry.place.column)
        return usual is None or _kind(entry) != _kind(usual)


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
    columns = {column: [entry for entry in own if entry.place.column == column] for column in table.columns}
    usual = {column: entry for column, cells in columns.items() if (entry := _usual(cells)) is not None}
    slug = table.number.lower().replace(" ", "-")
    return ShownTable(table, slug, heads, by_front, turned, usual, reasons(own), [e for e in own if e.ruling.others])


def _usual(entries: Sequence[Entry]) -> Entry | None:
    """First entry with the verdict of more than half of several; None where no verdict has so many."""
    kind, most = Counter(map(_kind, entries)).most_common(1)[0]
    return next(entry for entry in entries if _kind(entry) == kind) if 2 * most > len(entries) else None


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
