"""Printed numbers: cells, tables, and the numbers behind the text of a cell."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from study.cases.print_rules import Rule
from study.errors import StudyError, unknown


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

    def row_values(self, row: str, columns: Sequence[str]) -> list[float]:
        """Numbers of a row."""
        return [self.value(row, column) for column in columns]

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
