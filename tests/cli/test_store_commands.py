import pytest
from typer.testing import CliRunner

from study.cli.folder import STORE_NAME
from study.cli.main import app
from study.errors import StudyError


@pytest.fixture
def study(stubs):
    """Run a command in this process; what it says, or the error it raises."""

    def run(*arguments):
        ended = CliRunner().invoke(app, [str(one) for one in arguments])
        if isinstance(ended.exception, StudyError):
            raise ended.exception
        assert ended.exit_code == 0, ended.output
        return ended.output

    return run


@pytest.fixture
def out(study, case_file, tmp_path):
    folder = tmp_path / "out"
    study("run", "--cases", case_file, "--planners", "stub-seeded", "--seeds", 2, "--out", folder, "--no-report")
    return folder


def test_the_file_of_results_is_looked_after_from_the_command_line(study, out, tmp_path):
    assert study("store", "verify", "--out", out) == "2 results, all as they were stored\n"
    table = study("store", "summary", "--out", out)
    assert "stub-seeded" in table
    assert "mini" in table
    assert "2 results written to" in study("store", "export", tmp_path / "r.csv", "--out", out)
    other = tmp_path / "other"
    assert "2 results added, 0 known, 0 contrary" in study("store", "merge", out, "--out", other)
    assert "0 results added, 2 known, 0 contrary" in study("store", "merge", out / STORE_NAME, "--out", other)
    assert study("digest", "--out", other) == study("digest", "--out", out)
    assert "0 results dropped" in study("store", "compact", "--drop-stale", "--out", out)
    (other / STORE_NAME).write_bytes(b"x" * 5000)
    with pytest.raises(StudyError, match="is damaged or not a results file"):
        study("store", "verify", "--out", other)
    with pytest.raises(StudyError, match="there are no results at"):
        study("store", "verify", "--out", tmp_path / "nowhere")


def test_fresh_runs_what_is_stored_again(study, out, case_file):
    arguments = ["--cases", case_file, "--planners", "stub-seeded", "--seeds", 2, "--out", out, "--no-report"]
    before = study("digest", "--out", out)
    assert "2 cells, 2 stored already" in study("run", *arguments)
    assert "2 cells, 0 stored already" in study("run", *arguments, "--fresh", "--memory", 2000)
    assert study("digest", "--out", out) == before
