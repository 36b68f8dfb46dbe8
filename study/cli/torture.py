"""`study torture`: random problems for every reference planner."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Mapping
from typing import Annotated

import typer
from rich.table import Table

from study.api import TIERS
from study.cli.screen import make_console, progress_bar
from study.cli.shared import Jobs, names_in
from study.errors import Interrupted, StudyError, plural
from study.registry import planner_named
from study.runs.runner import default_jobs
from study.testing.attacks import ATTACKS
from study.testing.stress import ENDS, MUST_NOT, AttemptEnd, reference_planners
from study.testing.stress import torture as run_torture
from study.testing.two_judges import AGREEMENTS, compare_judges


def torture(
    problems: Annotated[int, typer.Option(help="How many random problems.", min=1)] = 1000,
    seed: Annotated[int, typer.Option(help="Of the problems.")] = 0,
    planners: Annotated[
        list[str] | None,
        typer.Option(
            "--planners",
            "--planner",
            help="Names or tiers (best, fast) separated by commas; every deterministic planner by default.",
        ),
    ] = None,
    time_limit: Annotated[float, typer.Option(help="Seconds for each planner on each problem.", min=0.1)] = 5.0,
    jobs: Jobs = None,
    judges: Annotated[
        int, typer.Option(help="Instead, put so many random and adversarial motions to two independent judges.", min=0)
    ] = 0,
) -> None:
    """Put random problems of every kind (1-8 joints, 2-200 waypoints, six decades) to planners; ends with 3 if one crashes, hangs or is wrong."""
    if judges:
        return _compare(judges, seed, default_jobs() if jobs is None else jobs)
    names = names_in(planners) or reference_planners()
    for name in names:
        if name not in TIERS:
            planner_named(name)
    jobs = default_jobs() if jobs is None else jobs
    if jobs < 1:
        raise StudyError(f"the number of jobs must be at least 1, got {jobs}")
    console, counts, instants = make_console(), {name: Counter[str]() for name in names}, 0
    with progress_bar(console) as progress:
        task = progress.add_task("running", total=problems * len(names))

        def finished(end: AttemptEnd) -> None:
            nonlocal instants
            attempt = end.attempt
            instants += end.instants
            counts[attempt.planner][end.kind] += 1
            progress.update(task, advance=1, description=f"problem {attempt.number}: {attempt.planner}")
            if end.kind in MUST_NOT:
                console.print(f"{end.kind}: {attempt.planner} on problem {attempt.number}: {end.sentence}")

        with contextlib.suppress(KeyboardInterrupt):
            run_torture(names, problems, seed, time_limit, jobs, finished)
    done = min(count.total() for count in counts.values())
    console.print(_table(counts, done, seed))
    console.print(
        f"every feasible motion passed the exact judge and an independent sampler, {instants:,} instants in all; "
        "a hang is a planner still at work 10 s after twice its time limit"
    )
    if done < problems:
        raise Interrupted(f"interrupted after {done} of {plural(problems, 'problem')}; the table counts what was done")
    if any(count[kind] for count in counts.values() for kind in MUST_NOT):
        raise typer.Exit(3)


def _compare(motions: int, seed: int, jobs: int) -> None:
    """Print how the judge and the second judge agree; ends with 3 if they differ."""
    console = make_console()
    with progress_bar(console) as progress:
        task = progress.add_task("judging twice", total=motions)
        agreement = compare_judges(motions, seed, jobs, lambda done: progress.advance(task, done))
    table = Table(
        title=f"{motions:,} {'motion' if motions == 1 else 'motions'}, seed {seed}, judged twice",
        title_justify="left",
        header_style="bold",
    )
    table.add_column("attack")
    for outcome in AGREEMENTS:
        table.add_column(outcome, justify="right")
    for attack in ATTACKS:
        table.add_row(attack, *(f"{agreement.counts[attack, outcome]:,}" for outcome in AGREEMENTS))
    table.add_row("all", *(f"{agreement.total(outcome):,}" for outcome in AGREEMENTS), style="bold")
    console.print(table)
    for sentence in agreement.different:
        console.print(sentence, markup=False)
    if agreement.different:
        raise typer.Exit(3)


def _table(counts: Mapping[str, Counter[str]], problems: int, seed: int) -> Table:
    table = Table(title=f"{problems} random problems, seed {seed}", title_justify="left", header_style="bold")
    table.add_column("planner")
    for kind in ENDS:
        table.add_column(kind, justify="right")
    for name, count in counts.items():
        table.add_row(name, *(f"{count[kind]:,}" for kind in ENDS))
    return table
