"""Write the pages of the comparison: self-contained HTML beside the report, with the tables and histories as files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from markupsafe import Markup

from study.analysis.palette import method_slots
from study.analysis.tables import Record, records, write_table
from study.comparison import ablations, audit_functions, audit_trajectories, claims_shown, figures, ranking, targets
from study.comparison.build import Comparison
from study.comparison.contestants import LEVELS, RUN_COLUMNS, Level, reference_grid, runs_of, solver_grid
from study.comparison.improvements import ABLATIONS
from study.comparison.ioh import write_ioh
from study.comparison.overview import limitations, summary
from study.errors import StudyError
from study.files import write_file
from study.report.live import Line, answering, over_evaluations, share_over, steps_data
from study.report.rendering import render, write_scripts
from study.report.sections import Section
from study.runs.selections import YARDSTICKS

PAGES = {
    "index": "Claims",
    "targets": "Targets",
    "tests": "Tests",
    "audit": "Invariance audit",
    "ablations": "Ablations",
}
N_STYLES = 7


@dataclass(frozen=True)
class Page:
    """A page without its frame."""

    title: str
    answer: Sequence[str]
    reading: Sequence[str]
    sections: Sequence[Section]


def write_pages(comparison: Comparison, out: Path, environment: Mapping[str, str]) -> Path:
    """Write all pages, tables and histories.

    Parameters
    ----------
    comparison : Comparison
    out : Path
        Folder, made if need be; the report's index, in its parent, is linked.
    environment : mapping of str to str
        Versions and machine, printed as they are.

    Returns
    -------
    Path
        The first page.

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    tables = tables_of(comparison)
    built = {
        "index": _claims_page(comparison),
        "targets": _targets_page(comparison),
        "tests": _tests_page(comparison),
        "audit": _audit_page(comparison),
        "ablations": _ablations_page(comparison),
    }
    shared = {
        "limits": limitations(comparison),
        "files": list(tables),
        "environment": environment,
    }
    segments = {name: case.problem.n_segments for name, case in comparison.cases.items()}
    try:
        (out / "tables").mkdir(parents=True, exist_ok=True)
        for name, rows in tables.items():
            write_table(out / "tables" / name, rows)
        write_ioh(out / "ioh", [run for level in comparison.field.levels.values() for run in level], segments)
        for slug, page in built.items():
            context = {**vars(page), **shared, "current": slug, "pages": PAGES, "flags": comparison.audit.flags}
            text = render("comparison.html.j2", context, package="study.comparison", root="../")
            write_file(out / f"{slug}.html", text)
        write_scripts(out.parent)
    except OSError as error:
        raise StudyError(
            f"the comparison cannot be written to {str(out)!r}: {error.strerror}; choose another folder"
        ) from None
    return out / "index.html"


def tables_of(comparison: Comparison) -> dict[str, list[Record]]:
    """Collect all findings as flat records, by the name of their file."""
    audit, field = comparison.audit, comparison.field
    runs = [run for level in (*field.levels.values(), field.solvers) for run in runs_of(level)]
    reached = [row for level in comparison.measured.values() for row in targets.target_rows(level)]
    pairs = [pair for level in comparison.pairings.values() for pair in level]
    functions = audit_functions.function_columns(audit.functions)
    return {
        "runs": records(RUN_COLUMNS, runs, audit.flags),
        "targets": records(targets.TARGET_COLUMNS, reached, audit.flags),
        "pairs": records(ranking.PAIR_COLUMNS, pairs, audit.flags),
        "ranks": records(ranking.RANK_COLUMNS, ranking.places(comparison.omnibus), audit.flags),
        "audit-functions": records(functions, audit.functions, audit.flags),
        "audit-trajectories": records(audit_trajectories.TRAJECTORY_COLUMNS, audit.trajectories, audit.flags),
        "ablations": records(ablations.COLUMNS, comparison.ablations, {}),
        "claims": records(claims_shown.COLUMNS, comparison.claims, audit.flags),
    }


