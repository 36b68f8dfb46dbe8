"""Published results: the papers' numeric tables cell by cell, and the numbers in their prose."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Literal

from pydantic import Field

from study.cases.print_rules import Rule
from study.cases.printed import Cell, Table, parsed
from study.datafiles import Strict, checked, data_folder, read_yaml
from study.errors import StudyError, unknown

Quantity = Literal[
    "mean", "std", "min", "max", "best", "value", "run time", "duration", "total", "parameter", "waypoint", "position",
    "pose", "limit", "range", "dimension", "optimum", "iterations", "p-value", "rank", "reduction",
]  # fmt: skip


class Claim(Strict):
    """One number in a paper's prose.

    Attributes
    ----------
    id : str
    place : str
        Section, or abstract.
    about : str
    printed : str
    value : float
    unit : str
    rule : Rule, optional
        If the print alone decides.
    """

    id: str
    place: str
    about: str
    printed: str
    value: float
    unit: str = ""
    rule: Rule | None = None

    @property
    def cell(self) -> Cell:
        """The number as if it were a table's cell."""
        return Cell(self.id, "", "value", self.printed, self.value)


class Statement(Strict):
    """A claim of a paper's prose that carries no number of its own, in our words; fields as those of `Claim`."""

    id: str
    place: str
    about: str
    rule: Rule | None = None


class MainClaim(Strict):
    """One of the claims that a paper itself puts first, in our words.

    Attributes
    ----------
    claim : str
    decided : tuple of str
        Claims and statements whose verdicts decide it, `id` or `id / by runs`.
    """

    claim: str
    decided: tuple[str, ...] = Field(min_length=1)


class _TableFile(Strict):
    number: str
    about: str
    unit: str = ""
    quantity: Quantity | dict[str, Quantity]
    columns: list[str] = Field(min_length=1)
    rows: dict[str, str] = Field(min_length=1)
    rules: dict[str, Rule] = Field(default_factory=dict)


class _PaperFile(Strict):
    paper: str
    title: str
    authors: str
    venue: str
    notes: list[str] = Field(default_factory=list)
    tables: list[_TableFile]
    claims: list[Claim]
    statements: tuple[Statement, ...]
    main: tuple[MainClaim, ...]


def papers() -> dict[str, str]:
    """Keys of the papers and how to cite them."""
    files = {path.stem: _paper(path.stem) for path in _files()}
    return {key: f"{file.authors}: {file.title}. {file.venue}" for key, file in files.items()}


def tables(paper: str) -> dict[str, Table]:
    """Read the numeric tables of a paper, by number.

    Raises
    ------
    StudyError
        If there is no such paper, or its file is broken.
    """
    return {table.number: _table(table, f"file '{paper}.yaml', {table.number}") for table in _paper(paper).tables}


def claims(paper: str) -> dict[str, Claim]:
    """Read the numbers in a paper's prose, by id.

    Raises
    ------
    StudyError
        If there is no such paper, or its file is broken.
    """
    return {claim.id: claim for claim in _paper(paper).claims}


def statements(paper: str) -> tuple[Statement, ...]:
    """Read the claims of a paper's prose that carry no number.

    Raises
    ------
    StudyError
        If there is no such paper, or its file is broken.
    """
    return _paper(paper).statements


def main_claims(paper: str) -> tuple[MainClaim, ...]:
    """Read the claims that a paper puts first, in its order.

    Raises
    ------
    StudyError
        If there is no such paper, or its file is broken.
    """
    return _paper(paper).main


def _files() -> list[Path]:
    return sorted((data_folder() / "published").glob("*.yaml"))


@cache
def _paper(name: str) -> _PaperFile:
    known = {path.stem: path for path in _files()}
    if name not in known:
        raise unknown("paper", name, known)
    where = f"file {known[name].name!r}"
    file = checked(_PaperFile, read_yaml(known[name]), where)
    ids = [*(claim.id for claim in file.claims), *(statement.id for statement in file.statements)]
    for kind, keys in (("table", [t.number for t in file.tables]), ("claim", ids)):
        if doubled := {key for key in keys if keys.count(key) > 1}:
            raise StudyError(f"{where}: {kind} {min(doubled)!r} stands twice; rename one")
    return file


def _table(file: _TableFile, where: str) -> Table:
    cells = []
    for row, line in file.rows.items():
        printed = [text.strip() for text in line.split("|")]
        if len(printed) != len(file.columns):
            raise StudyError(f"{where}, row {row!r}: {len(printed)} cells for {len(file.columns)} columns")
        for column, text in zip(file.columns, printed, strict=True):
            cells.append(Cell(row, column, _quantity(file, row, column, where), text, parsed(text)))
    return Table(file.number, file.about, file.unit, tuple(file.columns), tuple(cells), file.rules)


def _quantity(file: _TableFile, row: str, column: str, where: str) -> str:
    if isinstance(file.quantity, str):
        return file.quantity
    for label in (column, row, row.split(", ")[-1]):
        if label in file.quantity:
            return file.quantity[label]
    raise StudyError(f"{where}: neither column {column!r} nor row {row!r} has a quantity; add one under 'quantity'")
