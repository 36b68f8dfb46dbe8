"""Rules on printed numbers that the print alone decides, as they stand beside the numbers in the data files."""

from __future__ import annotations

from pydantic import model_validator

from study.choices import Choice
from study.datafiles import Strict


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


class Rule(Strict):
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

    @model_validator(mode="before")
    @classmethod
    def _written(cls, content: object) -> object:
        """Read a rule as a data file has it: `used`, `{used: sentence}` or `{percentage: [before, after]}`."""
        if isinstance(content, str):
            return {"kind": content}
        if isinstance(content, dict) and len(content) == 1 and "kind" not in content:
            [(kind, told)] = content.items()
            return {"kind": kind, "why" if isinstance(told, str) else "terms": told}
        return content
