"""Every command and every program of the docs is run; the docs are built with warnings as errors."""

import json
import os
import re
import shlex
import stat
import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path

import pytest

from study.cases.own_file import schema
from study.cli.main import commands_with_names
from study.registry import method_names
from study.testing.stress import reference_planners
from tests.conftest import run_here

ROOT = Path(__file__).parents[1]
PAGES = sorted((ROOT / "docs" / "pages").glob("*.md"))
BLOCK = re.compile(r"(?:<!-- exit: (\d) -->\n)?```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)```", re.DOTALL)
OPTIONAL = ("pymoo", "mealpy", "nevergrad", "rosbags", "xacro")
RUN, WRITTEN = ("sh", "python"), ("yaml", "csv", "toml", "python", "xml", "json")
QUIET = "-m pip install --quiet --no-index --no-deps --no-build-isolation --disable-pip-version-check --target"


def blocks(page):
    return [
        (int(status or 0), language, title, text) for status, language, title, text in BLOCK.findall(page.read_text())
    ]


@pytest.fixture
def shell(tmp_path):
    """Run text in an empty folder where `study` and `pip` are this interpreter's, and pip stays off the network."""
    tools, packages, folder = (tmp_path / name for name in ("tools", "packages", "work"))
    for path in (tools, packages, folder):
        path.mkdir()
    commands = {"study": "-m study", "pip": f'{QUIET} "{packages}"'}
    for name, arguments in commands.items():
        drop = "shift; " if name == "pip" else ""
        (tools / name).write_text(f'#!/bin/sh\n{drop}exec "{sys.executable}" {arguments} "$@"\n')
        (tools / name).chmod(stat.S_IRWXU)
    environment = {
        **os.environ,
        "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": f"{packages}{os.pathsep}{folder}",
    }

    def run(command, status=0):
        ended = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=550, check=False
        )
        assert ended.returncode == status, f"{command}\n{ended.stdout}\n{ended.stderr}"
        return ended

    run.folder = folder
    return run


def lacks(text):
    """Packages that a block imports and that are not installed here."""
    return [name for name in OPTIONAL if f"from {name}" in text or f"import {name}" in text if not find_spec(name)]


EACH = """import sys
for text in sys.argv[1:]:
    exec(compile(text, text, "exec"), {"__name__": "__main__"})
"""
"""Runs programs one after the other, each with names of its own: they share what takes most time, the imports."""


COMMAND = re.compile(r"study [^|<>&;$*`]*")
"""A line that needs no shell."""


def play(page, shell):
    runnable = [block for block in blocks(page) if not lacks(block[3])]
    bare = not any("pip install" in text or title.endswith(".py") for _, _, title, text in runnable)
    for (language, written), group in groupby(runnable, lambda block: (block[1], bool(block[2]))):
        if written:
            for _, _, title, text in group:
                (shell.folder / title).write_text(text)
        elif language == "sh":
            for status, _, _, text in group:
                for line in text.strip().splitlines():
                    if bare and COMMAND.fullmatch(line):  # here, which is spared a second of imports
                        ended = run_here(*shlex.split(line)[1:], cwd=shell.folder)
                        assert ended.returncode == status, f"{line}\n{ended.stdout}\n{ended.stderr}"
                    else:
                        shell(["bash", "-euo", "pipefail", "-c", line], status)
        elif language == "python":
            shell([sys.executable, "-W", "ignore", "-c", EACH, *(text for _, _, _, text in group)])


LONG = {"add-a-planner.md", "benchmark.md", "index.md", "own-robot.md", "performance.md", "suites.md"}
"""Pages with a whole comparison, bench or run of a suite: run with the slow tests."""


@pytest.mark.parametrize(
    "page", [pytest.param(p, marks=[pytest.mark.slow] if p.name in LONG else []) for p in PAGES], ids=lambda p: p.stem
)
@pytest.mark.timeout(600)
def test_every_block_of_a_page_runs(page, shell, threads):
    play(page, shell)
    if missing := lacks(page.read_text()):
        pytest.skip(f"all blocks ran but those that need {', '.join(missing)}")


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_the_first_page_leaves_what_it_promises(shell):
    play(next(page for page in PAGES if page.name == "index.md"), shell)
    for name in ("report/index.html", "recordings/my_case.rrd", "trajectories/my_case.yaml", "results.sqlite"):
        assert (shell.folder / "study-output" / name).stat().st_size, name


