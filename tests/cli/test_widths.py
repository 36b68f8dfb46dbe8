"""Output at every width of a terminal: the answer first, no line too long, no number cut."""

import io
import re
from types import SimpleNamespace

import pytest
from rich.cells import cell_len

from study.cli import reproduce
from study.cli.bench import telling
from study.cli.screen import SafeConsole, fitted, progress_bar, running
from study.reproduction.effort import Effort
from tests.conftest import run_here

WIDTHS = (60, 80, 120, 200)
RUN = ("--cases", "woodworking,ur5-bspline", "--planners", "casadi-nlp,golds-pso", "--seeds", 1, "--evaluations", 200)
CASES = {  # command: what must stand in the first ten lines
    ("run", *RUN, "--no-report"): "• No",
    ("run", *RUN, "--no-report", "--details"): "• No",
    ("plan", "my_case.yaml", "--planner", "ruckig-stops"): "s, may be driven",
    ("compare", "my_case.yaml", "--planners", "ruckig-stops,centre", "--no-report"): "s, may be driven",
    ("check", "my_case.yaml"): "the case is complete",
    ("check", "study-output/trajectories/my_case.csv", "--case", "my_case.yaml"): "s, may be driven",
    ("check", "study-output/trajectories/my_case.exact.json", "--case", "fast.yaml"): "must not be driven",
    ("list",): " cases, 5 of them in the default run",
    ("ledger",): "entries by kind: ",
    ("ledger", "--paper", "woodworking"): "entries by kind: ",
    ("cases", "show", "ur5-helix"): "ur5-helix",
}
SLOW = {("report",): "• No", ("reproduce", "aubo", "--quick"): "aubo-dynamic-adaptive-pso: runs: "}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("widths")
    run_here("init", cwd=folder)
    case = (folder / "my_case.yaml").read_text()
    (folder / "fast.yaml").write_text(re.sub(r"(velocity: )\S.*", r"\g<1>0.01", case))
    run_here("run", *RUN, "--no-report", cwd=folder)
    run_here("plan", "my_case.yaml", "--planner", "ruckig-stops", cwd=folder)
    return folder


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("arguments", CASES, ids=lambda words: " ".join(map(str, words)))
def test_lines_fit_and_the_answer_comes_first(folder, monkeypatch, arguments, width):
    captured(folder, monkeypatch, arguments, width, CASES[arguments])


@pytest.mark.slow
@pytest.mark.usefixtures("threads")
@pytest.mark.parametrize("arguments", SLOW, ids=lambda words: words[0])
def test_lines_of_commands_that_write_pages_fit_too(folder, monkeypatch, arguments):
    monkeypatch.setattr(reproduce, "QUICK", Effort("tiny: for tests", 2, 0.02, 2, all_readings=False))
    run_here("run", *RUN, "--no-report", cwd=folder)
    for width in WIDTHS:
        captured(folder, monkeypatch, arguments, width, SLOW[arguments])


def captured(folder, monkeypatch, arguments, width, wanted):
    monkeypatch.setenv("COLUMNS", str(width))
    ended = run_here(*arguments, cwd=folder)
    lines = ended.stdout.splitlines()
    assert ended.returncode in (0, 3), ended.stderr
    assert max(map(cell_len, lines)) <= width
    assert wanted in " ".join(" ".join(lines[:10]).split())
    assert "…" not in ended.stdout
    assert not re.search(r"\d\n *\d+ *(%|s)\b", ended.stdout)


def test_a_pipe_gets_sentences_whole(folder, monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    said = run_here("run", *RUN, "--no-report", cwd=folder).stdout
    assert any(line.startswith("• No") and line.endswith(".") for line in said.splitlines())


def test_columns_give_way_one_by_one_and_are_named():
    rows = [("free-path", "1234567.12345", "words that may go on in the next line", "12 of 30")]
    heads, options = ("name", "time (s)", "reason", "runs"), {"left": ("name",), "wraps": ("reason",)}
    for width, hidden in ((100, ()), (60, ()), (46, ("runs",)), (34, ("runs", "reason"))):
        console = SafeConsole(width=width, file=None)
        with console.capture() as captured:
            console.print(fitted(console, "Table", heads, rows, gives_way=("runs", "reason"), **options))
        said = captured.get()
        assert max(map(cell_len, said.splitlines())) <= width
        assert "1234567.12345" in said
        note = " ".join(said.split()).partition("Not shown")[2]
        assert note == (f" in {width} columns: {', '.join(hidden)}." if hidden else "")


def test_a_case_is_shown_in_the_units_that_were_typed(folder, tmp_path):
    (tmp_path / "d.yaml").write_text(
        "units: [deg, mm]\nwaypoints: [[0, 0], [90, 45]]\nlimits: {velocity: [1.5, 20], acceleration: 3}\n"
    )
    said = run_here("check", "d.yaml", cwd=tmp_path).stdout
    for part in ("(deg)", "(mm)", "90", "45", "1.5 deg/s", "20 mm/s", "3 mm/s²"):
        assert part in said, part


@pytest.mark.parametrize(("wrong", "meant"), [("accel", "acceleration"), ("acceleraton", "acceleration")])
def test_a_misspelt_key_is_named_with_what_was_meant(tmp_path, wrong, meant):
    (tmp_path / "k.yaml").write_text(f"units: rad\nwaypoints: [[0], [1]]\nlimits: {{velocity: 1, {wrong}: 2}}\n")
    ended = run_here("check", "k.yaml", cwd=tmp_path)
    assert f"unknown key 'limits.{wrong}'; did you mean {meant!r}?" in ended.stderr
    (tmp_path / "k.yaml").write_text("units: rad\nwaypoints: [[0], [1]]\nlimts: {velocity: 1}\n")
    assert "unknown key 'limts'; did you mean 'limits'?" in run_here("check", "k.yaml", cwd=tmp_path).stderr


def test_progress_names_two_of_those_that_run_and_counts_the_others():
    jobs = [SimpleNamespace(subject="case", label=name) for name in ("a", "b", "c", "d")]
    assert running(jobs, 1) == "case: a"
    assert running(jobs, 2) == "case: a, case: b"
    assert running(jobs, 3) == "case: a, case: b and 1 more"
    assert running(jobs[2:], 8) == "case: c, case: d"
    assert running([], 8) == ""


@pytest.mark.parametrize("width", WIDTHS)
def test_long_names_leave_room_for_the_figures_of_the_progress(width):
    console = SafeConsole(width=width, file=io.StringIO(), force_terminal=True, color_system=None)
    bar = progress_bar(console)
    bar.add_task("case: " + 30 * "name ", total=1800)
    console.print(bar.get_renderable())
    assert re.search(r" 0/1800 0:00:00 left -:--:--\s*$", console.file.getvalue())


def test_measuring_is_told_on_standard_error_where_the_output_is_no_terminal(capsys):
    for terminal in (False, True):
        with telling(SafeConsole(file=io.StringIO(), force_terminal=terminal)) as told:
            told("kernels")
    assert capsys.readouterr() == ("", "measuring: kernels\n")