def _claims_page(comparison: Comparison) -> Page:
    limits = {name: case.problem.limits for name, case in comparison.cases.items()}
    own = [claim.headline.case for claim in comparison.claims]
    velocity_only = [case for case in own if (limits[case].acceleration == float("inf")).any()]
    texts = (
        [
            f"{', '.join(velocity_only)}: the paper limits velocity but not acceleration, so off its curve a motion may change "
            "speed in an instant, which no arm can follow; what Ruckig gains there is no gain of a planner."
        ]
        if velocity_only
        else []
    )
    return Page(
        "A fair comparison of five papers' searches",
        summary(comparison),
        [
            "Each paper's claim compares its search with an opponent, or with durations, of its own choice; the columns to the "
            "right compare it with what could be had: a search that knows nothing, the optimum, and a solver that needs no search.",
            "Every motion was put before the same judge; a total that is shorter than the optimum belongs to runs that broke a limit.",
            "⚑ marks a search that the audit flags; every table of these pages shows it.",
        ],
        [
            Section(
                "The headline claims and their counterparts",
                texts,
                grids=[claims_shown.claim_grid(comparison.claims, comparison.audit.flags)],
            ),
            Section("In words", [claims_shown.claimed(claim) for claim in comparison.claims]),
        ],
    )


def _styles(comparison: Comparison) -> dict[str, int]:
    """Slots of the lines worth telling apart: those that reach most targets, then PSO and random search, then by rank."""
    tests, scaled = comparison.omnibus, comparison.field.levels[Level.SCALED]
    segments = {name: case.problem.n_segments for name, case in comparison.cases.items()}
    most = [[line.planner for line in targets.distributions(each, segments)] for each in comparison.measured.values()]
    ranked = tests[0].planners if tests else tuple(contestant.planner for contestant in scaled)
    first = [name for planners in most for name in [p for p in planners if p not in YARDSTICKS][:2]]
    first += [name for name in ("random-search", "pso") if name in ranked]
    chosen = list(dict.fromkeys([*first, *(name for name in ranked if name not in YARDSTICKS)]))[:N_STYLES]
    return method_slots(chosen, chosen)


def _targets_page(comparison: Comparison) -> Page:
    field, flags, styles = comparison.field, comparison.audit.flags, _styles(comparison)
    legend = [(style, name) for name, style in styles.items()]
    segments = {name: case.problem.n_segments for name, case in comparison.cases.items()}
    sections = [Section("References", grids=[reference_grid(field.references, flags)])]
    for level, measured in comparison.measured.items():
        shares = targets.distributions(measured, segments)
        drawn = [_distribution(level, shares, styles)] if shares else []
        sections.append(Section(f"Targets reached, {level} formulation", [f"{level}: {LEVELS[level]}."], drawn))
        sections.append(
            Section(
                f"Time to target and anytime curves, {level} formulation",
                figures=[_anytime(comparison, level, case, i, styles) for i, case in enumerate(field.references)],
                grids=[targets.target_grid(case, measured, flags) for case in field.references],
                legend=legend,
            )
        )
    sections.append(Section("Solvers", grids=[solver_grid(field.solvers, field.references)]))
    return Page(
        "How fast every planner comes how near",
        [targets.targets_reached(level, measured) for level, measured in comparison.measured.items()],
        [
            "A target is a share above the best known. The number below it is the average number of evaluations to reach it if a "
            "failed run is followed by another: all evaluations spent over the number of runs that reached it.",
            "Every search has the same budget of evaluations on a case, the same seeds, and no more information than the others.",
            "A line of the first figure that is higher reached more of all cases, runs and targets within as many evaluations; no "
            "restarts are simulated in it, so a line ends where the budget does. Thin lines are the other planners; every "
            "line has its name at its end.",
            "The bands of the anytime curves are quartiles over runs. Centre and one L-BFGS-B descent need the scaled formulation "
            "and stand with it in both levels.",
        ],
        sections,
    )


def _distribution(level: Level, lines: Sequence[targets.Distribution], styles: dict[str, int]) -> Markup:
    look = share_over(f"targets-{level}", "evaluations per segment")
    rows = [(line.costs, line.shares) for line in lines]
    named = [Line(line.planner, styles.get(line.planner)) for line in lines]
    data = steps_data(look, named, "share of targets reached", "reached", rows)
    return answering(data, figures.distribution(f"ecdf-{level}", lines, styles))


def _anytime(comparison: Comparison, level: Level, case: str, number: int, styles: dict[str, int]) -> Markup:
    own = [run for run in comparison.field.levels[level] if run.case == case and run.planner in styles]
    known = comparison.field.references[case].value
    curves = targets.anytime(own)
    look = over_evaluations(f"anytime-{level}-{number}", "At the end of the budget.", 300)
    rows = [(curve.evaluations, *np.maximum(curve.values[[1, 0, 2]] / known - 1.0, figures.LEAST)) for curve in curves]
    named = [Line(curve.planner, styles[curve.planner]) for curve in curves]
    data = steps_data(look, named, f"{case}: above the best known, median and quartiles", "above", rows)
    return answering(data, figures.anytime(f"anytime-{level}-{number}", case, curves, known, styles))


