import csv
import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
import pytest

from study.errors import StudyError
from study.planning import Status
from study.runs.execute import cell_jobs, stored_results
from study.store import maintenance as storekeeping
from study.store.maintenance import compact, export_columns, merge, tallies, verify
from study.store.store import Store
from tests.helpers.stores import change, with_jobs


@pytest.fixture
def make(tmp_path):
    """Make a results file that holds some results."""

    def make_file(name, *results):
        path = tmp_path / name
        with Store(path) as store:
            store.add(*with_jobs(results))
        return path

    return make_file


def digest_of(path):
    with Store(path, write=False) as store:
        return store.digest()


def test_a_whole_file_is_verified_and_each_kind_of_damage_is_found(make, results):
    path = make("r", *results)
    assert verify(path) == (4, [])
    change(path, "UPDATE results SET duration = duration + 1e-12 WHERE seed = 1")
    assert verify(path) == (4, ["stub-seeded on tiny (seed 1): its checksum does not fit"])
    change(path, "UPDATE payloads SET arrays = zeroblob(9) WHERE id = 1")
    change(path, "DELETE FROM payloads WHERE id = 2", "INSERT INTO payloads VALUES (77, '', x'')")
    count, damaged = verify(path)
    assert count == 4
    assert "1 payloads without a result" in damaged
    assert len(damaged) >= 3


def test_columns_are_exported_and_names_are_no_formulas(make, results, tmp_path):
    path = make("r", *results)
    change(path, "UPDATE results SET subject = '=cmd()' WHERE seed = 2")
    assert export_columns(path, tmp_path / "r.csv") == export_columns(path, tmp_path / "r.parquet") == 4
    rows = list(csv.DictReader((tmp_path / "r.csv").read_text().splitlines()))
    table = parquet.read_table(tmp_path / "r.parquet").to_pylist()
    assert [float(row["duration"]) for row in rows] == [row["duration"] for row in table]
    assert sorted(row["duration"] for row in table) == sorted(result.verdict.duration for result in results)
    assert {row["subject"] for row in rows} == {"tiny", "'=cmd()"}
    assert {row["feasible"] for row in table} == {True}
    with pytest.raises(StudyError, match=r"ends in \.csv or \.parquet"):
        export_columns(path, tmp_path / "r.xlsx")
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="file"):
        export_columns(path, tmp_path / "file" / "r.csv")
    assert not list(tmp_path.glob("*.part"))


def test_merging_adds_what_is_new_keeps_its_own_and_says_what_is_contrary(make, results, cells, tiny_case):
    whole = digest_of(make("whole", *results))
    ours, theirs = make("ours", *results[:3]), make("theirs", *results[1:])
    assert merge(ours, theirs) == storekeeping.Merged(added=1, known=2, contrary=0)
    assert digest_of(ours) == whole
    with Store(ours) as store:
        assert [result.cell for result in stored_results(store, cells, {"tiny": tiny_case})] == cells
    odd = make("odd", replace(results[0], iterations=99))
    assert merge(ours, odd) == storekeeping.Merged(added=0, known=0, contrary=1)
    assert digest_of(ours) == whole
    assert verify(ours) == (4, [])


def test_merging_refuses_damaged_files_itself_and_nothing(make, results, tmp_path):
    ours, theirs = make("ours", *results[:1]), make("theirs", *results)
    before = digest_of(ours)
    change(theirs, "UPDATE results SET evaluations = 0 WHERE seed = 2")
    with pytest.raises(StudyError, match=r"is damaged: stub-seeded on tiny \(seed 2\): .*; nothing was merged"):
        merge(ours, theirs)
    with pytest.raises(StudyError, match="cannot be merged into itself"):
        merge(ours, ours)
    with pytest.raises(StudyError, match="there are no results at"):
        merge(ours, tmp_path / "none")
    assert digest_of(ours) == before


def test_compacting_gives_room_back_and_drops_only_results_of_other_code(make, results, cells, tiny_case):
    large = [replace(result, history=np.zeros((20000, 2))) for result in results]
    path = make("r", *large)
    old = '{"planner stub-seeded":"stub-planners 0.9; code 0"}'
    change(path, f"UPDATE results SET code = '{old}' WHERE seed = 2")
    assert compact(path) == (0, 0)
    dropped, won = compact(path, drop_stale=True)
    assert dropped == 1
    assert won > 200_000
    assert verify(path) == (3, [])
    jobs = cell_jobs(cells, {"tiny": tiny_case})
    with Store(path) as store:
        assert store.missing(jobs) == [job for job in jobs if job.seed == 2]


def test_a_sweep_is_tallied(make, results):
    late = replace(results[1], status=Status.TIMED_OUT, motion=None, verdict=None)
    steady, seeded = sorted(tallies(make("r", results[0], late, *results[2:])), key=lambda row: row.count)
    assert (steady.label, steady.count, steady.feasible, steady.cut_short) == ("stub-steady", 1, 1, 0)
    assert (seeded.label, seeded.count, seeded.feasible, seeded.cut_short) == ("stub-seeded", 3, 2, 1)
    durations = [result.verdict.duration for result in results[2:]]
    assert (seeded.best, seeded.mean) == (min(durations), pytest.approx(sum(durations) / 2))


