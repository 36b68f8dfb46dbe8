"""The command `study`: its commands by name, each imported when it runs, and how errors end."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from importlib.metadata import version
from typing import Annotated, Any, NoReturn

import typer

from study.cli.commands import Entry, lazy_group
from study.cli.interrupts import STATUS, output_failure
from study.errors import Interrupted, StudyError

UsageError: type[Exception] = typer.BadParameter.__mro__[1]
"""Base of the errors about the words of a command; Typer has no public name for it."""

COMMANDS = {
    "list": Entry("listing", "list_all", "List cases and planners; the default ones are what `study run` takes."),
    "run": Entry("run", "run", "Run every case with every planner, then write tables, report and recordings."),
    "report": Entry(
        "run",
        "report",
        "Write tables, report and recordings again from the stored results, every case as it was run last.",
    ),
    "view": Entry("run", "view", "Open the recording of a case in the rerun viewer."),
    "ledger": Entry(
        "listing", "ledger", "Print every misprint, contradiction and gap found in the papers, and the reading taken."
    ),
    "digest": Entry(
        "run", "digest", "Print one checksum of all stored results, wall times left out; equal studies print the same."
    ),
    "reproduce": Entry(
        "reproduce",
        "reproduce_command",
        "Put every printed number of a paper beside ours, with a verdict; what has been run is not run again.",
    ),
    "init": Entry("own", "init", "Write a commented example of a case to start from."),
    "check": Entry(
        "check",
        "check",
        "Check a case and say what was understood; or judge a trajectory: 0 if it is feasible, 3 if it is not.",
    ),
    "plan": Entry(
        "own", "plan", "Plan one motion, have it judged and write it; ends with 3 where no feasible motion was found."
    ),
    "compare": Entry(
        "compare",
        "compare",
        "Put your own problem to several planners, or, without FILE, compare the papers' searches with tests and an audit.",
    ),
    "schema": Entry("own", "schema", "Print the JSON Schema of a case file, for editors."),
    "torture": Entry(
        "torture",
        "torture",
        "Put random problems of every kind (1-8 joints, 2-200 waypoints, six decades) to planners; ends with 3 if one crashes, hangs or is wrong.",
    ),
    "bench": Entry(
        "bench",
        "bench",
        "Measure kernels, searches and planners next to other packages, and write the report's performance page.",
    ),
    "pictures": Entry(
        "pictures",
        "pictures",
        "Draw pictures of stored results: the ladder, one joint's profiles, the viewer's first look and its arms, moving.",
    ),
    "cases": Entry("listing", "cases_app", "Look at the cases."),
    "suite": Entry("suite", "suite_app", "Look after the suites of problems and their records."),
    "store": Entry("store", "store_app", "Look after the file of results."),
}

app = typer.Typer(
    help="Compare metaheuristic time-optimal trajectory planners with deterministic ones on five papers' own problems.\n\n"
    "Start with `study run`; it leaves a report and recordings in ./study-output.",
    cls=lazy_group(COMMANDS),
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)


def commands_with_names() -> Iterator[tuple[str, Any]]:
    """Every command with its name, those of a group with both words; each is imported, which takes seconds."""
    for name, entry in COMMANDS.items():
        command = entry.load(name)
        for inner, each in getattr(command, "commands", {"": command}).items():
            yield f"{name} {inner}".strip(), each


@app.callback(invoke_without_command=True)
def top(show_version: Annotated[bool, typer.Option("--version", help="Print the version and end.")] = False) -> None:
    """Take the options that come before a command."""
    if show_version:
        print(version("time-optimal-study"))
        raise typer.Exit


def main() -> None:
    """Run the command; what a user can mend ends in one sentence and exit code 2."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # a home that cannot be written to costs only time
    try:
        try:
            status = app(standalone_mode=False, prog_name="study")
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
        sys.exit(status if isinstance(status, int) else 0)
    except UsageError as mistake:
        _misused(mistake)
    except StudyError as error:
        _end(error, 2)
    except Interrupted as interruption:
        _end(interruption, STATUS)
    except KeyboardInterrupt:
        _end("interrupted", STATUS)
    except OSError as error:
        sentence = output_failure(error)
        if sentence is None:
            raise
        _end(sentence, 2)


def _misused(mistake: Any) -> NoReturn:
    """Say in one sentence what is wrong with the words of the command; of a group alone print its commands."""
    if type(mistake).__name__ == "NoArgsIsHelpError":
        mistake.show()
        sys.exit(2)
    text = mistake.format_message().strip().rstrip(".")
    known = mistake.ctx.command_path if mistake.ctx else "study"
    _end(f"{text[:1].lower()}{text[1:]}; `{known} --help` lists the options", 2)


def _end(sentence: object, status: int) -> NoReturn:
    from study.cli.screen import complain  # here: its package is slow to import, and most commands end well

    if str(sentence):
        complain(sentence)
    sys.exit(status)
