"""Commands that list data: `study list`, `study ledger` and `study cases show`."""

from __future__ import annotations

from typing import Annotated

import typer

from study.cases.ledger import ledger as ledger_entries
from study.cases.library import case_names, load_case
from study.cli import terminal
from study.cli.screen import make_console
from study.registry import method_named, method_names, unavailable_planners
from study.runs.lineup import default_lineup

cases_app = typer.Typer(help="Look at the cases.", no_args_is_help=True, add_completion=False)


def list_all() -> None:
    """List cases and planners; the default ones are what `study run` takes."""
    console = make_console()
    console.print(terminal.cases_table(load_case(name) for name in case_names()))
    broken = unavailable_planners()
    entries = [(name, broken[name] if name in broken else method_named(name)) for name in method_names()]
    console.print(terminal.planners_table(entries, [spec.planner for spec in default_lineup()]))


def ledger(paper: Annotated[str | None, typer.Option(help="Key of one paper; all five by default.")] = None) -> None:
    """Print every misprint, contradiction and gap found in the papers, and the reading taken."""
    console = make_console()
    for table in terminal.ledger_tables(ledger_entries(paper)):
        console.print(table)


@cases_app.callback()
def cases() -> None:
    """Look at the cases."""


@cases_app.command("show")
def show_case(name: Annotated[str, typer.Argument(metavar="NAME", help="Name or YAML file.")]) -> None:
    """Print a case: waypoints, limits, sources and notes."""
    for table in terminal.case_tables(load_case(name)):
        make_console().print(table)
