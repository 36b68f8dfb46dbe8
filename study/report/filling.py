"""Templates of the report, filled in with the names and the forms of numbers that they share."""

from __future__ import annotations

from collections.abc import Mapping

from study.analysis import formatting
from study.analysis.featured import IN_ORDER, ROLE_NAMES
from study.analysis.tables import raw
from study.judge import RATES
from study.planning import Freedom
from study.report.rendering import render
from study.report.tables import COLUMNS


def filled(template: str, context: Mapping[str, object], root: str = "") -> str:
    """Fill in a template of the report."""
    filters = {
        name: getattr(formatting, name)
        for name in ("seconds", "change", "wall", "percent", "share", "count", "plural", "listed", "coded")
    }
    shared = {
        "rates": RATES,
        "raw": raw,
        "columns": COLUMNS,
        "role_names": ROLE_NAMES,
        "roles": IN_ORDER,
        "freedoms": tuple(Freedom),
    }
    return render(template, {**shared, **context}, filters=filters, root=root)
