"""A plan and a comparison in HTML, for notebooks: verdict, profiles and shares of the limits."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from study.analysis.arm_uses import arm_uses
from study.judge import RATES, Verdict
from study.notebook.figures import drawing
from study.problem import Problem
from study.store.results import Result

CELL = 'style="text-align:right;padding:0 .7em"'
MANY_JOINTS = 20
"""Of more joints those nearest to their limits are shown."""


def card_of_plan(problem: Problem, result: Result, why: str, warnings: Sequence[str]) -> str:
    """HTML of a plan: duration and verdict, warnings, the profiles of all joints and their shares of the limits.

    Parameters
    ----------
    problem : Problem
    result : Result
    why : str
        Reason why this motion is the answer.
    warnings : sequence of str
    """
    verdict, motion = result.verdict, result.motion
    if verdict is None or motion is None:
        said = result.message or result.status.value
        return _div(_head(problem, "no motion", said), *_warned(warnings))
    good = "feasible" if verdict.feasible else "infeasible"
    picture = drawing(problem, motion, (7.2, 4.2))._repr_svg_()
    return _div(
        _head(problem, f"{verdict.duration:.6g} s, {good}", f"{result.cell.label}: {why}"),
        *_warned([*verdict.reasons, *warnings]),
        picture,
        _joints(problem, verdict),
        *(f"{escape(name)}: {escape(text)}<br/>" for name, text in arm_uses(problem, verdict).items()),
    )


def table_of_comparison(problem: Problem, results: Sequence[Result], warnings: Sequence[str]) -> str:
    """HTML of a comparison: a row for every run, feasible ones first."""
    rows = []
    for result in results:
        verdict = result.verdict
        said = ("; ".join(verdict.reasons) or "feasible") if verdict else result.message or result.status.value
        duration = f"{verdict.duration:.6g}" if verdict else ""
        seed = str(result.cell.settings.seed) if result.evaluations else ""
        rows.append((result.cell.label, duration, seed, said))
    head = f"<strong>{escape(problem.name)}</strong>: {len(results)} runs"
    return _div(head, *_warned(warnings), _table(("planner", "duration, s", "seed", "verdict"), rows))


def _head(problem: Problem, verdict: str, rest: str) -> str:
    return f"<strong>{escape(problem.name)}: {escape(verdict)}</strong><br/>{escape(rest)}"


def _warned(warnings: Iterable[str]) -> list[str]:
    return [f'<span style="color:#c2490a">{escape(warning)}</span>' for warning in warnings]


def _joints(problem: Problem, verdict: Verdict) -> str:
    """Table of the largest shares of every joint's limits."""
    limited = np.isfinite(problem.limits.rates)
    nearest = np.argsort(-verdict.ratios.max(axis=0), kind="stable")[:MANY_JOINTS]
    rows = [
        (name, *(f"{100 * verdict.ratios[k, j]:.2f} %" if limited[k, j] else "no limit" for k in range(3)))
        for j, name in enumerate(problem.joint_names)
        if j in nearest
    ]
    note = f", of the {MANY_JOINTS} joints nearest to theirs" if problem.n_joints > MANY_JOINTS else ""
    return f"Largest shares of the limits{note}:{_table(('joint', *RATES), rows)}"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    top = "".join(f"<th {CELL}>{escape(head)}</th>" for head in heads)
    body = "".join(f"<tr>{''.join(f'<td {CELL}>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def _div(*parts: str) -> str:
    return f'<div style="max-width:46em">{"".join(f"<div>{part}</div>" for part in parts)}</div>'
