"""The whole reproduction: work for some papers, and every printed number with its ruling, in print order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from study.cases.published import Claim, Statement, claims, statements, tables
from study.errors import StudyError, unknown
from study.reproduction.effort import Effort
from study.reproduction.in_print import rulings_in_print
from study.reproduction.jobs import RecordJob, Runs
from study.reproduction.paper import Paper
from study.reproduction.papers.aubo import Aubo
from study.reproduction.papers.puma import Puma
from study.reproduction.papers.smwoa import Smwoa
from study.reproduction.papers.sparrow import Sparrow
from study.reproduction.papers.woodworking import Woodworking
from study.reproduction.verdicts import BY_RUNS, IN_PRINT, Place, Ruling, claim

PAPERS: dict[str, type[Paper]] = {paper.key: paper for paper in (Woodworking, Aubo, Smwoa, Sparrow, Puma)}

SHORT = {paper.short: key for key, paper in PAPERS.items()}
"""Short names of the papers for the command line."""


def paper_named(name: str) -> str:
    """Find a paper's key by its key or short name.

    Raises
    ------
    StudyError
        If there is none.
    """
    if name in PAPERS:
        return name
    if name not in SHORT:
        raise unknown("paper", name, [*SHORT, *PAPERS])
    return SHORT[name]


@dataclass(frozen=True)
class Entry:
    """One printed number or statement with its ruling.

    Attributes
    ----------
    paper : str
    place : Place
    section : str
        Where it stands: the table's number or the section.
    about : str
        Of a claim what it is about; empty for a cell.
    quantity : str
    printed : str
        Empty for a statement without a number.
    ruling : Ruling
    """

    paper: str
    place: Place
    section: str
    about: str
    quantity: str
    printed: str
    ruling: Ruling


def jobs_of(papers: Iterable[str], effort: Effort) -> list[RecordJob]:
    """All work for some papers."""
    return [job for paper in papers for job in PAPERS[paper](effort, Runs({})).jobs()]


def entries_of(paper: str, runs: Runs, effort: Effort) -> tuple[Entry, ...]:
    """Everything that a paper prints, in order: tables cell by cell, then the prose.

    Raises
    ------
    StudyError
        If something has no ruling, or a ruling concerns nothing that is printed.
    """
    rulings = rulings_in_print(paper) | PAPERS[paper](effort, runs).rulings()
    for place in [place for place in rulings if place.column == BY_RUNS and claim(place.row) in rulings]:
        rulings[claim(place.row, IN_PRINT)] = rulings.pop(claim(place.row))
    gathered = [*_cells(paper, rulings), *_prose(paper, rulings)]
    if strange := set(rulings) - {entry.place for entry in gathered}:
        raise StudyError(f"paper {paper!r}: ruled on {sorted(map(str, strange))[0]}, which is not printed")
    return tuple(gathered)


def _taken(paper: str, place: Place, rulings: Mapping[Place, Ruling]) -> Ruling:
    if place not in rulings:
        raise StudyError(f"paper {paper!r}: no ruling on {place.table}, {place.row} / {place.column}")
    return rulings[place]


def _cells(paper: str, rulings: Mapping[Place, Ruling]) -> Iterable[Entry]:
    for number, table in tables(paper).items():
        for cell in table.cells:
            place = Place(number, cell.row, cell.column)
            yield Entry(paper, place, number, "", cell.quantity, cell.printed, _taken(paper, place, rulings))


def _prose(paper: str, rulings: Mapping[Place, Ruling]) -> Iterable[Entry]:
    """Claims and statements; one that is ruled on in print and by runs is two entries."""
    prose: list[Claim | Statement] = [*claims(paper).values(), *statements(paper)]
    for stated in prose:
        printed = stated.printed if isinstance(stated, Claim) else ""
        kind = "claim" if printed else "statement"
        columns = [column for column in (IN_PRINT, BY_RUNS) if claim(stated.id, column) in rulings] or [""]
        for column in columns:
            place = claim(stated.id, column)
            yield Entry(paper, place, stated.place, stated.about, kind, printed, _taken(paper, place, rulings))