def _tests_page(comparison: Comparison) -> Page:
    flags = comparison.audit.flags
    sections = [
        Section(
            f"Over cases, {test.level} formulation",
            [ranking.weakness(test)],
            [figures.critical_difference(f"cd-{test.level}", test)],
            [ranking.rank_grid(test, flags)],
        )
        for test in comparison.omnibus
    ]
    for level, pairs in comparison.pairings.items():
        tables = ranking.pairing_grids(pairs, flags)
        sections.append(Section(f"Case by case, {level} formulation", grids=tables, folded=True))
    return Page(
        "Which differences are real",
        [*map(ranking.ranking, comparison.omnibus), *map(ranking.weakness, comparison.omnibus[:1])],
        [
            "A12 is the probability that a run of the planner is shorter than one of the control: 0.5 is no difference, 0.71 is large.",
            "The median difference is planner minus control on the same seed, as a share of the best known, with a bootstrap interval.",
            "p-values of a case are adjusted by Holm for its planners; durations within the judge's tolerance of 1e-6 are ties.",
            "Friedman's test ranks the medians over cases, since runs of one case do not stand for other cases. An infeasible median "
            "ranks last.",
        ],
        sections,
    )


def _audit_page(comparison: Comparison) -> Page:
    audit, effort = comparison.audit, comparison.effort
    drawn = [figures.rows_of_marks(audit_functions.function_plot(audit.functions))] if audit.functions else []
    viewed = [figures.rows_of_marks(plot) for plot in audit_trajectories.trajectory_plots(audit.trajectories)]
    return Page(
        "Invariance audit: does a result depend on where the origin is?",
        [
            audit_functions.functions_audited(audit.functions),
            audit_functions.axes_audited(audit.functions),
            audit_trajectories.trajectories_audited(audit.trajectories),
        ],
        [
            "A sound search gives the same results wherever the optimum lies. The error with the optimum shifted, by a random amount in "
            "every coordinate, over the error with it at the origin should be about 1; above 10 is Kudela's alarm level. Rotated "
            "functions are shifted as far and compared with the shifted ones, so that place and direction stay apart.",
            f"Functions: {', '.join(effort.functions)}, {effort.dimensions} dimensions, {effort.population} candidates, "
            f"{effort.generations} generations, {effort.function_seeds} runs; dose and diagonal tests on {', '.join(effort.dosed)}.",
            "The dose test moves the optimum by a ten-thousandth, a hundredth and three tenths of the half range; the diagonal test puts "
            "it at the same distance on the line of equal coordinates or off it; there medians count, not a few runs stuck on a wall.",
            "On the trajectory problems the search moves the durations themselves, reflected ones, or ones measured from the middle of "
            "their range. A search that is better with the durations as they are may be flattered by a pull to zero.",
        ],
        [
            Section("Functions", figures=drawn, grids=[audit_functions.function_grid(audit.functions, audit.flags)]),
            Section(
                "Trajectory problems",
                figures=viewed,
                grids=[audit_trajectories.trajectory_grid(audit.trajectories, audit.flags)],
            ),
        ],
    )


def _ablations_page(comparison: Comparison) -> Page:
    sections = (
        [Section("All at a glance", grids=[ablations.matrix(comparison.ablations)])] if comparison.ablations else []
    )
    for ablation in ABLATIONS:
        own = ablations.of_paper(comparison.ablations, ablation)
        drawn = [figures.rows_of_marks(ablations.ablation_plot(ablation, own))] if own else []
        sections.append(Section(ablation.title, figures=drawn, grids=[ablations.ablation_grid(ablation, own)]))
    return Page(
        "The ablations that the papers owe",
        [ablations.matters(comparison.ablations)],
        [
            "Each improvement is switched on by itself on the paper's plain search, and then all together; the same seeds for all.",
            "An effect counts when A12 is at least 0.71 or at most 0.29, the signed rank test, adjusted by Holm for the paper's forms "
            "on the task, gives p below 0.05, and the bootstrap interval excludes zero.",
            "Functions with the optimum at the origin show what the papers measured, shifted ones what is left of it.",
        ],
        sections,
    )
