"""The woodworking paper's statements about eight benchmark functions; the swarms' constants and lambda are fitted."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from study.reproduction import rules
from study.reproduction.benchmark_table import BenchmarkTable
from study.reproduction.sampling import compared, in_every
from study.reproduction.verdicts import Basis, Rulings, claim

SWARMS = ("PSO", "CFPSO", "SPSO")


def rulings(table: BenchmarkTable) -> Rulings:
    """Rule on every statement of Section 2.5 that needs runs.

    Parameters
    ----------
    table : BenchmarkTable
        Our runs of the paper's Table 3.
    """
    gathered = _accuracy(table) | _orders(table)
    return {place: replace(ruling, basis=Basis.FITTED) for place, ruling in gathered.items()}


def _accuracy(table: BenchmarkTable) -> Rulings:
    """Statements of Section 2.5 about final values; the swarms' constants and lambda are fitted."""
    own = {f: _finals(table, "GoldS-PSO", f) for f in table.functions}
    swarms = {f"{f} against {other}": compared(own[f], _finals(table, other, f)) for f, other in product(own, SWARMS)}
    golden = {f: compared(own[f], _finals(table, "Gold-SA", f)) for f in ("F4", "F5")}
    eighth = compared(_finals(table, "Gold-SA", "F8"), own["F8"])
    worst = max(max(own[f]) for f in ("F1", "F2", "F3"))
    last = {key: max(_finals(table, *key)) for key in product(("Gold-SA", "SPSO"), ("F2", "F3"))}
    near = {f"{name} on {f}": value for (name, f), value in last.items()}
    ends = {f: min(map(min, (_finals(table, c, f) for c in table.table.columns))) for f in ("F4", "F5")}
    spread = {k: float(np.ptp(_finals(table, *k))) for k in product(("Gold-SA", "GoldS-PSO"), ("F6", "F7"))}
    text = ", ".join(f"{name} {value:.2g}" for name, value in near.items())
    gathered = {
        claim("best-of-swarms"): in_every(swarms),
        claim("exact-zero"): rules.holds(worst == 0.0, f"largest of all runs {worst:.3g}"),
        claim("beats-gold-sa"): in_every(golden),
        claim("behind-gold-sa-f8"): in_every({"F8": eighth}),
        claim("not-zero-f2-f3"): rules.holds(all(0 < v < 1e-90 for v in near.values()), text, "largest of all runs"),
        claim("none-optimal-f4-f5"): rules.holds(
            min(ends.values()) > 0, ", ".join(f"{f}: {v:.2g}" for f, v in ends.items())
        ),
        claim("robust-f6-f7"): rules.holds(max(spread.values()) == 0.0, f"largest range {max(spread.values()):.2g}"),
    }
    return gathered


def _orders(table: BenchmarkTable) -> Rulings:
    """Statements about an order of convergence."""
    rivals = ("PSO", "CFPSO", "SPSO", "Gold-SA")
    faster, fewest = (
        {
            f"{f} against {o}": compared(_reach(table, "GoldS-PSO", f), _reach(table, o, f))
            for f, o in product(of, rivals)
        }
        for of in (("F1", "F2", "F3"), ("F6", "F7"))
    )
    told = "generations until the least value that any of the five reaches; the whole budget where a run does not"
    return {claim("faster-f1-f3"): in_every(faster, told), claim("fewest-f6-f7"): in_every(fewest, told)}


def _reach(table: BenchmarkTable, algorithm: str, function: str) -> list[float]:
    """Generations until the least value that any column reaches, run by run; the budget where it is not reached."""
    least = min(min(_finals(table, column, function)) for column in table.table.columns)
    record = table.record(function, algorithm)
    budget = float(record["generations"][-1])
    return [float(a) if end <= least else budget for a, end in zip(record["arrived"], record["finals"], strict=True)]


def _finals(table: BenchmarkTable, algorithm: str, function: str) -> list[float]:
    """Our final values of the stated reading."""
    return list(table.record(function, algorithm)["finals"])
