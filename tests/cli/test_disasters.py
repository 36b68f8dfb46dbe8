"""Whole commands on a disk that fills up and in a folder that goes away: one sentence, exit status 2, nothing lost."""

import shutil
import sqlite3
import subprocess
import time
from contextlib import closing

import pytest

from study.store.maintenance import verify
from tests.conftest import command
from tests.helpers.disks import mounted

pytestmark = pytest.mark.slow
RUN = ("run", "--cases", "woodworking", "--planners", "ruckig-stops,toppra", "--seeds", 1, "--no-report", "--jobs", 1)


@pytest.fixture
def disk(tmp_path):
    """A file system of a megabyte."""
    yield from mounted(tmp_path / "disk", "1m")


def sentence(ended):
    """What a command that ended badly says in the end."""
    assert ended.returncode == 2, ended.stderr
    assert "Traceback" not in ended.stderr
    return next(line for line in reversed(ended.stderr.splitlines()) if line.startswith("study: "))


def stored(path):
    """How many outcomes a results file holds that another process writes to."""
    try:
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as reader:
            return reader.execute("SELECT count(*) FROM results").fetchone()[0]
    except sqlite3.Error:
        return 0


def test_a_disk_that_is_full_for_the_recording_and_for_the_results(disk, study_process):
    out = disk / "o"
    assert study_process(*RUN, "--out", out).returncode == 0
    stored = verify(out / "results.sqlite")
    recording = out / "recordings" / "woodworking.rrd"
    recording.parent.mkdir()
    recording.write_bytes(b"old")
    assert f"recording {recording} cannot be written" in sentence(study_process("report", "--out", out))
    assert [path.read_bytes() for path in recording.parent.iterdir()] == [b"old"]
    with (disk / "filler").open("wb", buffering=0) as filler:
        while filler.write(b"x" * 4096) == 4096:
            if shutil.disk_usage(disk).free < 4096:
                break
    said = sentence(study_process(*RUN, "--fresh", "--out", out))
    assert "cannot use the results file" in said or "cannot write to the output folder" in said
    (disk / "filler").unlink()
    assert verify(out / "results.sqlite") == stored


def test_a_folder_that_goes_away_during_a_run(tmp_path):
    out = tmp_path / "gone"
    many = ("run", "--cases", "woodworking", "--planners", "pso", "--seeds", 60, "--evaluations", 5000, "--no-report")
    run = subprocess.Popen(
        command(*many, "--jobs", 1, "--out", out), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    end = time.monotonic() + 60
    while not stored(out / "results.sqlite") and time.monotonic() < end:
        time.sleep(0.02)
    out.rename(tmp_path / "elsewhere")  # as deleting it, but at one instant
    _, errors = run.communicate(timeout=100)
    ended = subprocess.CompletedProcess([], run.returncode, "", errors)
    assert "was deleted or replaced" in sentence(ended)
