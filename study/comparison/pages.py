"""Write the pages of the comparison: self-contained HTML beside the report, with the tables and histories as files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from study.comparison import figures, grids, records, sentences
from study.comparison.ablations import ABLATIONS, PLAIN
from study.comparison.build import Comparison
from study.comparison.contestants import LEVELS
from study.comparison.differences import CONTROLS
from study.comparison.grids import Grid
from study.comparison.ioh import write_ioh
from study.comparison.performance import anytime, distributions
from study.errors import StudyError
from study.report.rendering import render
from study.runs.selections import YARDSTICKS

PAGES = {
    "index": "Claims",
    "targets": "Targets",
    "tests": "Tests",
    "audit": "Invariance audit",
    "ablations": "Ablations",
}
N_STYLES = 6


@dataclass(frozen=True)
class Section:
    """One part of a page."""

    title: str
    texts: Sequence[str] = ()
    figures: Sequence[Markup] = ()
    grids: Sequence[Grid] = ()
    legend: Sequence[tuple[int, str]] = ()
    folded: bool = False


@dataclass(frozen=True)
class Page:
    """A page without its frame."""

    title: str
    answer: Sequence[str]
    reading: Sequence[str]
    sections: Sequence[Section]


def write_pages(found: Comparison, out: Path, environment: Mapping[str, str]) -> Path:
    """Write all pages, tables and histories.

    Parameters
    ----------
    found : Comparison
    out : Path
        Folder, made if need be; a report's index in its parent is linked.
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
    tables = tables_of(found)
    built = {
        "index": _claims_page(found),
        "targets": _targets_page(found),
        "tests": _tests_page(found),
        "audit": _audit_page(found),
        "ablations": _ablations_page(found),
    }
    shared = {
        "limits": sentences.limitations(found),
        "files": list(tables),
        "linked": (out.parent / "index.html").is_file(),
        "environment": environment,
    }
    segments = {name: case.problem.n_segments for name, case in found.cases.items()}
    try:
        (out / "tables").mkdir(parents=True, exist_ok=True)
        records.write_tables(out / "tables", tables)
        write_ioh(out / "ioh", [one for level in found.levels.values() for one in level], segments)
        for slug, page in built.items():
            context = {**vars(page), **shared, "current": slug, "pages": PAGES, "flags": found.flags}
            text = render("comparison.html.j2", context, package="study.comparison")
            (out / f"{slug}.html").write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise StudyError(
            f"the comparison cannot be written to {str(out)!r}: {error.strerror}; choose another folder"
        ) from None
    return out / "index.html"


def tables_of(found: Comparison) -> dict[str, list[records.Record]]:
    """Collect all findings as flat records, by the name of their file."""
    runs = [one for level in (*found.levels.values(), found.solvers) for one in level]
    return {
        "runs": records.run_records(runs, found.flags),
        "targets": [r for level in found.measured.values() for r in records.performance_records(level, found.flags)],
        "pairs": [r for level in found.pairings.values() for r in records.pairing_records(level, found.flags)],
        "ranks": records.rank_records(found.omnibus, found.flags),
        "audit-functions": records.audit_records(found.functions, found.flags),
        "audit-trajectories": records.view_records(found.trajectories, found.flags),
        "ablations": records.ablation_records(found.ablations),
        "claims": records.claim_records(found.claims, found.flags),
    }


def _claims_page(found: Comparison) -> Page:
    limits = {name: case.problem.limits for name, case in found.cases.items()}
    own = [one.headline.case for one in found.claims]
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
        sentences.summary(found),
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
                grids=[grids.claim_grid(found.claims, found.flags)],
            ),
            Section("In words", [sentences.claimed(one) for one in found.claims]),
        ],
    )


def _styles(found: Comparison) -> dict[str, int]:
    """Styles of the lines worth telling apart: the trivial opponents that move, PSO, and the best searches by rank."""
    ranked = found.omnibus[0].planners if found.omnibus else tuple(one.planner for one in found.levels["scaled"])
    first = [name for name in ("lbfgsb-once", "random-search", "pso") if name in ranked]
    rest = [name for name in dict.fromkeys(ranked) if name not in (*first, *YARDSTICKS)]
    return {name: style for style, name in enumerate([*first, *rest][:N_STYLES])}


