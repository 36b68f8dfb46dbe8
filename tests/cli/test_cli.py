import os
import signal
import subprocess

import numpy as np
import pytest

from study.cases.library import case_names, load_case
from study.curves import curve_named
from tests.conftest import CASE_FILE, command, stored, wait_until


@pytest.fixture
def sampled(tmp_path, case_file):
    """Write samples of a 3-5-3 motion through the case's waypoints; `slow` is feasible."""

    def write(pace=3.0, orders=1, header=False, factor=1.0):
        case = load_case(case_file)
        motion = curve_named("poly353").motion(case.problem.waypoints, np.full(3, pace))
        times = np.linspace(0, motion.duration, 301)
        table = np.column_stack([times, *(factor * motion(times, order) for order in range(orders))])
        path = tmp_path / "samples.csv"
        head = ",".join(["time", *(f"c{k}" for k in range(table.shape[1] - 1))])
        np.savetxt(path, table, delimiter=",", header=head if header else "", comments="")
        return path

    return write


@pytest.fixture
def failing(study_command):
    """Run a command that must end with one sentence and exit code 2; give the sentence."""

    def run(*arguments):
        ended = study_command(*arguments)
        assert ended.returncode == 2, ended.stderr
        assert "Traceback" not in ended.stderr + ended.stdout
        lines = ended.stderr.strip().splitlines()
        assert len(lines) == 1, ended.stderr
        assert lines[0].startswith("study: ")
        return lines[0].removeprefix("study: ")

    return run


def test_a_process_of_its_own_says_and_ends_the_same(study_command, study_process, sampled, case_file):
    """Other tests run the command within their own process."""
    for arguments, status in (
        (["cases", "show", "woodworking"], 0),
        (["cases", "show", "wood"], 2),
        (["check", sampled(pace=0.3), "--case", case_file], 3),
    ):
        here, there = study_command(*arguments), study_process(*arguments)
        assert (here.returncode, here.stdout, here.stderr) == (there.returncode, there.stdout, there.stderr)
        assert here.returncode == status


def test_help_names_every_command(study_command, monkeypatch):
    text = study_command("--help").stdout
    for name in ("list", "run", "report", "view", "check", "cases"):
        assert f" {name} " in text
    monkeypatch.setenv("COLUMNS", "120")
    options = study_command("run", "--help").stdout
    for name in ("--seeds", "--cases", "--planners", "--out", "--jobs", "--full", "--evaluations"):
        assert name in options


def test_list_shows_cases_and_planners_even_broken_ones(study_command, stubs):
    text = study_command("list").stdout
    for name in (*case_names(), "golds-pso", "ruckig-stops", "stub-missing"):
        assert name in text
    assert "a_package_that_nobody_has" in text


def test_cases_show_prints_waypoints_limits_and_sources(study_command):
    text = study_command("cases", "show", "woodworking").stdout
    for part in ("1.897", "0.8 m/s²", "2.4 rad/s²", "Table 4", "golds-pso"):
        assert part in text


def test_ledger_prints_every_entry_or_those_of_one_paper(study_command, failing):
    everything = study_command("ledger").stdout
    one = study_command("ledger", "--paper", "woodworking-golds-pso").stdout
    assert one == study_command("ledger", "--paper", "woodworking").stdout
    assert "woodworking-golds-pso" in one
    assert len(one) < len(everything)
    assert "no paper 'woodwork'" in failing("ledger", "--paper", "woodwork")


def test_run_goes_on_where_it_stopped_and_report_shows_the_same(study_command, stubs, case_file, tmp_path):
    arguments = ["--cases", case_file, "--planners", "stub-seeded,stub-raise:scaled", "--out", tmp_path / "o"]
    first = study_command("run", *arguments, "--seeds", 2, "--jobs", 1, "--no-report")
    assert first.returncode == 0, first.stderr
    assert "4 cells, 0 stored already" in first.stdout
    assert "KeyError: <object object>" in first.stdout
    second = study_command("run", *arguments, "--seeds", 3, "--jobs", 2, "--no-report")
    assert "6 cells, 4 stored already" in second.stdout
    assert "3 of 3" in second.stdout


