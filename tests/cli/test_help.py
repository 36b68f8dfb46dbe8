"""The help of every command says what it does and names values by words."""

import re
import subprocess
import sys

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from study.cli.main import COMMANDS, app


def commands():
    """Every command with the words that lead to it."""
    yield (), get_command(app)
    for name, entry in COMMANDS.items():
        command = entry.load(name)
        yield (name,), command
        yield from (((name, inner), found) for inner, found in getattr(command, "commands", {}).items())


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


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_says_what_each_says_of_itself(name):
    first = COMMANDS[name].load(name).help.strip().partition("\n")[0]
    assert COMMANDS[name].help == first


@pytest.mark.parametrize("option", ["--version", "--help"])
def test_version_and_help_import_nothing_heavy(option):
    code = (
        "import sys; from study.__main__ import main; sys.argv = ['study', sys.argv[1]]\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print(*sorted({n.partition('.')[0] for n in sys.modules}), file=sys.stderr)"
    )
    ended = subprocess.run([sys.executable, "-c", code, option], capture_output=True, text=True, timeout=60)
    loaded = set(ended.stderr.split())
    assert "study" in loaded
    heavy = {"rerun", "matplotlib", "pyarrow", "casadi", "jinja2", "pydantic", "sqlite3"}
    assert not loaded & (heavy | {"numpy", "scipy", "yaml"})
