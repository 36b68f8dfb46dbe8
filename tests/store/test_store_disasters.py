import json
import os
import sqlite3
import subprocess
import sys
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from study.errors import StudyError
from study.runs.execute import stored_results
from study.runs.remembered import LINEUP, remembered_lineup
from study.store.codec import MAGIC, checksum, pack_arrays, unpack_arrays
from study.store.file import writing
from study.store.maintenance import compact, export_columns, merge, tallies, verify
from study.store.row import CHECKED, SEALED, Row, row_digest
from study.store.store import Store
from tests.helpers.disks import mounted
from tests.helpers.stores import change, with_jobs

ROOT = Path(__file__).parents[2]


FILL = """
import os, resource, sys
from dataclasses import replace
from pathlib import Path
import numpy as np
from study.errors import StudyError
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.execute import CellJob
from study.store.store import Store
from tests.conftest import case_of
from tests.helpers.stores import TINY, with_jobs

case = case_of(TINY)
cell = make_cells([case], [Spec("stub-seeded")], Budget(1, 50))[0]
result = CellJob(cell, TINY).run()
stored = 0
if sys.argv[2] != "0":
    import signal
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
try:
    with Store(Path(sys.argv[1])) as store:
        for seed in range(10000):
            many = replace(result, cell=replace(cell, settings=replace(cell.settings, seed=seed)), history=np.full((500, 2), seed))
            store.add(*with_jobs([many]))
            stored += 1
except StudyError as error:
    print(stored, error)
"""


def fill(path: Path, most: int) -> tuple[int, str]:
    """Store until nothing fits any more; count what was stored and give the sentence."""
    command = [sys.executable, "-c", FILL, str(path), str(most)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=100)
    count, _, sentence = ended.stdout.strip().partition(" ")
    return int(count), sentence


def test_a_file_that_may_not_grow_is_one_sentence_and_keeps_all_that_was_stored(tmp_path, stubs):
    path = tmp_path / "r.sqlite"
    stored, sentence = fill(path, 300_000)
    assert stored > 3
    assert "\n" not in sentence
    assert sentence.startswith(f"cannot use the results file {path}: ")
    assert sentence.endswith("results stored before are safe: mend the cause and run again")
    assert verify(path) == (stored, [])


@pytest.fixture
def small_disk(tmp_path):
    """A file system of half a megabyte."""
    yield from mounted(tmp_path / "disk", "512k")


def test_a_full_disk_is_one_sentence_and_keeps_all_that_was_stored(small_disk, stubs):
    path = small_disk / "r.sqlite"
    stored, sentence = fill(path, 0)
    assert stored > 3
    assert "full" in sentence or "I/O" in sentence
    assert verify(path) == (stored, [])


def test_the_full_disk_of_a_run_that_has_not_begun_is_one_sentence(small_disk, tiny_case):
    (small_disk / "filler").write_bytes(b"x" * 512 * 1024)
    with pytest.raises(StudyError, match=r"cannot (use the results file|write to the output folder)"):
        Store(small_disk / "r.sqlite")


@pytest.mark.skipif(os.geteuid() != 0, reason="for everyone else, tests of the store look at permissions")
def test_a_read_only_disk_is_one_sentence_and_can_be_read(small_disk, tiny_case, cells, results):
    path = small_disk / "r.sqlite"
    with Store(path) as store:
        store.add(*with_jobs(results))
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    with pytest.raises(StudyError, match="cannot write to the output folder"):
        Store(path)
    with Store(path, write=False) as store:
        assert len(stored_results(store, cells, {"tiny": tiny_case})) == 4


@pytest.fixture
def filled(tmp_path, results):
    path = tmp_path / "r.sqlite"
    with Store(path) as store:
        store.add(*with_jobs(results))
    return path


def test_every_column_and_the_payload_stand_under_a_checksum(filled, results):
    names = [*CHECKED.split(", "), *SEALED.split(", "), "seal"]
    for number, name in enumerate(names, 1):
        other = (
            "0.5" if name in ("wall_time", "duration", "worst_ratio") else "1 - feasible" if name == "feasible" else "7"
        )
        other = other if name in ("seed", "evaluations") or "." in other or "-" in other else "'other'"
        change(filled, f"UPDATE results SET {name} = {other} WHERE id = 1")
        count, damaged = verify(filled)
        assert (count, len(damaged)) == (4, 1), name
        filled.unlink()
        with Store(filled) as store:
            store.add(*with_jobs(results))
        assert number


def test_a_deleted_file_is_said_at_the_next_result_and_at_the_end(filled, results):
    with pytest.raises(StudyError, match=r"results file .* was deleted or replaced while it was in use"), Store(filled):
        filled.unlink()
    with Store(filled) as store:
        store.add(*with_jobs(results[:1]))
        filled.unlink()
        filled.write_bytes(b"")
        with pytest.raises(StudyError, match="was deleted or replaced"):
            store.add(*with_jobs(results[1:]))
        with Store(filled.with_name("other")):
            pass
        filled.with_name("other").rename(filled)
        with pytest.raises(StudyError, match="was deleted or replaced"):
            store.note("a", 1)
        store._file = filled.stat().st_ino


def test_a_file_that_goes_away_while_it_is_opened_is_said(filled, monkeypatch):
    @contextmanager
    def leaving(path):
        with writing(path) as connection:
            path.unlink()
            yield connection

    monkeypatch.setattr("study.store.store.writing", leaving)
    with pytest.raises(StudyError, match="was deleted or replaced"):
        Store(filled)


