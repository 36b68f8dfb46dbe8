"""The page of a case: who is faster, the ladder, all results, profiles, limit use and convergence."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from study.analysis import formatting
from study.analysis.arm_uses import arm_uses
from study.analysis.case_summary import CaseSummary
from study.analysis.ends import end_steps
from study.analysis.featured import ROLE_NAMES, Featured
from study.analysis.ladder import CauseKind, Rung
from study.analysis.methods import MethodSummary, Standing, known_times, names_explained
from study.analysis.sentences import case_answer
from study.analysis.tables import Record, records
from study.cases.papers import paper_of
from study.cautions import ends_said
from study.judge import TOLERANCE
from study.planning import Freedom
from study.report import bars, figures, plot_style
from study.report.convergence import convergence_of
from study.report.filling import filled
from study.report.live import profiles_data
from study.report.tables import RESULTS
from study.trajectory import Motion

ALIKE = 3e-3
"""Share of a duration and of a joint's range below which two motions are drawn on top of each other."""

TOO_LONG = 3.0
"""A motion that takes so many times as long as the reference would squeeze the others' profiles; it is left out of them."""

STANDINGS = {
    Standing.FEASIBLE: "",
    Standing.INFEASIBLE: "Infeasible: a limit is broken, or no motion was found",
    Standing.INAPPLICABLE: "Does not apply to this case",
    Standing.BOUND: "Proved lower bounds: times that no motion through the waypoints can undercut",
    Standing.UNJUDGED: "Printed without segment durations: nothing to judge",
}
"""Groups of the results table and their heads; sorting moves rows inside a group only."""

HATCHES = {Freedom.CURVE: "", Freedom.PATH: "...", Freedom.FREE: "///", None: "xxx"}

WIDTHS = {"wide": 720.0, "narrow": 370.0}
"""Pixels of a figure on a page and on a phone, where text would be too small if the wide one were shrunk."""


@dataclass(frozen=True, eq=False)
class CaseReport:
    """The page of one case: its summary, and what lies beside the page.

    Attributes
    ----------
    summary : CaseSummary
    slug : str
        Stem of the page's name.
    motions : mapping of str to str
        Files of sampled motions by method.
    recording, viewer : str, optional
        Links to the recording and to the page with the viewer inside.
    source : str
        Name or path that loads the case again.
    trajectories : mapping of str to str
        Files for controllers, by what they are.
    """

    summary: CaseSummary
    slug: str
    motions: Mapping[str, str]
    recording: str | None
    viewer: str | None
    source: str
    trajectories: Mapping[str, str]

    @property
    def own(self) -> bool:
        """True for a case of one's own, which comes from no paper."""
        return paper_of(self.summary.case.paper) is None

    @property
    def budgets(self) -> list[int]:
        """Evaluations that the paper spends; none for a case without a paper."""
        case = self.summary.case
        return [case.settings.evaluations] if paper_of(case.paper) else []


def case_page(report: CaseReport, environment: Mapping[str, str], flags: Mapping[str, str]) -> str:
    """Page of a paper's case."""
    return filled("case.html.j2", contents_of(report) | {"flags": flags, "environment": environment})


def contents_of(report: CaseReport, series: Sequence[plot_style.Series] = (), hidden: bool = False) -> dict[str, Any]:
    """Everything that the page of a case shows; `series` stands in the profiles in the place of the featured methods.

    With `hidden` all but the first of them are switched off at first.
    """
    summary, case, problem = report.summary, report.summary.case, report.summary.case.problem
    own = bool(series)
    series, near = (
        (list(series), [each for each in series if not _too_long(each.motion, summary.best)])
        if own
        else featured_series(summary)
    )
    roles = {method.label: ROLE_NAMES[role] for _, role, method in reversed(summary.best.present())}
    pictures = {
        "profiles": [
            figures.profile(f"profile-{joint}", problem, joint, case.units[joint], near)
            for joint in range(problem.n_joints)
            if near
        ],
        "segments": {
            name: bars.segments(f"segments-{name}", series, width) for name, width in WIDTHS.items() if series
        },
        "ladder": {name: ladder_figure(summary, width) for name, width in WIDTHS.items() if summary.rungs and not own},
    }
    return {
        "report": report,
        "case": case,
        "problem": problem,
        "ends": ends_said(problem),
        "best": summary.best,
        "rungs": summary.rungs,
        "paper": paper_of(case.paper),
        "sentences": case_answer(summary.best, report.budgets),
        "names": names_explained(summary.methods),
        "role_of": roles,
        "groups": _groups(report),
        "known": known_times(summary.methods),
        "single": [method for method in summary.methods if method.joint is not None],
        "featured": summary.best.present(),
        "apart": summary.best.on_the_curve(),
        "steps": end_steps(summary),
        "series": series,
        "near": near,
        "left_out": [each for each in series if each not in near],
        "coinciding": _coinciding(near),
        "figures": pictures,
        "live": profiles_data(problem, case.units, near, roles, hidden) if near else "",
        "convergence": convergence_of(summary, WIDTHS),
        "tolerance": TOLERANCE,
        "collisions": any(":" in text for text in summary.driving.values()),
        "infinity": float("inf"),
        "arm": _arm(summary),
    }


