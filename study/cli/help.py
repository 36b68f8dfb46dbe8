"""What the help shows in the place of a value: what it stands for, not the type that Python gives it."""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

PLACEHOLDERS = {
    "case": "CASE",
    "cases": "CASES",
    "dask": "ADDRESS",
    "evaluations": "N",
    "jobs": "N",
    "joint": "N",
    "limits": "FILE",
    "memory": "MB",
    "out": "FOLDER",
    "paper": "PAPER",
    "planner": "PLANNER",
    "planners": "PLANNERS",
    "problems": "N",
    "rate": "HZ",
    "readme": "FILE",
    "save": "FILE",
    "seed": "N",
    "seeds": "N",
    "time_limit": "SECONDS",
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


def use_words(app: typer.Typer) -> None:
    """Let the help of an app, its commands and its groups name values by words."""
    app.info.cls = WordedGroup
    for command in app.registered_commands:
        command.cls = WordedCommand
    for group in app.registered_groups:
        if group.typer_instance is not None:
            use_words(group.typer_instance)
