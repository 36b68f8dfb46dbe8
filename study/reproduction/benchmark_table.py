"""A paper's benchmark table, cell by cell: what arithmetic allows, what our runs give, and the verdict."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from study.cases.printed import Cell, Table
from study.cases.published import tables
from study.reproduction import arithmetic, rules
from study.reproduction.benchmark_runs import BenchmarkJob
from study.reproduction.effort import Effort
from study.reproduction.forensics import Finding
from study.reproduction.jobs import Record, Runs
from study.reproduction.readings import FORMS, READINGS, SHAPES, STARTS, Reading
from study.reproduction.sampling import Statistic
from study.reproduction.verdicts import Basis, Outcome, Place, Ruling, Rulings, missing, strongest, used
from study.testfunctions import benchmarks_of

ROLES = {
    "Mean": Statistic.MEAN, "Avg": Statistic.MEAN, "mean": Statistic.MEAN, "Std": Statistic.STD, "std": Statistic.STD,
    "Best": Statistic.BEST, "min": Statistic.BEST, "max": Statistic.WORST,
}  # fmt: skip
"""Statistics behind the papers' row heads."""

RUNS = 30
"""Runs behind every printed cell; all three papers say so."""


@dataclass(frozen=True)
class BenchmarkTable:
    """One paper's Table 3.

    Attributes
    ----------
    paper : str
    effort : Effort
    runs : Runs
    """

    paper: str
    effort: Effort
    runs: Runs

    @property
    def table(self) -> Table:
        """The printed table."""
        return tables(self.paper)["Table 3"]

    def cell(self, function: str, column: str, reading: Reading, form: str | None = None) -> BenchmarkJob:
        """Job of one function, column and reading."""
        population, generations = SHAPES[self.paper]
        return BenchmarkJob(
            self.paper,
            function,
            form or FORMS.get((self.paper, function), "standard"),
            reading.search,
            population,
            self.effort.generations(generations),
            self.effort.seeds,
            STARTS.get((self.paper, function, column)) if reading is self.readings(column)[0] else None,
        )

    def readings(self, column: str) -> tuple[Reading, ...]:
        """Readings of a column, the stated one first."""
        gathered = READINGS[self.paper][column]
        return gathered if self.effort.all_readings else gathered[:1]

    def variants(self, function: str, column: str) -> Iterator[tuple[str, BenchmarkJob]]:
        """All that is run for a function and a column: name and job, the stated reading first."""
        stated = self.readings(column)[0]
        for reading in self.readings(column):
            yield reading.name, self.cell(function, column, reading)
        if self.effort.all_readings and (self.paper, function, column) in STARTS:
            yield f"{stated.name}, started in the box", replace(self.cell(function, column, stated), start=None)
        for form in self._other_forms(function):
            yield f"{stated.name}, function {form}", self.cell(function, column, stated, form)

    def _other_forms(self, function: str) -> list[str]:
        """Readings of a function beside the stated one that differ from it and have a least value."""
        if not self.effort.all_readings:
            return []
        stated = FORMS.get((self.paper, function), "standard")
        meant, printed = (
            next(f for f in benchmarks_of(self.paper, form) if f.label == function)
            for form in ("standard", "as-printed")
        )
        forms = ["standard"] + (["as-printed"] if meant is not printed and printed.minimum is not None else [])
        return [form for form in forms if form != stated]

    @property
    def functions(self) -> list[str]:
        """Labels of the functions in the table's order."""
        return list(dict.fromkeys(cell.row.split(",")[0] for cell in self.table.cells if "," in cell.row))

    def jobs(self) -> list[BenchmarkJob]:
        """All that the table needs."""
        return [job for f in self.functions for c in self.table.columns for _, job in self.variants(f, c)]

    def stated(self, function: str, column: str) -> BenchmarkJob:
        """Job of a column's stated reading on a function."""
        return self.cell(function, column, self.readings(column)[0])

    def record(self, function: str, column: str) -> Record:
        """Our runs of a column's stated reading on a function."""
        return self.runs[self.stated(function, column)]

    def printed_means(self, function: str) -> dict[str, float]:
        """Printed means of a function by column."""
        row = next(cell.row for cell in self.table.cells if _is_mean(cell.row, function))
        return {column: self.table.value(row, column) for column in self.table.columns}

    def rulings(self) -> Rulings:
        """Rule on every cell of every function, and on the least values that Table 2 prints."""
        gathered = self._optima() | self._boxes()
        for function in self.functions:
            for column in self.table.columns:
                gathered |= self._column(function, column)
        return gathered

    def _optima(self) -> Rulings:
        """Compare printed optimal values with the least values of the formulas as printed."""
        table, column = tables(self.paper)["Table 2"], "optimal value"
        if column not in table.columns:
            return {}
        least = {function.label: function.minimum for function in benchmarks_of(self.paper, "as-printed")}
        gathered: Rulings = {}
        for cell in (cell for cell in table.cells if cell.column == column):
            value = least[cell.row.split(",")[0]]
            ruling = rules.contradicts("the printed formula has poles and no least value", basis=Basis.FORMULA)
            if value is not None:
                why = f"the formula as printed has its least value at {value:.6g}"
                ruling = rules.exact(cell.printed, value, Basis.FORMULA, why)
            gathered[Place(table.number, cell.row, column)] = ruling
        return gathered

    def _boxes(self) -> Rulings:
        """Remark at a printed box that a swarm of ours starts outside of."""
        outside = [
            (function, column, start) for (paper, function, column), start in STARTS.items() if paper == self.paper
        ]
        return {
            Place("Table 2", function, end): used(
                f"for every column but {column}, whose swarm starts in [-{start:g}, {start:g}]: its printed results lie "
                "above everything in this box"
            )
            for function, column, start in outside
            for end in ("lower", "upper")
        }

    def _column(self, function: str, column: str) -> Rulings:
        cells = self._cells(function, column)
        by_role = {ROLES[head].value: cell for head, cell in cells.items() if head in ROLES}
        (name, job), *others = self.variants(function, column)
        findings = arithmetic.examine(arithmetic.Statistics(**by_role), RUNS, job.benchmark)
        basis = Basis.FITTED if self.readings(column)[0].fitted else Basis.RUNS
        rulings: Rulings = {}
        for head, cell in cells.items():
            if head not in ROLES:
                ruling = _other_row(head, cell, cells, self.runs[job])
            else:
                side = {other: rules.alike(cell.printed, ROLES[head].of(self.runs[j]["finals"])) for other, j in others}
                compared = replace(self._compared(cell, ROLES[head], job), others=side, basis=basis)
                ruling = strongest(_denied(findings.get(ROLES[head].value)), compared)
            rulings[Place("Table 3", cell.row, column)] = replace(ruling, reading=name)
        return rulings

    def _cells(self, function: str, column: str) -> dict[str, Cell]:
        """Cells of one function and column by their row heads."""
        own = [cell for cell in self.table.cells if cell.column == column and cell.row.startswith(f"{function}, ")]
        return {cell.row.split(", ")[1]: cell for cell in own}

    def _compared(self, cell: Cell, role: Statistic, job: BenchmarkJob) -> Ruling:
        function = job.benchmark
        least = 0.0 if role is Statistic.STD or function.minimum is None else function.minimum
        finals = self.runs[job]["finals"]
        return rules.stochastic(cell.printed, finals, role, RUNS, least, arithmetic.rounding(function))

    def tallies(self) -> list[Tally]:
        """Agreement of every reading of every column with the printed cells."""
        return [self._tally(column, reading) for column in self.table.columns for reading in self.readings(column)]

    def _tally(self, column: str, reading: Reading) -> Tally:
        outcomes = [
            self._compared(cell, ROLES[head], self.cell(function, column, reading)).outcome
            for function in self.functions
            for head, cell in self._cells(function, column).items()
            if head in ROLES
        ]
        counts = (outcomes.count(Outcome.REPRODUCED), outcomes.count(Outcome.SAME_ORDER), len(outcomes))
        return Tally(column, reading, *counts)