def _arm(summary: CaseSummary) -> list[tuple[str, str, str, str]]:
    """Label and role of every featured method, the name of a limit of the arm, and its largest use in words."""
    return [
        (method.label, ROLE_NAMES[role], name, text)
        for _, role, method in summary.best.present()
        if (shown := method.representative) is not None and shown.verdict is not None
        for name, text in arm_uses(summary.case.problem, shown.verdict).items()
    ]


def featured_series(summary: CaseSummary) -> tuple[list[plot_style.Series], list[plot_style.Series]]:
    """Give the featured motions with their styles, and those of them that fit into one plot of profiles."""
    series = [
        plot_style.Series(method.label, summary.slots[method.label], method.motion)
        for _, _, method in summary.best.distinct()
        if method.motion is not None
    ]
    return series, [each for each in series if not _too_long(each.motion, summary.best)]


def _coinciding(series: Sequence[plot_style.Series]) -> list[tuple[str, str]]:
    """Pairs of names of motions that cannot be told apart in the figures, the second lying on the first."""
    shares = np.linspace(0.0, 1.0, 50)
    drawn = [(each.label, each.motion.duration, each.motion(shares * each.motion.duration)) for each in series]
    pairs = []
    for k, (label, duration, values) in enumerate(drawn):
        for other, length, places in drawn[:k]:
            away = np.abs(values - places).max(axis=0) / np.maximum(np.ptp(places, axis=0), 1e-9)
            if abs(duration - length) <= ALIKE * length and away.max() <= ALIKE:
                pairs.append((other, label))
                break
    return pairs


def _too_long(motion: Motion, best: Featured) -> bool:
    """Tell if a motion would squeeze the others' profiles."""
    usual = best.reference.duration if best.reference else None
    return usual is not None and motion.duration > TOO_LONG * usual


def _groups(report: CaseReport) -> list[tuple[str, str, list[tuple[MethodSummary, Record]]]]:
    """Rows of the results table in the groups that sorting keeps apart: feasible, infeasible, never judged."""
    rows = records(RESULTS, [(report.summary, method, report.source) for method in report.summary.whole])
    whole = list(zip(report.summary.whole, rows, strict=True))
    return [(name, head, [pair for pair in whole if pair[0].standing is name]) for name, head in STANDINGS.items()]


def ladder_figure(summary: CaseSummary, width: float = WIDTHS["wide"]) -> Markup:
    """Draw the ladder of lost time, so many pixels wide; there must be a rung."""
    on_curve = [rung for rung in summary.rungs if rung.freedom is Freedom.CURVE]
    optimum = on_curve[-1].seconds if on_curve else None
    groups = []
    for head, belongs in RUNGS.items():
        rungs = sorted((rung for rung in summary.rungs if belongs(rung)), key=lambda rung: -rung.seconds)
        if rungs:
            groups.append((head, [_bar(rung, summary, optimum) for rung in rungs]))
    return bars.ladder(f"ladder-{width:.0f}", groups, width)


RUNGS: dict[str, Callable[[Rung], bool]] = {
    "As printed": lambda rung: rung.name == "Published",
    "On the case's curve": lambda rung: rung.freedom is Freedom.CURVE and rung.name != "Published",
    "Along a fixed path": lambda rung: rung.freedom is Freedom.PATH,
    "Path between the waypoints free": lambda rung: rung.freedom is Freedom.FREE and rung.kind is not CauseKind.PROOF,
    "Proved": lambda rung: rung.kind is CauseKind.PROOF,
}
"""Groups of the ladder figure; in each the slowest stands first."""


def _bar(rung: Rung, summary: CaseSummary, optimum: float | None) -> plot_style.Bar:
    beside = (
        "" if optimum is None or rung.seconds == optimum else f"  ({formatting.percent(rung.seconds / optimum - 1)})"
    )
    labels = (rung.method, f"published: {rung.method}", rung.method.partition(", ")[0])
    return plot_style.Bar(
        label=f"{rung.name}: {rung.method}",
        value=formatting.seconds(rung.seconds) + beside + ("" if rung.feasible else "  infeasible"),
        seconds=rung.seconds,
        hatch=HATCHES[rung.freedom],
        solid=rung.feasible,
        slot=None
        if rung.kind is CauseKind.PROOF
        else next((summary.slots[label] for label in labels if label in summary.slots), None),
        note=rung.cause,
    )
