"""Rules on printed numbers that the print alone decides, as they stand beside the numbers in the data files."""

from __future__ import annotations

from dataclasses import dataclass

from study.choices import Choice


class RuleKind(Choice):
    """Ways to rule on a printed number by the print alone."""

    USED = "used"
    MISSING = "missing"
    CONSISTENT = "consistent"
    CONTRADICTS = "contradicts"
    SAME = "same"
    SUM = "sum"
    DIFFERENCE = "difference"
    PERCENTAGE = "percentage"
    RADIANS = "radians"


@dataclass(frozen=True)
class Rule:
    """Rule on a printed number that the print alone decides.

    Attributes
    ----------
    kind : RuleKind
    terms : tuple of str
        Printed numbers that it takes: ids of claims, or cells as `Table 5 / row / column`, several columns of a row
        joined by ` + `.
    why : str
        A sentence for inputs, gaps, and what no calculation decides.
    """

    kind: RuleKind
    terms: tuple[str, ...] = ()
    why: str = ""


RuleText = str | dict[str, str | list[str]]
"""A rule as a data file has it: `used`, `{used: sentence}` or `{percentage: [before, after]}`."""


def rule_of(content: RuleText | None) -> Rule | None:
    """Turn the text of a data file into a rule.

    Raises
    ------
    StudyError
        If there is no such kind of rule.
    """
    if content is None or isinstance(content, str):
        return None if content is None else Rule(RuleKind(content))
    (kind, told), *_ = content.items()
    return Rule(RuleKind(kind), why=told) if isinstance(told, str) else Rule(RuleKind(kind), tuple(told))
