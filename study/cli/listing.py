"""Commands that list data: `study list`, `study ledger` and `study cases show`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from study.bounds import Method, kind_of
from study.cases.ledger import Entry
from study.cases.ledger import ledger as ledger_entries
from study.cases.library import Case, case_names, load_case
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
        console.print(cases_table(console, cases), planners_table(console, entries, defaults))


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
        console.print(*ledger_lines(entries), sep="\n")


@cases_app.callback()
def cases() -> None:
    """Look at the cases."""


@cases_app.command("show")
def show_case(name: Annotated[str, typer.Argument(metavar="NAME", help="Name or YAML file.")]) -> None:
    """Print a case: waypoints, limits, sources and notes."""
    console = make_console()
    with console.paged():
        console.print(*terminal.case_tables(console, load_case(name)))


def cases_table(console: Console, cases: Iterable[Case]) -> Table:
    """Table of cases; those of the default run are marked, variants stand indented under their case."""
    rows = [
        (
            "  " * bool(case.variant_of) + case.name,
            "yes" if case.default else "",
            Text(case.title),
            case.limits_label,
            str(case.problem.n_waypoints),
            str(case.problem.n_joints),
            case.curve,
            case.planner,
        )
        for case in cases
    ]
    return fitted(
        console,
        "Cases",
        ("name", "default", "description", "limits", "waypoints", "joints", "curve", "paper's planner"),
        rows,
        left=("name", "default", "curve", "paper's planner"),
        wraps=("description", "limits"),
        gives_way=("limits", "joints", "waypoints", "curve", "paper's planner"),
    )


def planners_table(console: Console, entries: Sequence[tuple[str, Method | str]], defaults: Iterable[str]) -> Table:
    """Table of planners and bounds; one that cannot be loaded shows the reason."""
    taken = set(defaults)
    rows: list[tuple[str | Text, ...]] = []
    for name, method in entries:
        broken = isinstance(method, str)
        kind, freedom, about = (
            ("not available", "", method)
            if isinstance(method, str)
            else (kind_of(method), method.freedom, method.about)
        )
        rows.append((name, "yes" if name in taken else "", kind, freedom, Text(about, style="red" if broken else "")))
    return fitted(
        console,
        "Planners",
        ("name", "default", "kind", "may change", "how it works"),
        rows,
        left=("name", "default", "kind", "may change"),
        wraps=("how it works",),
        gives_way=("may change", "kind", "default"),
    )


def ledger_lines(entries: Iterable[Entry]) -> Iterator[Text]:
    """The ledger paper by paper, each entry in a few lines."""
    for paper, group in groupby(entries, key=lambda entry: entry.paper):
        yield Text(f"\n{paper}", style="bold underline")
        for entry in group:
            yield Text(f"\n{entry.place} ({entry.kind})", style="bold")
            parts = {"printed": entry.printed, "problem": entry.problem, "reading": entry.reading}
            for name, text in (parts | {"consequence": entry.consequence}).items():
                if text:
                    yield Text.assemble((f"{name}: ", "dim"), text)