def test_the_tables_of_a_sweep_come_from_an_index_and_keys_are_looked_up(make, results):
    """Counted work in place of time: no query of a run or a table may read every row."""
    with closing(sqlite3.connect(make("r", *results))) as connection:

        def plan(query):
            return " ".join(row[3] for row in connection.execute(f"EXPLAIN QUERY PLAN {query}"))

        tally = plan(
            "SELECT subject, label, count(*), sum(feasible), sum(wall_time) FROM results WHERE kind = 'cell' GROUP BY subject, label"
        )
        assert "COVERING INDEX results_by_label" in tally
        assert "TEMP B-TREE" not in tally
        assert "SEARCH results USING COVERING INDEX" in plan("SELECT 1 FROM results WHERE key = 'x'")


def test_storing_a_thousand_cells_is_one_transaction_and_encodes_each_once(tmp_path, tiny_case, results, monkeypatch):
    many = [
        replace(results[1], cell=replace(results[1].cell, settings=replace(results[1].cell.settings, seed=seed)))
        for seed in range(1000)
    ]
    statements = []
    with Store(tmp_path / "r") as store:
        store._connection.set_trace_callback(statements.append)
        store.add(*with_jobs(many))
    assert [text for text in statements if text.startswith(("BEGIN", "COMMIT"))] == ["BEGIN IMMEDIATE", "COMMIT"]
    assert sum(text.startswith("INSERT") for text in statements) == 2 * 1000
    assert len(statements) <= 2 * 1000 + 4


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_million_cells_stay_usable(tmp_path, tiny_case, results):
    n = int(os.environ.get("STUDY_CELLS", "1000000"))
    cell = results[1].cell
    path = tmp_path / "r"
    spent = {name: np.zeros(2) for name in ("insert", "tally", "missing")}

    def timed(name, call):
        clocks = time.perf_counter, time.process_time
        begun = np.array([clock() for clock in clocks])
        answer = call()
        spent[name] += np.array([clock() for clock in clocks]) - begun
        return answer

    with Store(path) as store:
        for first in range(0, n, 5000):
            cells = [replace(cell, settings=replace(cell.settings, seed=seed)) for seed in range(first, first + 5000)]
            batch = [replace(results[1], cell=one) for one in cells]
            timed("insert", lambda batch=batch: store.add(*with_jobs(batch)))
        every = [replace(cell, settings=replace(cell.settings, seed=seed)) for seed in range(n + 1)]
        jobs = cell_jobs(every, {"tiny": tiny_case})
        assert timed("missing", lambda: store.missing(jobs)) == jobs[n:]
    assert [row.count for row in timed("tally", lambda: tallies(path))] == [n]
    print(f"\n{n:,} cells of {path.stat().st_size / n:,.0f} bytes; wall time, and processor time of this process:")
    for name, (wall, work) in spent.items():
        print(f"{name}: {wall:.2f} s, {work:.2f} s; {n / wall:,.0f} cells/s, {n / work:,.0f} cells per busy second")


KILLED = """
import sys
from dataclasses import replace
from pathlib import Path
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.execute import CellJob
from study.store.kept import key_of
from study.store.store import Store
from tests.conftest import case_of
from tests.helpers.stores import TINY, with_jobs

case = case_of(TINY)
cell = make_cells([case], [Spec("stub-seeded")], Budget(1, 50))[0]
result = CellJob(cell, TINY).run()
first = int(sys.argv[2])
with Store(Path(sys.argv[1])) as store:
    key_of(CellJob(cell, TINY))  # reads the planner's sources, which takes longer than storing: the moments are to be among the writes
    print("ready", flush=True)
    for seed in range(first, first + 100_000):
        store.add(*with_jobs([replace(result, cell=replace(cell, settings=replace(cell.settings, seed=seed)))]))
        print(seed, flush=True)  # only what is stored is told
"""


def kill_loop(path: Path, moments: int) -> tuple[int, int]:
    """Kill a writer at random moments; count the cells that it told of and that are gone, and the moments tried."""
    from random import Random

    random, told = Random(7), set[int]()
    for _ in range(moments):
        command = [sys.executable, "-c", KILLED, str(path), str(max(told, default=-1) + 1)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, cwd=Path(__file__).parents[2])
        assert process.stdout.readline() == b"ready\n"
        time.sleep(random.uniform(0.0, 0.15))
        os.kill(process.pid, signal.SIGKILL)
        lines = process.stdout.read().split(b"\n")
        process.wait()
        process.stdout.close()
        told |= {int(line) for line in lines[:-1]}
        _, damaged = verify(path)
        assert damaged == []
    with closing(sqlite3.connect(path)) as connection:
        kept = {seed for (seed,) in connection.execute("SELECT seed FROM results JOIN payloads USING (id)")}
    return len(told), len(told - kept)


@pytest.mark.parametrize("moments", [5, pytest.param(200, marks=[pytest.mark.slow, pytest.mark.timeout(1500)])])
def test_kill_9_at_random_moments_loses_no_cell(tmp_path, stubs, moments):
    told, lost = kill_loop(tmp_path / "r", moments)
    print(f"\nmoments tried: {moments}, cells told: {told}, cells lost: {lost}")
    assert told > 0
    assert lost == 0