def test_every_block_is_run_or_written():
    for page in PAGES:
        assert page.read_text().count("```") == 2 * len(blocks(page)), page.name
        for status, language, title, _ in blocks(page):
            assert language in (WRITTEN if title else RUN), (page.name, language, title)
            assert not status or language == "sh", (page.name, status)


def test_the_page_about_files_shows_every_key_of_a_case():
    shown = next(text for _, _, title, text in blocks(PAGES[0].parent / "files.md") if title == "keys.yaml")
    assert not {key for key in schema()["properties"] if not re.search(rf"^{key}:", shown, re.MULTILINE)}


def test_the_ten_lines_of_the_docs_are_the_example():
    example = (ROOT / "examples" / "ten_lines.py").read_text().splitlines()
    code = [line.strip() for line in example[2:] if line.strip()]
    docs = [line.strip() for line in blocks(ROOT / "docs" / "pages" / "python.md")[0][3].splitlines() if line.strip()]
    assert docs == code


def promised():
    """Full names of what the packages export and of what the reference lists."""
    for module in ("study", "study.api", "study.testing", "study.adapters"):
        for name in import_module(module).__all__:
            thing = getattr(import_module(module), name)
            yield f"{getattr(thing, '__module__', module) if callable(thing) else module}.{name}"
    for module, names in re.findall(
        r"::: (\S+)\n +options:\n +members: \[(.*)\]", (PAGES[0].parent / "api.md").read_text()
    ):
        yield from (f"{module}.{name}" for name in names.split(", "))


def test_every_planner_and_bound_is_described_and_those_that_calculate_have_their_formulas():
    text, maths, searches = (
        (PAGES[0].parent / f"{page}.md").read_text() for page in ("planners", "mathematics", "searches")
    )
    assert not {name for name in method_names() if f"**`{name}`**" not in text + searches}
    plain = {
        "lbfgsb-once",
        "direct",
        "centre",
        "toppra-quick",
        "free-path-first",
    }  # what is another's, or a part of another
    assert not {name for name in reference_planners() if name not in plain and f"`{name}`" not in maths}


@pytest.mark.filterwarnings("ignore")
def test_the_docs_build_without_a_warning_and_load_nothing_from_elsewhere(tmp_path):
    pytest.importorskip("mkdocs")
    pytest.importorskip("material")
    pytest.importorskip("mkdocstrings")
    command = [
        sys.executable,
        "-m",
        "mkdocs",
        "build",
        "--strict",
        "-q",
        "-f",
        ROOT / "docs" / "mkdocs.yml",
        "-d",
        tmp_path,
    ]
    quiet = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    ended = subprocess.run(command, capture_output=True, text=True, timeout=110, env=quiet)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    reference = (tmp_path / "api.html").read_text()
    assert not {name for name in promised() if f'id="{name}"' not in reference}
    assert "woodworking-golds-pso" in (tmp_path / "ledger.html").read_text()
    assert json.loads((tmp_path / "case.schema.json").read_text()) == schema()
    for page in tmp_path.glob("*.html"):
        text = page.read_text()
        assert "<!-- ledger -->" not in text
        assert not re.findall(r'<(?:script|img|iframe)[^>]+src="https?:', text), page.name
        assert not re.findall(r'<link[^>]+rel="stylesheet"[^>]+href="https?:', text), page.name


def test_every_command_has_its_section_with_its_options():
    page = (ROOT / "docs" / "pages" / "commands.md").read_text()
    for name, command in commands_with_names():
        _, heading, section = page.partition(f"\n### `study {name}`\n")
        assert heading, name
        mark = f"<!-- options: {name} -->" in section.partition("\n### ")[0]
        assert mark == any(param.name != "help" for param in command.params), name
