"""The help of every command says what it does and names values by words."""

import re

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from study.cli.main import app


def commands(command=None, path=()):
    """Every command with the words that lead to it."""
    command = get_command(app) if command is None else command
    yield path, command
    for name, inner in getattr(command, "commands", {}).items():
        yield from commands(inner, (*path, name))


ALL = dict(commands())


@pytest.mark.parametrize("path", ALL, ids=" ".join)
def test_the_help_names_values_by_words(path):
    shown = CliRunner().invoke(app, [*path, "--help"])
    assert shown.exit_code == 0, shown.output
    assert not re.search(r"<(int|float|str|bool|path|list)\b", shown.output)
    assert ALL[path].help


@pytest.mark.parametrize("path", ALL, ids=" ".join)
def test_every_option_that_takes_a_value_has_a_word_for_it_and_everything_a_sentence(path):
    import typer

    command = ALL[path]
    for param in command.get_params(typer.Context(command)):
        assert param.help, param.name
        if param.param_type_name == "option" and not param.is_flag:
            assert re.fullmatch(r"[A-Z]+", param.metavar), param.name
