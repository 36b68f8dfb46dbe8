"""What `examples/` shows is installed and run as a stranger would."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.fixture(scope="session")
def outside(tmp_path_factory):
    """Folder with the example package installed, as pip puts it there."""
    target = tmp_path_factory.mktemp("outside")
    quiet = ["--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--disable-pip-version-check"]
    source = tmp_path_factory.mktemp("source") / "package"
    source.mkdir()
    for path in (EXAMPLES / "outside_planner").iterdir():
        if path.is_file():
            (source / path.name).write_bytes(path.read_bytes())
    subprocess.run(
        [sys.executable, "-m", "pip", "install", *quiet, "--target", str(target), str(source)], check=True, timeout=100
    )
    return target


def run(arguments, folder, outside=None):
    environment = {**os.environ, "PYTHONPATH": str(outside or "")}
    ended = subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=100,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


def test_an_installed_package_takes_part_like_ours(outside, tmp_path):
    listed = run(["-m", "study", "list"], tmp_path, outside)
    assert "chord-rule" in listed
    assert "shrinking-steps" in listed
    run(["-m", "study", "init", "mine.yaml"], tmp_path, outside)
    names = "chord-rule,shrinking-steps,casadi-nlp"
    shown = run(
        ["-m", "study", "compare", "mine.yaml", "--planners", names, "--seeds", 1, "--evaluations", 500, "--no-report"],
        tmp_path,
        outside,
    )
    assert "chord-rule" in shown
    assert "fastest feasible: casadi-nlp" in shown


def test_the_package_passes_the_conformance_tests(outside, tmp_path):
    copy = tmp_path / "test_outside_planner.py"
    copy.write_bytes((EXAMPLES / "outside_planner" / "test_outside_planner.py").read_bytes())
    assert "2 passed" in run(["-m", "pytest", "-q", "-p", "no:cacheprovider", copy], tmp_path, outside)


def test_the_ten_lines_run_and_write_a_message(tmp_path):
    lines = (EXAMPLES / "ten_lines.py").read_text()
    code = [line for line in lines.splitlines()[2:] if line.strip()]
    assert len(code) <= 10
    shown = run([EXAMPLES / "ten_lines.py"], tmp_path)
    assert shown.startswith("ruckig-via: 2.6")
    assert "time_from_start" in (tmp_path / "mine.trajectory.yaml").read_text()


def test_the_readme_shows_the_same_ten_lines():
    code = (EXAMPLES / "ten_lines.py").read_text().split('"""\n')[1].strip()
    assert code in (EXAMPLES.parent / "README.md").read_text()
