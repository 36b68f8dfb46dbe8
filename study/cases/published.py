"""Published results: the papers' numeric tables cell by cell, and the numbers in their prose."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from study.cases.print_rules import Rule, RuleText, rule_of
from study.datafiles import Strict, checked, data_folder, read_yaml
from study.errors import StudyError, unknown

Quantity = Literal[
    "mean", "std", "min", "max", "best", "value", "run time", "duration", "total", "parameter", "waypoint", "position",
    "pose", "limit", "range", "dimension", "optimum", "iterations", "p-value", "rank", "reduction",
]  # fmt: skip


@dataclass(frozen=True)
class Cell:
    """One printed cell.

    Attributes
    ----------
    row, column : str
    quantity : str
        What the number is, such as `mean` or `duration`.
    printed : str
        As in the paper, powers of ten written as `x 10^n`.
    value : float, optional
        The number, where the print is one.
    """

    row: str
    column: str
    quantity: str
    printed: str
    value: float | None


@dataclass(frozen=True)
class Table:
    """One printed table.

    Attributes
    ----------
    number : str
        Such as `Table 3`.
    about : str
    unit : str
    columns : tuple of str
    cells : tuple of Cell
        Row by row.
    rules : mapping of str to Rule
        Rules of the print, by `row / column`, by column or its last word, by row, or by `*`.
    """

    number: str
    about: str
    unit: str
    columns: tuple[str, ...]
    cells: tuple[Cell, ...]
    rules: Mapping[str, Rule] = field(default_factory=dict)

    def __getitem__(self, place: tuple[str, str]) -> Cell:
        """Cell at (row, column)."""
        for cell in self.cells:
            if (cell.row, cell.column) == place:
                return cell
        raise unknown(f"cell of {self.number}", " / ".join(place), [f"{c.row} / {c.column}" for c in self.cells])

    def row(self, row: str, columns: Sequence[str]) -> list[Cell]:
        """Cells of a row."""
        return [self[row, column] for column in columns]

    def value(self, row: str, column: str) -> float:
        """Return the number at (row, column), or say that the cell is not one."""
        cell = self[row, column]
        if cell.value is None:
            raise StudyError(f"{self.number}, {row} / {column}: {cell.printed!r} is not a number")
        return cell.value

    def rule(self, cell: Cell) -> Rule | None:
        """Rule of a cell that the print alone decides; None if it takes more."""
        places = (f"{cell.row} / {cell.column}", cell.column, cell.row, cell.column.split(" ")[-1], "*")
        return next((self.rules[place] for place in places if place in self.rules), None)


@dataclass(frozen=True)
class Claim:
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
    unit: str
    rule: Rule | None

    @property
    def cell(self) -> Cell:
        """The number as if it were a table's cell."""
        return Cell(self.id, "", "value", self.printed, self.value)


@dataclass(frozen=True)
class Statement:
    """A claim of a paper's prose that carries no number of its own, in our words.

    Attributes
    ----------
    id : str
    place : str
    about : str
    """

    id: str
    place: str
    about: str


class _TableFile(Strict):
    number: str
    about: str
    unit: str = ""
    quantity: Quantity | dict[str, Quantity]
    columns: list[str] = Field(min_length=1)
    rows: dict[str, str] = Field(min_length=1)
    rules: dict[str, RuleText] = Field(default_factory=dict)


class _ClaimFile(Strict):
    id: str
    place: str
    about: str
    printed: str
    value: float
    unit: str = ""
    rule: RuleText | None = None


class _StatementFile(Strict):
    id: str
    place: str
    about: str


class _PaperFile(Strict):
    paper: str
    title: str
    authors: str
    venue: str
    notes: list[str] = Field(default_factory=list)
    tables: list[_TableFile]
    claims: list[_ClaimFile]
    statements: list[_StatementFile]


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
    return {
        claim.id: Claim(**claim.model_dump(exclude={"rule"}), rule=rule_of(claim.rule))
        for claim in _paper(paper).claims
    }


def statements(paper: str) -> tuple[Statement, ...]:
    """Read the claims of a paper's prose that carry no number.

    Raises
    ------
    StudyError
        If there is no such paper, or its file is broken.
    """
    return tuple(Statement(**statement.model_dump()) for statement in _paper(paper).statements)


def parsed(printed: str) -> float | None:
    """Turn a printed number, its unit left off, into a float: plain, with a power of ten, or a multiple of pi.

    None for anything else.
    """
    text = re.sub(r"(?<=\d)(m|mm|rad|deg|s|%)$", "", printed.replace("−", "-").replace(" ", ""))
    if power := re.fullmatch(r"(-?\d+\.?\d*)x10\^(-?\d+)", text):
        return float(f"{power[1]}e{power[2]}")
    if turn := re.fullmatch(r"(-?)(\d*)\*?pi(?:/(\d+))?", text):
        return float(f"{turn[1]}1") * float(turn[2] or 1) * np.pi / float(turn[3] or 1)
    try:
        return float(text)
    except ValueError:
        return None


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
    rules = {label: rule for label, content in file.rules.items() if (rule := rule_of(content))}
    return Table(file.number, file.about, file.unit, tuple(file.columns), tuple(cells), rules)


def _quantity(file: _TableFile, row: str, column: str, where: str) -> str:
    if isinstance(file.quantity, str):
        return file.quantity
    for label in (column, row, row.split(", ")[-1]):
        if label in file.quantity:
            return file.quantity[label]
    raise StudyError(f"{where}: neither column {column!r} nor row {row!r} has a quantity; add one under 'quantity'")