def test_one_cell_is_no_cells(stubs, study_command, case_file, tmp_path):
    ended = study_command(
        "run", "--cases", case_file, "--planners", "stub-steady", "--seeds", 1, "--out", tmp_path, "--no-report"
    )
    assert ended.stdout.startswith("1 cell, 0 stored already")


def test_ctrl_c_keeps_what_is_finished_and_says_how_to_go_on(stubs, case_file, tmp_path):
    out = tmp_path / "o"
    arguments = [
        "--cases",
        case_file,
        "--planners",
        "stub-slow",
        "--seeds",
        200,
        "--jobs",
        2,
        "--out",
        out,
        "--no-report",
    ]
    process = subprocess.Popen(
        command("run", *arguments),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # ignored where a shell runs the tests behind
    )
    path = out / "results.sqlite"
    wait_until(lambda: stored(path) >= 2)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the main process and to all workers
    _, errors = process.communicate(timeout=90)
    assert process.returncode == 130
    kept = stored(path)
    assert errors.strip() == (
        f"study: interrupted: {kept} of 200 cells are stored in {path}; run the same command again to go on, or `study report` to see them"
    )
    assert 2 <= kept < 200


@pytest.mark.parametrize("orders", [1, 2, 3])
def test_check_judges_samples_of_positions_and_rates(study_command, sampled, case_file, orders):
    ended = study_command("check", sampled(orders=orders, header=orders > 1), "--case", case_file)
    words = {1: "positions only: a cubic spline", 2: "cubic Hermite", 3: "quintic Hermite"}[orders]
    assert f"read as  {'positions' if orders > 1 else words}" in ended.stdout
    assert words in ended.stdout
    assert "waypoints passed at 0.0000, 3.0000, 6.0000, 9.0000 s" in ended.stdout
    assert ended.returncode == 0, ended.stdout
    assert ended.stdout.rstrip().endswith("feasible")


def test_check_ends_with_3_and_every_reason_when_infeasible(study_command, sampled, case_file):
    ended = study_command("check", sampled(pace=0.3, orders=3), "--case", case_file)
    assert ended.returncode == 3
    assert "infeasible: velocity of joint 2 reaches" in ended.stdout
    assert "infeasible: acceleration of joint" in ended.stdout
    assert "Traceback" not in ended.stderr


def test_check_takes_degrees(study_command, sampled, case_file):
    path = sampled(orders=3, factor=180 / np.pi)
    assert study_command("check", path, "--case", case_file, "--units", "deg").returncode == 0
    assert study_command("check", path, "--case", case_file).returncode == 3


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("0,0,0\n1,nan,1\n", "line 2: expected a finite number, got 'nan'"),
        ("t,a,b\n0,0,0\n1,x,1\n", "line 3: expected a finite number, got 'x'"),
        ("0,0,0\n1,1,1\n1,2,2\n", "times must increase, but sample 3 has 1 s after 1 s"),
        ("0,0\n1,1\n", "expected 3, 5 or 7 columns"),
        ("0,0,0\n1,1,1,1,1\n", "line 2: expected 3 columns as in the first line"),
        ("0,0,0\n", "at least two samples are needed, got 1"),
        ("", "there are no waypoints"),
    ],
)
def test_check_says_what_is_wrong_with_a_file(failing, tmp_path, case_file, content, sentence):
    path = tmp_path / "wrong.csv"
    path.write_text(content)
    assert sentence in failing("check", path, "--case", case_file)


