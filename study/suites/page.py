"""The page of a suite: the answer, the law and its figure, scores, costs, profiles, effect sizes, ranks, and every problem's best time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from markupsafe import Markup

from study.analysis.formatting import listed, percent, plural, wall
from study.analysis.palette import method_slots
from study.analysis.tables import Grid, write_table
from study.cases.records import ProblemRecords
from study.cases.suites import Suite
from study.comparison.statistics import critical_difference, friedman
from study.comparison.targets import target_name
from study.files import write_file
from study.report.live import Line, answering, share_over, steps_data
from study.report.plot_style import SERIES
from study.report.rendering import render, write_scripts
from study.report.sections import Section
from study.suites import figures
from study.suites.choosing import score_sums
from study.suites.effects import against, control_of, effects, effects_by_problem, featured
from study.suites.growth import Axis, growing
from study.suites.law import grown_at, largest_budget, law_grid, paragraph
from study.suites.measures import FAILED, NEAR, SHIFT, Field, Score, scores, table_of_problems
from study.suites.profiles import Profile, data_profiles, performance_profiles
from study.suites.runs import plain
from study.suites.tables import (
    best_grid,
    cost_grid,
    cost_records,
    effect_grid,
    effect_matrix,
    score_grid,
    trait_grid,
    traits,
)
from study.suites.targets import TARGETS, costs, costs_by_size, near_profiles, runtime_distributions


def write_page(
    suite: Suite,
    field: Field,
    records: Mapping[str, ProblemRecords],
    papers: figures.Marks,
    out: Path,
    environment: Mapping[str, str],
) -> Path:
    """Write the page, and runs, costs and effect sizes as files.

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
    ranked = scores(field)
    shown = featured(field, ranked)
    control = control_of(field, shown)
    files = {
        "runs": plain(field.runs),
        "costs": cost_records([*costs(field), *costs_by_size(field, growing(field))]),
        "effects": effects_by_problem(field, shown, control) if control else [],
    }
    for name, rows in files.items():
        if rows:
            write_table(out / name, rows)
    sections = [
        *_law(field, papers),
        Section("Scores", [_explained()], grids=[score_grid(ranked)], data=score_sums(suite, field)),
        *_costs(field),
        *_profiles(field, shown),
        *_effects(field, shown, control),
        *_ranks(field),
        _by_trait(suite, field),
        Section("Best known times", grids=[best_grid(suite, field, records)]),
    ]
    context = {
        "title": f"Suite {suite.name}: {suite.about}",
        "answer": answer(suite, field, ranked),
        "sections": sections,
        "files": [name for name, rows in files.items() if rows],
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
        f"{target_name(SHIFT)}) over all runs, where one without a feasible motion counts with {target_name(FAILED)}. Near is "
        f"within {target_name(NEAR)} of the best known of any kind; the columns give the share of all runs that were near within a "
        "wall time."
    )


def _law(field: Field, papers: figures.Marks) -> list[Section]:
    budget = largest_budget(field)
    if not budget:
        return []
    text = paragraph(field, budget)
    lines = grown_at(field, budget)
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
    first = Section("How far methods fall behind", [text, *marks], [picture], [law_grid(field, budget)], legend)
    return [first, *_other_laws(field, budget)]


def _other_laws(field: Field, budget: int) -> list[Section]:
    """Growth with jerk limits, and with the number of joints, where it was run."""
    sections = []
    cuts: Sequence[tuple[Axis, bool]] = (("segments", True), ("joints", False), ("joints", True))
    for axis, jerk in cuts:
        if lines := grown_at(field, budget, axis, jerk):
            styles = method_slots([each.planner for each in lines][: len(SERIES)])
            drawn = [each for each in lines if each.planner in styles]
            picture = figures.growth(f"growth-{axis}-{jerk:d}", drawn, styles, axis=axis)
            legend = [(style, name) for name, style in styles.items()]
            title = f"By {axis}, {'with' if jerk else 'without'} jerk limits"
            sections.append(Section(title, [], [picture], [law_grid(field, budget, axis, jerk)], legend, folded=True))
    return sections


