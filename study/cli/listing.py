"""Commands that list data: `study list`, `study ledger` and `study cases show`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from study.cases.ledger import ledger as ledger_entries
from study.cases.library import case_names, load_case
from study.cases.suites import Suite, suite_named, suite_names
from study.cli import terminal
from study.cli.screen import SafeConsole, fitted, make_console
from study.errors import plural
from study.registry import method_named, method_names, unavailable_planners
from study.runs.lineup import default_lineup

cases_app = typer.Typer(help="Look at the cases.", no_args_is_help=True, add_completion=False)


def list_all(
    suites: Annotated[
        bool, typer.Option("--suites", help="List the suites that `study run --suite` takes instead.")
    ] = False,
) -> None:
    """List cases and planners; the default ones are what `study run` takes."""
    if suites:
        console = make_console()
        with console.paged():
            console.print(_suites_table(console, [suite_named(name) for name in suite_names()]))
        return
    console, cases = make_console(), [load_case(name) for name in case_names()]
    broken, names = unavailable_planners(), method_names()
    entries = [(name, broken[name] if name in broken else method_named(name)) for name in names]
    defaults = [spec.planner for spec in default_lineup()]
    with console.paged():
        console.print(
            f"{plural(len(cases), 'case')}, {sum(case.default for case in cases)} of them in the default run; "
            f"{plural(len(names), 'planner')} and bounds, {len({*defaults})} of them in the default run"
        )
        console.print(terminal.cases_table(console, cases), terminal.planners_table(console, entries, defaults))


def _suites_table(console: SafeConsole, suites: Iterable[Suite]) -> Table:
    """Table of suites."""
    rows: list[tuple[str | Text, ...]] = []
    for suite in suites:
        problems = [case.problem for case in suite.cases.values()]
        spans = [[each.n_segments for each in problems], [each.n_joints for each in problems]]
        sizes = [f"{min(span)}-{max(span)}" for span in spans]
        rows.append((suite.name, str(suite.version), str(len(problems)), *sizes, suite.checksum, Text(suite.about)))
    return fitted(
        console,
        "Suites",
        ("name", "version", "problems", "segments", "joints", "checksum", "description"),
        rows,
        left=("name", "checksum"),
        wraps=("description",),
        gives_way=("joints", "segments", "version"),
    )


def ledger(paper: Annotated[str | None, typer.Option(help="Key of one paper; all five by default.")] = None) -> None:
    """Print every misprint, contradiction and gap found in the papers, and the reading taken."""
    from study.reproduction.book import paper_named  # here: the reproduction is slow to import

    console, entries = make_console(), ledger_entries(None if paper is None else paper_named(paper))
    kinds = Counter(entry.kind for entry in entries)
    with console.paged():
        console.print(f"{len(entries)} entries by kind: {', '.join(f'{kind} {kinds[kind]}' for kind in sorted(kinds))}")
        console.print(*terminal.ledger_lines(entries), sep="\n")


@cases_app.callback()
def cases() -> None:
    """Look at the cases."""


@cases_app.command("show")
def show_case(name: Annotated[str, typer.Argument(metavar="NAME", help="Name or YAML file.")]) -> None:
    """Print a case: waypoints, limits, sources and notes."""
    console = make_console()
    with console.paged():
        console.print(*terminal.case_tables(console, load_case(name)))