def test_check_says_what_is_wrong_with_its_arguments(failing, tmp_path, sampled, case_file):
    assert "does not exist" in failing("check", tmp_path / "none.csv", "--case", case_file)
    assert "cannot be read: Is a directory" in failing("check", tmp_path, "--case", case_file)
    assert "no case 'wood'" in failing("check", sampled(), "--case", "wood")
    assert "no unit 'grad'" in failing("check", sampled(), "--case", case_file, "--units", "grad")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--cases", "woodwork"], "no case 'woodwork'; did you mean 'woodworking'?"),
        (["--planners", "gold-pso"], "no planner 'gold-pso'; did you mean 'golds-pso'?"),
        (["--planners", "pso:fast"], "'pso:fast'"),
        (["--cases", "nowhere/mine.yaml"], "mine.yaml"),
        (["--cases", ","], "no cases to run"),
        (["--seeds", "0"], "the number of seeds must be at least 1, got 0"),
        (["--evaluations", "0"], "the number of evaluations must be at least 1, got 0"),
        (["--jobs", "0", "--planners", "ruckig-stops"], "the number of jobs must be at least 1, got 0"),
        (["--out", "/proc/nowhere"], "cannot make the output folder /proc/nowhere"),
    ],
)
def test_wrong_runs_end_in_one_sentence(failing, tmp_path, arguments, sentence):
    out = [] if "--out" in arguments else ["--out", tmp_path / "o"]
    assert sentence in failing("run", *arguments, *out)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("[0.5, -0.1]", "[0.5, .nan]", "finite number, got 'nan'"),
        ("[0.5, -0.1]", "[0.0, 0.2]", "waypoints 1 and 2 are equal"),
        ("[0.5, -0.1]", "[0.5, -0.1, 3.0]", "one number for each of 2 joints, got 3"),
        ("velocity: {values: [1.0, 0.8]", "velocity: {values: [1.0]", "limits"),
        ("velocity: {values: [1.0, 0.8]", "velocity: {values: [1.0, 0.0]", "0"),
        ("velocity: {values: [1.0, 0.8]", "velocity: {values: [1.0, -1.0]", "-1"),
        ("curve: poly353", "curve: poly", "'poly'"),
        ("title:", "titel: a\ntitle:", "titel"),
    ],
)
def test_wrong_cases_end_in_one_sentence(failing, tmp_path, old, new, sentence):
    assert old in CASE_FILE
    path = tmp_path / "wrong.yaml"
    path.write_text(CASE_FILE.replace(old, new))
    said = failing("run", "--cases", path, "--planners", "pso", "--out", tmp_path / "o")
    assert sentence in said
    assert not (tmp_path / "o").exists()


def test_a_corrupt_result_file_ends_in_one_sentence_and_stays(failing, tmp_path, case_file):
    path = tmp_path / "results.sqlite"
    path.write_bytes(b"rubbish" * 1000)
    assert "is damaged" in failing("run", "--cases", case_file, "--planners", "pso", "--out", tmp_path)
    assert "is damaged" in failing("report", "--out", tmp_path)
    assert path.read_bytes() == b"rubbish" * 1000


def test_report_and_view_before_a_run_say_what_to_do(failing, tmp_path):
    assert "there are no results at" in failing("report", "--out", tmp_path)
    assert "there is no recording at" in failing("view", "woodworking", "--out", tmp_path)
    assert "no case 'wood'" in failing("view", "wood", "--out", tmp_path)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ["run", "--sedes", 3],
            "no such option: --sedes (Possible options: ",
        ),
        (["plan"], "missing argument 'FILE...'; `study plan --help` lists the options"),
        (["plann"], "no such command 'plann'"),
        (["run", "--seeds", "x"], "invalid value for '--seeds'"),
        (["store", "merg"], "no such command 'merg'"),
    ],
)
def test_wrong_words_end_in_one_sentence_that_leads_on(failing, arguments, sentence):
    assert sentence in failing(*arguments)


@pytest.mark.parametrize("arguments", [(), ("cases",), ("store",)])
def test_a_group_alone_prints_its_commands(study_command, arguments):
    ended = study_command(*arguments)
    assert ended.returncode == 2
    assert "Usage: study" in ended.stdout + ended.stderr
    assert "Commands" in ended.stdout + ended.stderr