@dataclass(frozen=True)
class Tally:
    """Agreement of one reading with one column.

    Attributes
    ----------
    column : str
    reading : Reading
    reproduced, same_order, cells : int
    """

    column: str
    reading: Reading
    reproduced: int
    same_order: int
    cells: int


def _is_mean(row: str, function: str) -> bool:
    label, _, head = row.partition(", ")
    return label == function and ROLES.get(head) is Statistic.MEAN


def _denied(finding: Finding | None) -> Ruling | None:
    """Rule that arithmetic, or the box that another table prints, forbids a cell."""
    if finding is None:
        return None
    if finding.check == "above largest":
        return rules.contradicts(f"inside the box of Table 2 this cannot be: {finding.inequality}")
    return rules.impossible(finding.inequality)


def _other_row(head: str, cell: Cell, cells: dict[str, Cell], record: Record) -> Ruling:
    """Rule on the rows `value` and `time` of the PUMA560 paper."""
    if head == "time":
        return missing("a wall time: neither processor nor code is given", f"{np.median(record['seconds']):.3g} s")
    broken = arithmetic.outside_extremes(cell, cells)
    if broken is not None:
        return rules.impossible(broken.inequality)
    return missing("which of the 30 runs this value is of is not said", rules.alike(cell.printed, record["finals"][0]))