def _costs(field: Field) -> list[Section]:
    every = costs(field)
    if not every:
        return []
    text = (
        "A failed run is followed by another until one comes so near: all evaluations, and all wall time, over the number of runs that "
        "did. The best known is that of the method's own kind of motion; wall time is spread evenly over a run's evaluations."
    )
    sized = costs_by_size(field, growing(field))
    section = Section("Cost to come near", [text], grids=[cost_grid(every)])
    if len({cost.segments for cost in sized}) < 3:
        return [section]
    budget = largest_budget(field)
    last = [cost for cost in sized if field.by_method[cost.method][0].evaluations == budget]
    styles = _styles(field, sorted({cost.method for cost in last}))
    picture = figures.costs("costs", last, styles, TARGETS.index(NEAR))
    said = f"Searches by size, {budget:,} evaluations: what it costs to come within {target_name(NEAR)}; a line ends where no run did."
    legend = [(style, name) for name, style in styles.items()]
    return [section, Section("Cost by size", [said], [picture], [cost_grid(sized)], legend, folded=True)]


def _styles(field: Field, methods: Sequence[str]) -> dict[str, int]:
    slots = method_slots([field.by_method[name][0].planner for name in methods][: len(SERIES)])
    return {name: slots[planner] for name in methods if (planner := field.by_method[name][0].planner) in slots}


def _profiles(field: Field, shown: Sequence[str]) -> list[Section]:
    styles = _styles(field, shown)
    near = target_name(NEAR)
    wanted = (
        ("Performance profiles", "Share of runs within a factor of the best known of any kind (Dolan and More 2002).",
         performance_profiles(field), "times the best known"),
        ("Data profiles over wall time", f"Share of runs within {near} of the best known of any kind, by wall time.",
         data_profiles(field), "s of wall time"),
        ("Data profiles over evaluations",
         f"Share of a search's runs that came within {near} of the best known of their own kind, by evaluations over segments + 1, "
         "which is what one gradient by differences costs (More and Wild 2009).", near_profiles(field), "evaluations / (segments + 1)"),
        ("Targets reached", "Share of all runs and of 41 targets, from 100 % to 0.01 % above the best known of the own kind, that a search "
         "reached within so many evaluations per segment, as COCO draws it; no restarts are simulated.",
         runtime_distributions(field), "evaluations per segment"),
    )  # fmt: skip
    return [
        Section(title, [text], [_shares(f"shares-{number}", lines, styles, unit, title)], legend=_legend(styles, lines))
        for number, (title, text, every, unit) in enumerate(wanted)
        if (lines := [line for line in every if line.method in styles and len(line.x)])
    ]


def _legend(styles: Mapping[str, int], lines: Sequence[Profile]) -> list[tuple[int, str]]:
    return [(styles[line.method], line.method) for line in lines]


def _shares(key: str, lines: Sequence[Profile], styles: Mapping[str, int], unit: str, title: str) -> Markup:
    named = [Line(line.method, styles[line.method]) for line in lines]
    last = max(line.x[-1] for line in lines)
    rows = [(np.append(line.x, last), np.append(line.share, line.share[-1])) for line in lines]
    data = steps_data(share_over(key, unit), named, title, "share", rows)
    return answering(data, figures.profiles(key, lines, styles, unit, title))


def _effects(field: Field, shown: Sequence[str], control: str) -> list[Section]:
    pairs = effects(field, shown)
    if not pairs:
        return []
    own = against(pairs, control)
    text = (
        "A12 is the probability that a run of one method is shorter than a run of the other on the same problem, over the seeds of both; "
        "from 0.71 on Vargha and Delaney call it large. Durations that differ by less than the judge's tolerance tie, and a run without a "
        "feasible motion is longer than any other."
    )
    return [Section("Effect sizes", [text], grids=[effect_grid(own, control), effect_matrix(pairs, shown)])]


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


def _by_trait(suite: Suite, field: Field) -> Section:
    grids = [trait_grid(field, name, trait) for name, trait in traits(suite).items()]
    return Section("By task, robot and limits", grids=[table for table in grids if len(table.head) > 2], folded=True)
