"""What `examples/` shows is installed and run as a stranger would."""

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from study.recording.stream import entity
from tests.helpers.recordings import chunks, series

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


def test_an_installed_package_is_listed_with_its_own_words(outside, tmp_path):
    listed = " ".join(run(["-m", "study", "list"], tmp_path, outside).split())
    for name in ("chord-rule", "stop-and-go", "shrinking-steps"):
        assert name in listed
    assert "durations in proportion to the distance, stretched to the limits" in listed


@pytest.fixture(scope="module")
def compared(outside, tmp_path_factory):
    """Text of a comparison of the strangers' planners with one of ours, and the folder with its report and recording."""
    folder = tmp_path_factory.mktemp("compared")
    run(["-m", "study", "init", "mine.yaml"], folder, outside)
    arguments = [
        "--planners",
        "chord-rule,stop-and-go,shrinking-steps,ruckig-stops",
        "--evaluations",
        500,
        "--seeds",
        1,
    ]
    return run(["-m", "study", "compare", "mine.yaml", *arguments], folder, outside), folder / "study-output"


@pytest.mark.slow
def test_a_strangers_planners_stand_in_the_terminal_as_ours_do(compared):
    rows = {words[0]: words[1:] for line in compared[0].splitlines() if (words := line.replace("│", " ").split())}
    assert rows["chord-rule"][:2] == rows["shrinking-steps"][:2] == ["case's", "curve"]
    assert rows["stop-and-go"][0] == rows["ruckig-stops"][0] == "free"
    assert "yes" in rows["stop-and-go"]
    assert "yes" in rows["chord-rule"]


LADDER = """
from pathlib import Path
from study.analysis.case_summary import summarise
from study.cli.folder import last_run

cases, _, results = last_run(Path("study-output"))
for rung in summarise(cases, results)[0].rungs:
    print(rung.method, rung.cause, sep=": ")
"""


@pytest.mark.slow
def test_a_strangers_planners_stand_in_report_and_ladder_as_ours_do(compared, outside):
    page = (compared[1] / "report" / "mine.html").read_text()
    names = page[page.index("What the names of the methods mean") :]
    assert (
        "<dt>stop-and-go</dt><dd>a smooth step of degree 5 from waypoint to waypoint, with a stop at each</dd>" in names
    )
    assert "<dt>shrinking-steps</dt><dd>Normal steps around the incumbent;" in names
    rungs = run(["-c", LADDER], compared[1].parent, outside).splitlines()
    ours_and_theirs = ["shrinking-steps", "chord-rule", "stop-and-go", "ruckig-stops"]
    assert [rung.partition(":")[0] for rung in rungs] == ours_and_theirs
    assert "path: free between the waypoints; a smooth step of degree 5" in rungs[2]
    with (compared[1] / "report" / "tables" / "mine-results.csv").open() as file:
        kinds = {row["method"]: (row["kind"], row["path"]) for row in csv.DictReader(file)}
    assert kinds["shrinking-steps"] == ("search", "case's curve")
    assert kinds["stop-and-go"] == ("deterministic", "free path")


@pytest.mark.slow
def test_a_strangers_planners_stand_in_the_recording_as_ours_do(compared):
    (recording,) = (compared[1] / "recordings").iterdir()
    summary = chunks(recording, "/summary", "TextDocument:text")[0].column("TextDocument:text").to_pylist()[0][0]
    assert re.search(r"\| stop-and-go \| feasible \|.*\| free path \|", summary)
    for name in ("chord-rule", "stop-and-go", "shrinking-steps"):
        assert len(series(recording, entity("q", "shoulder_pan", name))[0]) > 100


def test_a_strangers_planner_is_tortured_as_ours_are(outside, tmp_path):
    arguments = ["--planners", "stop-and-go", "--problems", 12, "--jobs", 1]
    shown = run(["-m", "study", "torture", *arguments], tmp_path, outside)
    (row,) = [line.replace("│", " ").split() for line in shown.splitlines() if line.startswith("│ stop-and-go")]
    solved, declined, *others = map(int, row[1:])
    assert solved + declined + sum(others) == 12
    assert solved > 0
    assert others == [0, 0, 0]


@pytest.mark.slow
def test_the_package_passes_the_conformance_tests(outside, tmp_path):
    copy = tmp_path / "test_outside_planner.py"
    copy.write_bytes((EXAMPLES / "outside_planner" / "test_outside_planner.py").read_bytes())
    assert "3 passed" in run(["-m", "pytest", "-q", "-p", "no:cacheprovider", copy], tmp_path, outside)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", sorted(path.name for path in EXAMPLES.glob("*.ipynb")))
def test_every_cell_of_a_notebook_runs_and_shows_something(name, tmp_path, monkeypatch):
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    for variable in ("JUPYTER_RUNTIME_DIR", "JUPYTER_DATA_DIR", "JUPYTER_CONFIG_DIR", "IPYTHONDIR"):
        monkeypatch.setenv(variable, str(tmp_path / variable))
    book = nbformat.read(EXAMPLES / name, as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells), "commit notebooks without outputs"
    runs = nbclient.NotebookClient(
        book,
        timeout=100,
        kernel_name="python3",
        resources={"metadata": {"path": str(tmp_path)}},
        store_widget_state=False,
    )
    runs.execute()
    shown = [cell["outputs"] for cell in book.cells if cell["cell_type"] == "code"]
    assert all(shown), [len(outputs) for outputs in shown]
    assert "text/html" in shown[0][-1]["data"]
    assert not [output for outputs in shown for output in outputs if output["output_type"] == "error"]


def test_the_ten_lines_run_and_write_a_message(tmp_path):
    lines = (EXAMPLES / "ten_lines.py").read_text()
    code = [line for line in lines.splitlines()[2:] if line.strip()]
    assert len(code) <= 10
    shown = run([EXAMPLES / "ten_lines.py"], tmp_path)
    assert shown.startswith("free-path: 2.7")
    assert "time_from_start" in (tmp_path / "mine.trajectory.yaml").read_text()


def test_the_readme_shows_the_same_ten_lines():
    code = (EXAMPLES / "ten_lines.py").read_text().split('"""\n')[1].strip()
    assert code in (EXAMPLES.parent / "README.md").read_text()