READERS = {
    "open": lambda path: Store(path, write=False).close(),
    "write": lambda path: Store(path).close(),
    "verify": verify,
    "tallies": tallies,
    "export": lambda path: export_columns(path, path.with_name("e.csv")),
    "merge": lambda path: merge(path.with_name("m"), path),
    "compact": compact,
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("trap", ["fifo", "folder", "schema text", "view", "long"])
def test_hostile_files_end_in_one_sentence_at_once(filled, reader, trap):
    if trap in ("fifo", "folder"):
        filled.unlink()
        os.mkfifo(filled) if trap == "fifo" else filled.mkdir()
    elif trap == "schema text":  # one accidental byte that is no UTF-8
        content = filled.read_bytes()
        place = content.index(b"CREATE TABLE payloads")
        filled.write_bytes(content[:place] + b"\xff" + content[place + 1 :])
    elif trap == "view":
        change(
            filled,
            "DROP TABLE notes",
            "CREATE VIEW notes AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x FROM c",
        )
    else:
        filled = filled.with_name("x" * 4000)
    with pytest.raises(StudyError) as raised:
        READERS[reader](filled)
    assert "\n" not in str(raised.value)
    assert not list(filled.parent.glob("*.part"))


def test_a_folder_in_the_place_of_the_lock_is_one_sentence(tmp_path):
    (tmp_path / "r.sqlite.lock").mkdir()
    with pytest.raises(StudyError, match=r"cannot write to the output folder .*r\.sqlite\.lock"):
        Store(tmp_path / "r.sqlite")


@pytest.mark.parametrize("junk", ["duration = 'xyz'", "label = x'ff00'", "wall_time = 'abc'", "feasible = 7"])
def test_values_of_another_kind_are_found_before_anything_is_read(filled, junk, tmp_path):
    change(filled, f"UPDATE results SET {junk}")
    for read in (verify, tallies, lambda path: export_columns(path, tmp_path / "e.parquet")):
        with pytest.raises(StudyError, match="is damaged"):
            read(filled)
    assert not list(tmp_path.glob("e.*"))


def without_shape(name, blob):
    """Make one of a result's arrays a single row."""
    arrays = unpack_arrays(blob)
    return pack_arrays({**arrays, name: arrays[name].ravel()})


DEEP = "[" * 20_000


def other(*path_and_document, value):
    """Put a value of another kind into a result's document."""
    *path, document = path_and_document
    content = json.loads(document)
    place = content
    for name in path[:-1]:
        place = place[name]
    place[path[-1]] = value
    return json.dumps(content)


@pytest.mark.parametrize(
    ("part", "junk"),
    [
        ("document", "[1]"), ("document", "{"), ("document", "{}"), ("document", DEEP), ("arrays", b"PK"),
        ("arrays", MAGIC + len(DEEP).to_bytes(4, "little") + DEEP.encode()), ("times", "["), ("times", DEEP), ("status", "DONE"),
        *(("document", partial(other, *path, value=value)) for *path, value in (
            ("message", 3), ("iterations", "7"), ("iterations", True), ("details", {"stretch": [[]]}), ("lower_bound", {}),
            ("motion", "Elsewhere"), ("verdict", "duration", [[]]), ("verdict", "continuity", 1.5), ("verdict", "reasons", 0),
            ("verdict", "reasons", [None]),
        )),
        *(("arrays", partial(without_shape, name)) for name in ("history", "verdict.ratios", "verdict.times", "verdict.arm_shares")),
    ],
)  # fmt: skip
def test_junk_under_a_fitting_checksum_is_damage_too(filled, cells, tiny_case, part, junk):
    with closing(sqlite3.connect(filled)) as connection:
        row = Row.of(connection.execute(f"{Row.QUERY} WHERE results.id = 1").fetchone())
        forged = forge(row, part, junk)
        connection.execute("DELETE FROM results WHERE id = 1")
        connection.execute(
            f"INSERT INTO results ({CHECKED}, {SEALED}, seal, id) VALUES ({'?, ' * 17} 1)", forged.values
        )
        connection.execute(
            "UPDATE payloads SET document = ?, arrays = ? WHERE id = 1", (forged.document, forged.arrays)
        )
        connection.commit()
    assert len(verify(filled)[1]) == 1
    with Store(filled, write=False) as store, pytest.raises(StudyError, match=r"the row of stub-steady .* is damaged"):
        stored_results(store, cells, {"tiny": tiny_case})


@pytest.mark.parametrize("settings", [DEEP, "{", "[]", '{"curve": 1}', '{"no_such": 1}'])
def test_settings_of_a_line_up_that_cannot_be_read_are_one_sentence(filled, settings):
    with Store(filled) as store:
        store.note(LINEUP, {"cells": [["tiny", "centre", "centre", settings, [0]]], "sources": {"tiny": "tiny"}})
    with pytest.raises(StudyError, match="its line-up cannot be read"):
        remembered_lineup(filled)


def forge(row, part, junk):
    """Put junk into a row and make its checksums anew."""
    junk = junk(getattr(row, part)) if callable(junk) else junk
    if part in ("document", "arrays"):
        row = replace(row, **{part: junk})
    checked, sealed = list(row.checked), list(row.sealed)
    if part == "status":
        checked[CHECKED.split(", ").index("status")] = junk
    sealed[1] = row_digest(tuple(checked), row.document, row.arrays)
    if part == "times":
        sealed[3] = junk
    return replace(row, checked=tuple(checked), sealed=tuple(sealed), seal=checksum(sealed))
