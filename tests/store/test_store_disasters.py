import os
import shutil
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from study.errors import StudyError
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.runner import Task, execute
from study.store import schema as layout
from study.store.codec import pack_arrays
from study.store.maintenance import verify
from study.store.store import CHECKED, Store, remembered_lineup, row_digest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def cells(stubs, tiny_case):
    return make_cells([tiny_case], [Spec("stub-steady"), Spec("stub-seeded")], Budget(3, 50))


@pytest.fixture
def results(cells, tiny_problem):
    return [execute(Task(cell, tiny_problem)) for cell in cells]


@pytest.fixture
def old_file(tmp_path, cells, results, tiny_case):
    """A file of the first layout, with the same rows and line-up, and its digest."""
    path, new = tmp_path / "old.sqlite", tmp_path / "new.sqlite"
    with Store(new, {"tiny": tiny_case}) as store:
        store.add(*results)
        store.remember_lineup(cells, {"tiny": "tiny"})
        digest = store.digest()
    names = f"{CHECKED}, digest, wall_time, times"
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(
            f"{layout.SCHEMA_1} PRAGMA application_id = {layout.APPLICATION_ID}; PRAGMA user_version = 1;"
        )
        connection.execute("ATTACH ? AS new", (str(new),))
        connection.execute(f"INSERT INTO results ({names}) SELECT {names} FROM new.results")
        connection.execute(
            "INSERT INTO payloads SELECT key, document, arrays FROM new.results JOIN new.payloads USING (id)"
        )
        connection.execute("INSERT INTO lineup SELECT * FROM new.lineup")
        connection.commit()
    return path, digest


@pytest.mark.parametrize("write", [True, False])
def test_a_file_of_the_first_layout_is_brought_to_this_one(old_file, cells, tiny_case, write):
    path, digest = old_file
    with Store(path, {"tiny": tiny_case}, write=write) as store:
        assert store.digest() == digest
        assert [result.cell for result in store.results(cells)] == cells
    assert verify(path) == (4, [])
    assert remembered_lineup(path) == (cells, {"tiny": "tiny"})
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (layout.SCHEMA_VERSION,)
        labels = connection.execute("SELECT DISTINCT label FROM results ORDER BY label").fetchall()
        assert labels == [("stub-seeded",), ("stub-steady",)]


def test_a_migration_that_fails_leaves_the_old_file_as_it_was(old_file, tiny_case, monkeypatch):
    path, _ = old_file
    before = path.read_bytes()
    monkeypatch.setitem(layout.MIGRATIONS, 1, layout.MIGRATIONS[1] + "INSERT INTO nowhere VALUES (1);")
    with pytest.raises(StudyError, match="no such table: nowhere"):
        Store(path, {"tiny": tiny_case})
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (1,)
        assert connection.execute("SELECT count(*) FROM payloads JOIN results USING (key)").fetchone() == (4,)
    assert path.read_bytes()[100:] == before[100:]  # the header notes the journal mode


FILL = """
import os, resource, sys
from dataclasses import replace
from pathlib import Path
import numpy as np
from study.errors import StudyError
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.runner import Task, execute
from study.store.store import Store
from tests.conftest import case_of
from tests.helpers.stores import TINY

case = case_of(TINY)
cell = make_cells([case], [Spec("stub-seeded")], Budget(1, 50))[0]
result = execute(Task(cell, TINY))
stored = 0
if sys.argv[2] != "0":
    import signal
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
try:
    with Store(Path(sys.argv[1]), {"tiny": case}) as store:
        for seed in range(10000):
            many = replace(result, cell=replace(cell, settings=replace(cell.settings, seed=seed)), history=np.full((500, 2), seed))
            store.add(many)
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
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = shutil.which("mount") and subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=512k", "none", str(folder)], capture_output=True, check=False
    )
    if not mounted or mounted.returncode:
        pytest.skip("mounting is not allowed here")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)


def test_a_full_disk_is_one_sentence_and_keeps_all_that_was_stored(small_disk, stubs):
    path = small_disk / "r.sqlite"
    stored, sentence = fill(path, 0)
    assert stored > 3
    assert "full" in sentence or "I/O" in sentence
    assert verify(path) == (stored, [])


def test_the_full_disk_of_a_run_that_has_not_begun_is_one_sentence(small_disk, tiny_case):
    (small_disk / "filler").write_bytes(b"x" * 512 * 1024)
    with pytest.raises(StudyError, match=r"cannot (use the results file|write to the output folder)"):
        Store(small_disk / "r.sqlite", {"tiny": tiny_case})


@pytest.mark.skipif(os.geteuid() != 0, reason="for everyone else, tests of the store look at permissions")
def test_a_read_only_disk_is_one_sentence_and_can_be_read(small_disk, tiny_case, cells, results):
    path = small_disk / "r.sqlite"
    with Store(path, {"tiny": tiny_case}) as store:
        store.add(*results)
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    with pytest.raises(StudyError, match="cannot write to the output folder"):
        Store(path, {"tiny": tiny_case})
    with Store(path, {"tiny": tiny_case}, write=False) as store:
        assert len(store.results(cells)) == 4


def test_rows_written_by_hand_carry_a_checksum_of_exactly_their_columns(tmp_path, tiny_case, results):
    path = tmp_path / "r.sqlite"
    with Store(path, {"tiny": tiny_case}) as store:
        store.add(results[0])
    with closing(sqlite3.connect(path)) as connection:
        *columns, digest, document, arrays = connection.execute(
            f"SELECT {CHECKED}, digest, document, arrays FROM results JOIN payloads USING (id)"
        ).fetchone()
    assert row_digest(tuple(columns), document, arrays) == digest
    for k in range(len(columns)):
        changed = [*columns[:k], "other", *columns[k + 1 :]]
        assert row_digest(tuple(changed), document, arrays) != digest
    assert row_digest(tuple(columns), document, pack_arrays({})) != digest