def _targets_page(found: Comparison) -> Page:
    styles = _styles(found)
    legend = [(style, name) for name, style in styles.items()]
    segments = {name: case.problem.n_segments for name, case in found.cases.items()}
    sections = [Section("References", grids=[grids.reference_grid(found.references.values(), found.flags)])]
    for level, measured in found.measured.items():
        shares = distributions(measured, segments)
        drawn = [figures.distribution(f"ecdf-{level}", shares, styles)] if shares else []
        sections.append(
            Section(f"Targets reached, {level} formulation", [f"{level}: {LEVELS[level]}."], drawn, legend=legend)
        )
        sections.append(
            Section(
                f"Time to target and anytime curves, {level} formulation",
                figures=[_anytime(found, level, case, i, styles) for i, case in enumerate(found.references)],
                grids=[
                    grids.target_grid(case, [one for one in measured if one.contestant.case == case], found.flags)
                    for case in found.references
                ],
                legend=legend,
            )
        )
    sections.append(Section("Solvers", grids=[grids.solver_grid(found.solvers, found.references)]))
    return Page(
        "How fast every planner comes how near",
        [sentences.targets_reached(level, measured) for level, measured in found.measured.items()],
        [
            "A target is a share above the best known. The number below it is the average number of evaluations to reach it if a "
            "failed run is followed by another: all evaluations spent over the number of runs that reached it.",
            "Every search has the same budget of evaluations on a case, the same seeds, and no more information than the others.",
            "A line of the first figure that is higher reached more of all cases, runs and targets within as many evaluations; no "
            "restarts are simulated in it, so a line ends where the budget does. Thin lines are the other planners, whose numbers "
            "stand in the tables.",
            "The bands of the anytime curves are quartiles over runs. Centre and one L-BFGS-B descent need the scaled formulation "
            "and stand with it in both levels.",
        ],
        sections,
    )


def _anytime(found: Comparison, level: str, case: str, number: int, styles: dict[str, int]) -> Markup:
    own = [one for one in found.levels[level] if one.case == case and one.planner in styles]
    return figures.anytime(f"anytime-{level}-{number}", case, anytime(own), found.references[case].value, styles)


def _tests_page(found: Comparison) -> Page:
    sections = []
    for one in found.omnibus:
        title = f"Over cases, {one.level} formulation"
        drawn = [figures.critical_difference(f"cd-{one.level}", one)]
        sections.append(Section(title, [sentences.weakness(one)], drawn, [grids.rank_grid(one, found.flags)]))
    for level, pairs in found.pairings.items():
        tables = [
            grids.pairing_grid(case, control, chosen, found.flags)
            for case in found.references
            for control in CONTROLS
            if (chosen := [one for one in pairs if one.case == case and one.control == control])
        ]
        sections.append(Section(f"Case by case, {level} formulation", grids=tables, folded=True))
    return Page(
        "Which differences are real",
        [sentences.ranking(one) for one in found.omnibus] + [sentences.weakness(one) for one in found.omnibus[:1]],
        [
            "A12 is the probability that a run of the planner is shorter than one of the control: 0.5 is no difference, 0.71 is large.",
            "The median difference is planner minus control on the same seed, as a share of the best known, with a bootstrap interval.",
            "p-values of a case are adjusted by Holm for its planners; durations within the judge's tolerance of 1e-6 are ties.",
            "Friedman's test ranks the medians over cases, since runs of one case do not stand for other cases. An infeasible median "
            "ranks last.",
        ],
        sections,
    )


def _audit_page(found: Comparison) -> Page:
    drawn = [figures.ratios("ratios", found.functions)] if found.functions else []
    keys = list(dict.fromkeys((one.case, one.formulation) for one in found.trajectories))
    viewed = [
        figures.views(
            f"views-{i}",
            f"{case}, {formulation} formulation",
            [one for one in found.trajectories if (one.case, one.formulation) == (case, formulation)],
        )
        for i, (case, formulation) in enumerate(keys)
    ]
    effort = found.effort
    return Page(
        "Invariance audit: does a result depend on where the origin is?",
        [
            sentences.functions_audited(found.functions),
            sentences.axes_audited(found.functions),
            sentences.trajectories_audited(found.trajectories),
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
            Section("Functions", figures=drawn, grids=[grids.function_grid(found.functions, found.flags)]),
            Section("Trajectory problems", figures=viewed, grids=[grids.view_grid(found.trajectories, found.flags)]),
        ],
    )


def _ablations_page(found: Comparison) -> Page:
    sections = []
    for i, one in enumerate(ABLATIONS):
        own = [finding for finding in found.ablations if finding.paper == one.paper]
        drawn = [figures.effects(f"effects-{i}", one.title, own)] if own else []
        plain = f"{PLAIN}: {one.plain}"
        sections.append(Section(one.title, figures=drawn, grids=[grids.ablation_grid(one.title, plain, own)]))
    return Page(
        "The ablations that the papers owe",
        [sentences.matters(found.ablations), *sentences.improvements(found.ablations)],
        [
            "Each improvement is switched on by itself on the paper's plain search, and then all together; the same seeds for all.",
            "An effect counts when A12 is at least 0.71 or at most 0.29, the signed rank test, adjusted by Holm for the paper's forms "
            "on the task, gives p below 0.05, and the bootstrap interval excludes zero.",
            "Functions with the optimum at the origin show what the papers measured, shifted ones what is left of it.",
        ],
        sections,
    )
