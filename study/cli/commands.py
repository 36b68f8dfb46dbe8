"""Click classes of the command `study`: commands loaded when they run, and help that names values by words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from study.cli.interrupts import check_memory, ending_at_once

PLACEHOLDERS = {
    "case": "CASE",
    "cases": "CASES",
    "cycle": "SECONDS",
    "dask": "ADDRESS",
    "duration": "SECONDS",
    "evaluations": "N",
    "interpolation": "KIND",
    "jobs": "N",
    "joints": "NAMES",
    "judges": "N",
    "joint": "N",
    "limits": "FILE",
    "memory": "MB",
    "out": "FOLDER",
    "paper": "PAPER",
    "part": "PART",
    "planner": "PLANNER",
    "planners": "PLANNERS",
    "points": "N",
    "problems": "N",
    "rate": "HZ",
    "readme": "FILE",
    "save": "FILE",
    "seed": "N",
    "seeds": "N",
    "speed": "SHARE",
    "time_limit": "SECONDS",
    "tolerance": "SHARE",
    "units": "UNIT",
}
"""Name of an option's parameter: word for its value. Switches have none."""


def _worded(params: list[Any]) -> list[Any]:
    for param in params:
        if param.param_type_name == "argument":
            param.display_type = _nothing  # its name says it
        elif param.metavar is None:
            param.metavar = PLACEHOLDERS.get(param.name, "")
    return params


def _nothing(ctx: typer.Context) -> str:
    return ""


class WordedCommand(TyperCommand):
    """A command whose help names values by words."""

    def get_params(self, ctx: Any) -> list[Any]:
        """List arguments and options, `--help` among them."""
        return _worded(super().get_params(ctx))


class WordedGroup(TyperGroup):
    """A group of commands whose own options are named by words."""

    def get_params(self, ctx: Any) -> list[Any]:
        """List arguments and options, `--help` among them."""
        return _worded(super().get_params(ctx))


@dataclass(frozen=True)
class Entry:
    """A command that is imported when it runs.

    Attributes
    ----------
    module : str
        Module below `study.cli`.
    name : str
        Function of one command, or `typer.Typer` of a group of commands.
    help : str
        First line of the command's own help.
    """

    module: str
    name: str
    help: str

    def load(self, name: str) -> Any:
        """Import the command and build it for Click.

        Raises
        ------
        StudyError
            If the process may take so little memory that the numerical libraries would hang.
        """
        check_memory()
        with ending_at_once():
            target = getattr(import_module(f"study.cli.{self.module}"), self.name)
        if isinstance(target, typer.Typer):
            return group(target)
        single = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode="markdown")
        single.command(name, cls=WordedCommand)(target)
        return typer.main.get_command(single)


class LazyCommand(TyperCommand):
    """Stand-in for a command in the list of commands: the command itself is imported when it is called."""

    def __init__(self, name: str, entry: Entry) -> None:
        super().__init__(name, help=entry.help, rich_markup_mode="markdown")
        self.entry = entry

    def make_context(self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any) -> Any:
        """Import the command and let it read its arguments."""
        return self.entry.load(str(self.name)).make_context(info_name, args, parent=parent, **extra)


def lazy_group(entries: Mapping[str, Entry]) -> type[WordedGroup]:
    """Make a class of groups whose commands are listed from a table and imported when they run."""

    class LazyGroup(WordedGroup):
        """Commands of a table, in its order."""

        def list_commands(self, ctx: Any) -> list[str]:
            """Names in the order of the table."""
            return list(entries)

        def get_command(self, ctx: Any, cmd_name: str) -> Any:
            """Stand-in of a command; None for an unknown name."""
            return LazyCommand(cmd_name, entries[cmd_name]) if cmd_name in entries else None

    return LazyGroup


def group(app: typer.Typer) -> Any:
    """Build a group whose help, and that of its commands, names values by words."""
    app.info.cls = WordedGroup
    for command in app.registered_commands:
        command.cls = WordedCommand
    return typer.main.get_command(app)
