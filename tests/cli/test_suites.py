"""Suites on the command line: listed, run, resumed, shown again and kept."""

import pytest

from study.cases import suite_file
from study.cases.suites import suite_named
from study.cli.screen import make_console
from study.cli.suite_run import show_suite
from study.planning import RunSettings
from study.runs.execute import CellJob
from study.store.results import Cell


def test_suites_are_listed_with_their_checksums(study_command):
    text = study_command("list", "--suites").stdout
    for name in ("papers", "robots", "scaling", "hard"):
        assert name in text
        assert suite_named(name).checksum in text


def test_a_suite_is_drawn_into_a_file(study_command, tmp_path):
    ended = study_command("suite", "make", "hard", "--out", tmp_path / "hard.json")
    assert ended.returncode == 0
    assert suite_named("hard").checksum in ended.stdout
    assert (tmp_path / "hard.json").read_text() == (suite_file.suites_folder() / "hard.json").read_text()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--suite", "nope"), "no suite 'nope'"),
        (("--suite", "hard", "--full"), "--full does not go with it"),
        (("--suite", "hard", "--cases", "woodworking"), "--cases does not go with it"),
        (("--quick",), "go with --suite"),
    ],
)
def test_what_does_not_go_together_is_told(study_command, tmp_path, arguments, said):
    ended = study_command("run", *arguments, "--out", tmp_path)
    assert ended.returncode == 2
    assert said in ended.stderr


def test_scores_bounds_and_files_are_shown(tmp_path, capsys):
    suite = suite_named("hard")
    cases = dict(list(suite.cases.items())[:2])
    cells = [
        Cell(name, planner, planner, RunSettings(curve=case.curve))
        for name, case in cases.items()
        for planner in ("ruckig-stops", "toppra-quick")
    ]
    results = [CellJob(cell, cases[cell.case].problem).run() for cell in cells]
    show_suite(suite, cases, results, tmp_path, make_console())
    text = capsys.readouterr().out
    assert suite.checksum in text
    assert "ruckig-stops" in text
    assert (tmp_path / "report" / "suite" / "runs.parquet").is_file()


@pytest.mark.slow
def test_a_suite_is_run_resumed_and_shown_again(study_command, tmp_path):
    arguments = ("run", "--suite", "hard", "--planners", "ruckig-stops", "--out", tmp_path)
    assert "24 cells, 0 stored already" in study_command(*arguments).stdout
    assert "24 cells, 24 stored already" in study_command(*arguments).stdout
    assert "ruckig-stops" in study_command("report", "--out", tmp_path).stdout


@pytest.mark.slow
def test_the_papers_are_run_with_a_line_up_and_shown_again(study_command, tmp_path):
    arguments = ("run", "--suite", "papers", "--lineup", "growth", "--planners", "ruckig-stops", "--out", tmp_path)
    assert "give --planners or --lineup" in study_command(*arguments).stderr
    study_command("run", "--suite", "papers", "--planners", "ruckig-stops", "--lineup", "", "--out", tmp_path)
    assert "ruckig-stops" in study_command("report", "--out", tmp_path).stdout
