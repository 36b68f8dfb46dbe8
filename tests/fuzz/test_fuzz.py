"""The fuzzer itself: its valid files are read, it repeats, and it sees what it is there to see."""

import json
import time
from contextlib import ExitStack

import pytest
from hypothesis import HealthCheck, given, settings

from study.errors import StudyError
from tests.fuzz import __main__ as command
from tests.fuzz.files import spoilt
from tests.fuzz.targets import READERS, Target, prepared, target


@pytest.mark.parametrize("reader", READERS)
def test_the_files_that_are_spoilt_can_be_read(reader):
    chosen = target(reader)
    if not chosen.seeds:
        pytest.skip("its package is not installed")
    with ExitStack() as stack:
        folder = prepared(chosen, stack)
        assert {name: chosen(folder, name, content) for name, content in chosen.seeds.items()} == dict.fromkeys(
            chosen.seeds, ""
        )


def drawn(reader):
    files = []

    @settings(max_examples=30, database=None, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
    @given(spoilt(target(reader).seeds))
    def draw(file):
        files.append(file)

    draw()
    return files


@pytest.mark.parametrize("reader", ["case", "store", "arrays"])
def test_the_same_seed_spoils_files_in_the_same_way_and_nearly_every_file(reader):
    files = drawn(reader)
    assert [name for name, _ in files] == [name for name, _ in drawn(reader)]
    assert reader == "store" or files == drawn(reader)  # SQLite counts its changes
    assert sum(content != target(reader).seeds[name] for name, content in files) > len(files) / 2


def misread(path):
    """A reader with three faults and one good sentence."""
    text = path.read_text()
    if "slow" in text:
        while True:
            pass
    if "deep" in text:
        json.loads("[" * 10**6)
    if "wrong" in text:
        raise StudyError("a file\nand what is wrong")
    print("\x1b[31m" if "screen" in text else "fine")


def test_every_kind_of_failure_is_counted_and_its_first_input_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(command, "SLOW", 0.3)
    monkeypatch.setattr(command, "processor_time", time.process_time)  # children of other tests may be reaped meanwhile
    monkeypatch.setattr(command, "MEMORY", 10**12)  # other tests may have taken much in this process
    monkeypatch.setattr(command, "target", lambda name: Target({}, misread, {}))
    fuzzer = command.Fuzzer("misread", tmp_path / "kept")
    (tmp_path / "kept").mkdir()
    command.signal.signal(command.signal.SIGPROF, command.interrupt)
    for text in ("plain", "slow", "deep", "deep again", "wrong", "screen"):
        fuzzer(tmp_path, "a.txt", text.encode())
    assert (fuzzer.read, fuzzer.refused, sum(fuzzer.failures.values())) == (1, 1, 4)
    assert {kind.split(" ")[0] for kind in fuzzer.failures} == {"TooSlow", "RecursionError", "AssertionError"}
    assert {path.read_text() for path in (tmp_path / "kept").iterdir()} == {"slow", "deep", "screen"}


def test_the_command_prints_figures_of_every_reader(capfd, monkeypatch):
    monkeypatch.setattr(command.sys, "argv", ["fuzz", "csv", "--seconds", "0.2"])
    assert command.main() == 0
    row = capfd.readouterr().out.splitlines()[1].split()
    assert row[0] == "csv"
    assert int(row[1]) > 3
    assert row[4] == "0"
