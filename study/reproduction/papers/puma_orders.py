"""The PUMA560 paper's statements about the order of four algorithms on six functions, in print and by our runs."""

from __future__ import annotations

import numpy as np
from scipy import stats

from study.cases.printed import Table
from study.reproduction import convergence, rules
from study.reproduction.benchmark_table import BenchmarkTable
from study.reproduction.verdicts import Basis, Outcome, Ruling, Rulings, claim

FUNCTIONS = [f"F{k}" for k in range(1, 7)]
OWN = "SPSO"


def rulings(table: Table, ours: BenchmarkTable) -> Rulings:
    """Rule on every statement of Section 3.5.

    Parameters
    ----------
    table : Table
        The printed Table 3.
    ours : BenchmarkTable
    """
    return _least_values(table, ours) | _single_functions(table) | _overall(table) | _iterations(ours)


def mean_ranks(table: Table, head: str) -> dict[str, float]:
    """Mean rank of every column over the six functions by the printed cells of a row head; ties share theirs."""
    ranks = [stats.rankdata(table.row_values(f"{function}, {head}", table.columns)) for function in FUNCTIONS]
    return dict(zip(table.columns, np.mean(ranks, axis=0).tolist(), strict=True))


def _least_values(table: Table, ours: BenchmarkTable) -> Rulings:
    """Statements that SPSO has the least deviation or minimum on a function."""
    stated = {
        "least-deviation-f2": "F2, std",
        "least-deviation-f4": "F4, std",
        "f3-deviation": "F3, std",
        "f5-stability": "F5, std",
        "least-minimum-f2": "F2, min",
        "least-minimum-f6": "F6, min",
        "f1-smallest": "F1, min",
    }
    return {claim(identity): _least(table, ours, row) for identity, row in stated.items()}


def _least(table: Table, ours: BenchmarkTable, row: str) -> Ruling:
    """Rule by the printed cells; where they bear the statement out, by our runs."""
    (function, head), values = row.split(", "), {}
    for column in table.columns:
        finals = ours.record(function, column)["finals"]
        values[column] = float(np.std(finals, ddof=1)) if head == "std" else min(finals)
    text = ", ".join(f"{column} {value:.3g}" for column, value in values.items())
    printed = min(table.columns, key=lambda column: table.value(row, column))
    if printed != OWN:
        return rules.contradicts(f"Table 3 prints the least for {printed}: {table[row, printed].printed}", text)
    return rules.holds(min(values, key=lambda column: values[column]) == OWN, text, "least of our runs", Basis.FITTED)


def _single_functions(table: Table) -> Rulings:
    first = mean_order(table, "F1, mean")
    third = {column: table["F3, min", column].printed for column in table.columns}
    fourth = {column: table["F4, min", column].printed for column in table.columns}
    return {
        claim("f1-second"): rules.holds(first.index(OWN) == 1, ", ".join(first), "by the printed means", Basis.PRINT),
        claim("f3-outperforms"): rules.contradicts(
            f"Table 3 prints the minimum {third['SCA']} for SCA, {third[OWN]} for SPSO; by the means SPSO is first"
        ),
        claim("f4-similar"): rules.contradicts(
            f"Table 3 prints the minima {fourth['STOA']} and {fourth['SCA']} for {fourth[OWN]}"
        ),
    }


def mean_order(table: Table, row: str) -> list[str]:
    """Columns from the least printed number of a row to the greatest."""
    return sorted(table.columns, key=lambda column: table.value(row, column))


def _overall(table: Table) -> Rulings:
    """Overall ranks by the printed means, extremes, times and deviations."""
    ranks = {head: mean_ranks(table, head) for head in ("mean", "min", "max", "time", "std")}
    told = "; ".join(f"by {head}: " + ", ".join(f"{c} {r:.2f}" for c, r in by.items()) for head, by in ranks.items())
    first = [head for head, by in ranks.items() if by[OWN] <= min(by.values())]
    deviation = min(ranks["std"], key=lambda column: ranks["std"][column])
    wrong = rules.contradicts(
        f"mean ranks of the printed deviations: "
        f"{', '.join(f'{c} {r:.2f}' for c, r in ranks['std'].items())}; first is {deviation}"
    )
    return {
        claim("first-overall"): rules.holds(
            {"mean", "min", "max"} <= set(first), told, "mean ranks of the printed cells over F1 to F6", Basis.PRINT
        ),
        claim("shortest-run-time"): rules.holds(
            "time" in first, "", "least printed time on every function", Basis.PRINT
        ),
        claim("least-deviation-overall"): rules.holds(True, "", told, Basis.PRINT) if deviation == OWN else wrong,
    }


def _iterations(ours: BenchmarkTable) -> Rulings:
    """Statements about an order of convergence."""
    return {
        claim("f5-converge"): _fifth(ours),
        claim("fewest-f2"): _fewest(ours, "F2", ("STOA", "SCA", "PSO")),
        claim("fewest-f4"): _fewest(ours, "F4", ("STOA", "SCA")),
    }


def _fewest(ours: BenchmarkTable, function: str, others: tuple[str, ...]) -> Ruling:
    """Rule on fewest generations at any share of the descent, by medians."""
    steps = {column: convergence.levels(ours.record(function, column)) for column in (OWN, *others)}
    agreeing = [at for at in convergence.LEVELS if all(steps[OWN][at] < steps[other][at] for other in others)]
    text = ", ".join(
        f"{column} {' / '.join(f'{v:g}' for v in gathered.values())}" for column, gathered in steps.items()
    )
    why = f"medians at 0.1, 1, 2 and 5 % of the descent; SPSO first at {', '.join(agreeing) or 'none'}"
    return rules.holds(bool(agreeing), text, why, Basis.FITTED)


def _fifth(ours: BenchmarkTable) -> Ruling:
    """Three algorithms reach the least value of F5 at their best; generations at 0.1 % of the descent beside it."""
    columns = (OWN, "SCA", "STOA")
    least = {column: min(ours.record("F5", column)["finals"]) for column in columns}
    steps = {column: convergence.levels(ours.record("F5", column)) for column in columns}
    reach = all(abs(value - 0.998) < 1e-3 for value in least.values())
    agreeing = [level for level in convergence.LEVELS if min(steps, key=lambda column: steps[column][level]) == OWN]
    text = ", ".join(f"{column} {value:.4f}" for column, value in least.items())
    why = f"least of our runs; SPSO first at {', '.join(agreeing) or 'none'} of the descent"
    outcome = Outcome.REPRODUCED if reach and agreeing else Outcome.NOT_CONFIRMED
    return Ruling(outcome, text, why, reach and bool(agreeing), basis=Basis.FITTED)
