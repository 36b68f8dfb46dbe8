"""The page of a suite: the answer, the law and its figure, scores, profiles, ranks, failures, and every problem's best time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from markupsafe import Markup

from study.analysis.formatting import bare_seconds, listed, percent, plural, wall
from study.analysis.palette import method_slots
from study.analysis.tables import Grid, write_table
from study.cases.records import ProblemRecords
from study.cases.suites import Suite
from study.comparison.statistics import critical_difference, friedman
from study.files import write_file
from study.planning import Freedom
from study.report.plot_style import SERIES
from study.report.rendering import render, write_scripts
from study.suites import figures
from study.suites.law import growths, largest_budget, law_grid, paragraph
from study.suites.measures import (
    FAILED,
    NEAR,
    SHIFT,
    TIMES,
    Field,
    Score,
    scores,
    shifted_mean,
    table_of_problems,
)
from study.suites.profiles import Profile, data_profiles, performance_profiles
from study.suites.runs import Run, plain


@dataclass(frozen=True)
class Section:
    """One part of the page."""

    title: str
    texts: Sequence[str] = ()
    figures: Sequence[Markup] = ()
    grids: Sequence[Grid] = ()
    legend: Sequence[tuple[int, str]] = ()
    folded: bool = False


def write_page(
    suite: Suite,
    field: Field,
    records: Mapping[str, ProblemRecords],
    papers: figures.Marks,
    out: Path,
    environment: Mapping[str, str],
) -> Path:
    """Write the page and all runs as files.

    Parameters
    ----------
    suite : Suite
    field : Field
    records : mapping of str to ProblemRecords
        Committed best times.
    papers : sequence of (case, segments, gap, planner)
        Marks in the figure of growth.
    out : Path
        Folder inside the report's, made if need be.
    environment : mapping of str to str
        Versions and machine.
    """
    out.mkdir(parents=True, exist_ok=True)
    write_table(out / "runs", plain(field.runs))
    ranked = scores(field)
    sections = [
        *_law(field, papers),
        Section("Scores", [_explained()], grids=[score_grid(ranked)]),
        *_profiles(field, ranked),
        *_ranks(field),
        *_by_trait(suite, field),
        Section("Failures", [_failures(ranked)]),
        Section("Best known times", grids=[best_grid(field, records)], folded=True),
    ]
    context = {
        "title": f"Suite {suite.name}: {suite.about}",
        "answer": answer(suite, field, ranked),
        "sections": sections,
        "environment": environment,
    }
    text = render("suite.html.j2", context, package="study.suites", root="../")
    write_scripts(out.parent)
    return write_file(out / "index.html", text)


def answer(suite: Suite, field: Field, ranked: Sequence[Score]) -> list[str]:
    """Sentences at the head of the page."""
    problems = len({run.problem for run in field.runs})
    asked = f"{plural(problems, 'problem')} of {len(suite.cases)}, version {suite.version}, checksum {suite.checksum}."
    if not ranked:
        return [asked, "No planner was run, only bounds."]
    best = ranked[0]
    first = (
        f"{best.method} is nearest to the best known: {percent(best.gap_any)} on average, {best.feasible} of {best.runs} runs feasible, "
        f"median {wall(best.wall_time)}."
    )
    searches = [score for score in ranked if any(r.evaluations for r in field.by_method[score.method])]
    law = f"The best search is {searches[0].method}: {percent(searches[0].gap_any)}." if searches else ""
    return [text for text in (asked, first, law) if text]


def _explained() -> str:
    return (
        f"Gap: duration above the best known of any kind of motion, and of the method's own kind; the shifted geometric mean (shift "
        f"{percent(SHIFT, signed=False)}) over all runs, where one without a feasible motion counts with {percent(FAILED, signed=False)}. Near is "
        f"within {percent(NEAR, signed=False)} of the best known of any kind; the columns give the share of all runs that were near within a "
        "wall time."
    )


def score_grid(ranked: Sequence[Score]) -> Grid:
    """Table of scores."""
    head = ["Method", "Kind", "Feasible", "Gap", "Own kind", *(f"Near in {t:g} s" for t in TIMES), "Median time"]
    rows = [
        [
            score.method,
            score.kind,
            f"{score.feasible}/{score.runs}",
            percent(score.gap_any),
            percent(score.gap_own),
            *(percent(share, signed=False) for share in score.within),
            wall(score.wall_time),
        ]
        for score in ranked
    ]
    return Grid("Every method over the suite, the nearest first.", head, rows, names=2)


def _law(field: Field, papers: figures.Marks) -> list[Section]:
    budget = largest_budget(field)
    if not budget:
        return []
    text = paragraph(field, budget)
    lines = [each for each in growths(field) if each.evaluations == budget]
    styles = method_slots(sorted({each.planner for each in lines})[: len(SERIES)])
    drawn = [each for each in lines if each.planner in styles]
    stars = listed([f"{name} ({planner})" for name, _, _, planner in papers])
    marks = [
        *(
            [f"Stars are the papers' five cases under their own limits, each with its own paper's search: {stars}."]
            if stars
            else []
        ),
        f"Gaps below {100 * figures.LEAST:g} % are drawn there.",
    ]
    picture = figures.growth("growth", drawn, styles, papers)
    legend = [(style, name) for name, style in styles.items()]
    return [
        Section(
            "How far methods fall behind",
            [text, *marks],
            [picture],
            [law_grid(field, budget)],
            legend,
        )
    ]


def _profiles(field: Field, ranked: Sequence[Score]) -> list[Section]:
    budget = max((run.evaluations for run in field.runs), default=0)
    shown = [s.method for s in ranked if field.by_method[s.method][0].evaluations in (0, budget)][: len(SERIES)]
    slots = method_slots([field.by_method[name][0].planner for name in shown])
    styles = {name: slots[field.by_method[name][0].planner] for name in shown}

    def picked(lines: Sequence[Profile]) -> list[Profile]:
        return [line for line in lines if line.method in styles]

    performance = figures.profiles(
        "performance",
        picked(performance_profiles(field)),
        styles,
        "duration over the best known",
        "Performance profiles",
    )
    data = figures.profiles("data", picked(data_profiles(field)), styles, "wall time, s", "Data profiles")
    legend = [(style, name) for name, style in styles.items()]
    return [
        Section(
            "Performance profiles", ["Share of runs within a factor of the best known."], [performance], legend=legend
        ),
        Section(
            "Data profiles", ["Share of runs that are near the best known within a wall time."], [data], legend=legend
        ),
    ]


def _ranks(field: Field) -> list[Section]:
    methods, problems, values = table_of_problems(field)
    if len(methods) < 3 or len(problems) < 2:
        return []
    test = friedman(values)
    difference = critical_difference(len(methods), len(problems))
    rows = [[methods[k], f"{test.mean_ranks[k]:.2f}"] for k in np.argsort(test.mean_ranks)]
    text = (
        f"Friedman's test over {len(problems)} problems: p {test.p:.2g}. Mean ranks that differ by {difference:.2f} or more differ by "
        "Nemenyi's test at 5 %. Medians over seeds are ranked; a failure ranks last."
    )
    return [Section("Ranks", [text], grids=[Grid("Mean rank, 1 is best.", ["Method", "Mean rank"], rows)])]


def _by_trait(suite: Suite, field: Field) -> list[Section]:
    traits: dict[str, Callable[[Run], str]] = {
        "joints": lambda run: plural(run.joints, "joint"),
        "limits": lambda run: "with jerk limits" if run.jerk else "without jerk limits",
    }
    if suite.problems:
        traits |= {
            "task": lambda run: suite.problems[run.problem].tags[0],
            "robot": lambda run: suite.problems[run.problem].robot or "no robot",
        }
    grids = [_trait_grid(field, name, trait) for name, trait in traits.items()]
    return [Section("By task, robot and limits", grids=[grid for grid in grids if len(grid.head) > 2], folded=True)]


def _trait_grid(field: Field, name: str, trait: Callable[[Run], str]) -> Grid:
    values = sorted({trait(run) for run in field.runs})
    rows = []
    for method, runs in field.by_method.items():
        groups = {key: list(group) for key, group in groupby(sorted(runs, key=trait), trait)}
        means = [
            shifted_mean([field.gap(run, own_kind=False) for run in groups[each]]) if each in groups else None
            for each in values
        ]
        rows.append([method, *map(percent, means)])
    return Grid(f"Gap to the best known of any kind, by {name}.", ["Method", *values], rows)


def _failures(ranked: Sequence[Score]) -> str:
    parts = [
        f"{score.method}: {listed([f'{count} {reason}' for reason, count in score.failures.items()])}"
        for score in ranked
        if score.failures
    ]
    return "Runs without a feasible motion, counted in every number above: " + ("; ".join(parts) or "none") + "."


def best_grid(field: Field, records: Mapping[str, ProblemRecords]) -> Grid:
    """Best known time of every problem by kind of motion, who found it, and the proved bound."""
    bounds = {name: each.bound or 0.0 for name, each in records.items()}
    for run in field.runs:
        bounds[run.problem] = max(bounds.get(run.problem, 0.0), run.bound if run.kind == "bound" else 0.0)
    sizes = {run.problem: (run.segments, run.joints) for run in field.runs}
    rows = []
    for name, (segments, joints) in sorted(sizes.items()):
        times = [bare_seconds(field.best.get((name, str(kind)))) for kind in Freedom]
        bound, best = bounds.get(name, 0.0), field.best_of_any.get(name)
        above = percent(best / bound - 1.0) if best and bound else percent(None)
        rows.append([name, str(segments), str(joints), *times, bare_seconds(bound or None), above])
    head = ["Problem", "Segments", "Joints", *(f"{kind}, s" for kind in Freedom), "Bound, s", "Best above bound"]
    return Grid("Best known times and the proved bound of any motion.", head, rows)
