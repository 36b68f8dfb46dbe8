"""What the papers' files share: inputs that are used as given, claims read as cells, chaos maps and their figures."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from study.cases.published import Cell, Table, claims, tables
from study.errors import StudyError
from study.problem import Floats
from study.reproduction import rules
from study.reproduction.jobs import Record
from study.reproduction.verdicts import Place, Ruling, claim, used
from study.search.chaos import MAPS, uniformity

Rulings = dict[Place, Ruling]


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


def inputs(paper: str, numbers: Iterable[str], why: str = "") -> Rulings:
    """Rule that whole tables are inputs."""
    return {Place(n, c.row, c.column): used(why) for n in numbers for c in tables(paper)[n].cells}


def settings(paper: str, ids: Iterable[str]) -> Rulings:
    """Rule that claims are settings which our runs use."""
    known = claims(paper)
    for name in (names := list(ids)):
        if name not in known:
            raise StudyError(f"paper {paper!r} has no claim {name!r}")
    return {claim(name): used() for name in names}


def claim_cell(paper: str, identity: str) -> Cell:
    """Read a claim as if it were a table's cell."""
    found = claims(paper)[identity]
    return Cell(identity, "", "value", found.printed, found.value)


def row_of(table: Table, row: str, columns: Sequence[str]) -> list[Cell]:
    """Cells of a row."""
    return [table[row, column] for column in columns]


def optima(table: Table, least: Mapping[str, float | None], column: str = "optimal value") -> Rulings:
    """Compare printed optimal values with the least values of the formulas as printed.

    Parameters
    ----------
    table : Table
    least : mapping of a row to the least value, None where the printed formula has none
    column : str
    """
    found: Rulings = {}
    for row, value in least.items():
        cell = table[row, column]
        if value is None:
            found[Place(table.number, row, column)] = rules.contradicts(
                "the printed formula has poles and no least value"
            )
        else:
            why = f"the formula as printed has its least value at {value:.6g}"
            found[Place(table.number, row, column)] = rules.exact(cell.printed, value, _CONTRADICTS, why)
    return found


_CONTRADICTS = rules.contradicts("").outcome


def percentage(printed: str, before: float, after: float, ours: str = "") -> Ruling:
    """Check a printed reduction in per cent against the printed values that it is made from."""
    value = 100 * (before - after) / before
    why = f"100 ({before:g} - {after:g}) / {before:g} = {value:.5g}"
    ruling = rules.exact(printed, value, _CONTRADICTS, why)
    return Ruling(ruling.outcome, ruling.ours, why + (f"; our runs: {ours}" if ours else ""), ruling.agrees)


def conversion(printed: str, value: float, what: str) -> Ruling:
    """Check a printed number against another printed one that it repeats in another unit."""
    return rules.exact(printed, value, _CONTRADICTS, f"{what} is {value:.5g}")


STARTS = 1000
"""Random starts of every map behind a chi-square figure."""

NUMBERS = 1000
"""Numbers drawn from each start, as in the PUMA560 and the sparrow paper."""


@cache
def chaos_numbers(name: str) -> Floats:
    """Sequences of a map from many starts, or of the uniform generator under the name `uniform`, (NUMBERS, STARTS)."""
    rng = np.random.default_rng(11)
    if name == "uniform":
        return rng.random((NUMBERS, STARTS))
    with np.errstate(over="ignore", invalid="ignore"):  # an orbit that has left [0, 1], as Singer's may, diverges
        return MAPS[name].sequences(rng.random(STARTS), NUMBERS, rng)


@cache
def chi_squares(name: str) -> tuple[float, ...]:
    """Chi-square figures of a map from many starts; infinite for an orbit that leaves [0, 1]."""
    return tuple(uniformity(x) if ((x >= 0) & (x <= 1)).all() else math.inf for x in chaos_numbers(name).T)


def more_uniform(name: str, others: Sequence[str]) -> Ruling:
    """Rule on the statement that a map is more uniform than others: smaller chi-square by the rank-sum test."""
    own = chi_squares(name)
    figures = {other: chi_squares(other) for other in others}
    tests = {other: rules.smaller(own, values) for other, values in figures.items()}
    text = f"chi-square {np.median(own):.1f} (5 % limit 16.9) against " + ", ".join(
        f"{other} {np.median(values):.1f}" for other, values in figures.items()
    )
    failed = [other for other, (smaller, _) in tests.items() if not smaller]
    why = f"not more uniform than {', '.join(failed)}" if failed else "smaller by the rank-sum test"
    return rules.holds(not failed, text, why + f"; medians over {STARTS} starts of {NUMBERS} numbers, ten bins")


@dataclass(frozen=True)
class Panel:
    """One small plot: lines over generations.

    Attributes
    ----------
    title : str
    lines : mapping of a label to generations and values
    logarithmic : bool
        Whether values span orders of magnitude.
    """

    title: str
    lines: Mapping[str, tuple[Sequence[float], Sequence[float]]]
    logarithmic: bool = False


@dataclass(frozen=True, eq=False)
class Drive:
    """Motions of a case to draw: labels and segment durations, shape (n_segments,), s."""

    case: str
    motions: Sequence[tuple[str, Floats]]


def line_of(record: Record) -> tuple[Sequence[float], Sequence[float]]:
    """Median best value against generations of a job's record."""
    return record["generations"], record["curve"]
