"""A paper's benchmark table, cell by cell: what arithmetic allows, what our runs give, and the verdict."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from study.cases.published import Cell, Table, tables
from study.reproduction import arithmetic, rules
from study.reproduction.benchmark_runs import BenchmarkJob
from study.reproduction.effort import Effort
from study.reproduction.jobs import Record, Runs
from study.reproduction.readings import FORMS, READINGS, SHAPES, STARTS, Reading
from study.reproduction.verdicts import Outcome, Place, Ruling, Rulings, missing, strongest
from study.testfunctions import benchmarks_of

ROLES = {
    "Mean": "mean",
    "Avg": "mean",
    "mean": "mean",
    "Std": "std",
    "std": "std",
    "Best": "best",
    "min": "best",
    "max": "worst",
}
"""What the papers' row heads stand for."""

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
        found = READINGS[self.paper][column]
        return found if self.effort.all_readings else found[:1]

    def variants(self, function: str, column: str) -> Iterator[tuple[str, BenchmarkJob]]:
        """All that is run for a function and a column: name and job, the stated reading first."""
        for reading in self.readings(column):
            yield reading.name, self.cell(function, column, reading)
        for form in self._other_forms(function):
            yield (
                f"{self.readings(column)[0].name}, function {form}",
                self.cell(function, column, self.readings(column)[0], form),
            )

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

    def rulings(self) -> Rulings:
        """Rule on every cell of every function, and on the least values that Table 2 prints."""
        found = self._optima()
        for function in self.functions:
            for column in self.table.columns:
                found |= self._column(function, column)
        return found

    def _optima(self) -> Rulings:
        """Compare printed optimal values with the least values of the formulas as printed."""
        table, column = tables(self.paper)["Table 2"], "optimal value"
        if column not in table.columns:
            return {}
        least = {function.label: function.minimum for function in benchmarks_of(self.paper, "as-printed")}
        found: Rulings = {}
        for cell in (cell for cell in table.cells if cell.column == column):
            value = least[cell.row.split(",")[0]]
            ruling = rules.contradicts("the printed formula has poles and no least value")
            if value is not None:
                why = f"the formula as printed has its least value at {value:.6g}"
                ruling = rules.exact(cell.printed, value, Outcome.CONTRADICTS, why)
            found[Place(table.number, cell.row, column)] = ruling
        return found

    def _column(self, function: str, column: str) -> Rulings:
        cells = {
            c.row.split(", ")[1]: c
            for c in self.table.cells
            if c.column == column and c.row.startswith(f"{function}, ")
        }
        by_role = {ROLES[head]: cell for head, cell in cells.items() if head in ROLES}
        (name, job), *others = self.variants(function, column)
        findings = arithmetic.examine(arithmetic.Statistics(**by_role), RUNS, job.benchmark)
        record = self.runs[job]
        rulings: Rulings = {}
        for head, cell in cells.items():
            role = ROLES.get(head)
            if role is None:
                ruling = _other_row(head, cell, cells, record)
            else:
                broken = findings.get(role)
                compared = self._compared(cell, role, job, record)
                side = {other: rules.number(statistic(self.runs[j]["finals"], role)) for other, j in others}
                denied = None if broken is None else rules.impossible(broken.inequality)
                ruling = strongest(denied, replace(compared, others=side))
            rulings[Place("Table 3", cell.row, column)] = replace(ruling, reading=name)
        return rulings

    def _compared(self, cell: Cell, role: str, job: BenchmarkJob, record: Record) -> Ruling:
        function = job.benchmark
        least = 0.0 if role == "std" or function.minimum is None else function.minimum
        return rules.stochastic(cell.printed, statistic(record["finals"], role), least, arithmetic.grain(function))


def _other_row(head: str, cell: Cell, cells: dict[str, Cell], record: Record) -> Ruling:
    """Rule on PUMA's rows `value` and `time`."""
    if head == "time":
        return missing("a wall time: neither processor nor code is given", f"{np.median(record['seconds']):.3g} s")
    broken = arithmetic.outside_extremes(cell, cells)
    if broken is not None:
        return rules.impossible(broken.inequality)
    return missing("which of the 30 runs this value is of is not said", rules.number(record["finals"][0]))


def statistic(finals: list[float], role: str) -> float:
    """Mean, sample standard deviation, least or greatest of the runs' final values."""
    values = np.array(finals)
    with np.errstate(over="ignore", under="ignore"):
        if role == "std":
            return float(values.std(ddof=1)) if len(values) > 1 else 0.0
        return float(values.mean() if role == "mean" else values.min() if role == "best" else values.max())
