"""Rulings that the print alone decides: inputs, gaps, and numbers that other printed numbers give."""

from __future__ import annotations

import math

from study.cases.print_rules import Rule, RuleKind
from study.cases.printed import Cell, Table
from study.cases.published import claims, statements, tables
from study.errors import StudyError
from study.reproduction import rules
from study.reproduction.verdicts import Basis, Outcome, Place, Ruling, Rulings, claim, missing, used


def rulings_in_print(paper: str) -> Rulings:
    """Rule on every cell and claim of a paper whose rule stands beside it in the data file.

    Parameters
    ----------
    paper : str
        Key of the paper.
    """
    gathered: Rulings = {}
    for table in tables(paper).values():
        for cell in table.cells:
            if (rule := table.rule(cell)) is not None:
                gathered[Place(table.number, cell.row, cell.column)] = _ruled(
                    paper, cell, _completed(rule, table, cell)
                )
    for name, stated in claims(paper).items():
        if stated.rule is not None:
            gathered[claim(name)] = _ruled(paper, stated.cell, stated.rule)
    for statement in statements(paper):
        if statement.rule is not None:
            gathered[claim(statement.id)] = _told(statement.rule)
    return gathered


def printed_value(paper: str, term: str) -> float:
    """Printed number behind a term of a rule: a claim's, a cell's, or the sum of several cells of a row.

    Raises
    ------
    StudyError
        If nothing of that name is printed.
    """
    if " / " not in term:
        if term not in claims(paper):
            raise StudyError(f"paper {paper!r}: a rule takes {term!r}, which is no claim")
        return claims(paper)[term].value
    number, row, columns = term.split(" / ")
    return math.fsum(tables(paper)[number].value(row, column) for column in columns.split(" + "))


def _completed(rule: Rule, table: Table, cell: Cell) -> Rule:
    """Rule with the cell's own neighbour as its term where the rule is one of a whole column."""
    if rule.kind is not RuleKind.RADIANS:
        return rule
    return Rule(kind=rule.kind, terms=(f"{table.number} / {cell.row} / {cell.column.replace('(rad)', '(deg)')}",))


def _ruled(paper: str, cell: Cell, rule: Rule) -> Ruling:
    if not rule.terms:
        return _told(rule)
    value, why = _computed(rule.kind, [printed_value(paper, term) for term in rule.terms])
    return rules.exact(cell.printed, value, Basis.PRINT, why)


def _told(rule: Rule) -> Ruling:
    """Ruling of a rule that takes no numbers."""
    if rule.kind is RuleKind.CONSISTENT:
        return Ruling(Outcome.CONSISTENT, why=rule.why, agrees=True, basis=Basis.PRINT)
    if rule.kind is RuleKind.CONTRADICTS:
        return rules.contradicts(rule.why)
    return missing(rule.why) if rule.kind is RuleKind.MISSING else used(rule.why)


def _computed(kind: RuleKind, values: list[float]) -> tuple[float, str]:
    """Value that the printed numbers give, and the calculation as text."""
    if kind is RuleKind.SUM:
        total = math.fsum(values)
        return total, f"{' + '.join(f'{value:g}' for value in values)} = {total:.6g}"
    if kind is RuleKind.RADIANS:
        return math.radians(values[0]), f"{values[0]:g} deg is {math.radians(values[0]):.5g}"
    if kind is RuleKind.SAME:
        return values[0], f"the same number is printed as {values[0]:g} elsewhere"
    before, after = values
    if kind is RuleKind.DIFFERENCE:
        return abs(before - after), f"|{before:g} - {after:g}| = {abs(before - after):.5g}"
    share = 100 * (before - after) / before
    return share, f"100 ({before:g} - {after:g}) / {before:g} = {share:.5g}"
