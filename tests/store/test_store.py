import hashlib
import io
import json
import os
import sqlite3
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from study.curves import curve_named
from study.errors import StudyError
from study.judge import judge
from study.planning import Plan, Status
from study.problem import EndCondition, JointLimits, Problem, State, StraightPath, Timing, Tube
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.runner import Task, execute
from study.store import store as store_module
from study.store.codec import (
    RESULTS_FORMAT,
    canonical,
    cell_key,
    cell_key_in,
    decode,
    encode,
    pack_arrays,
    problem_digest,
    settings_text,
    unpack_arrays,
)
from study.store.results import Result
from study.store.store import Store, remembered_lineup


def same(a, b):
    """Compare two values to the last bit."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if hasattr(a, "__dataclass_fields__") and type(a) is type(b):
        return all(same(getattr(a, field.name), getattr(b, field.name)) for field in fields(a))
    return a == b


@pytest.fixture
def cells(stubs, tiny_case):
    return make_cells([tiny_case], [Spec("stub-steady"), Spec("stub-seeded")], Budget(3, 50))


@pytest.fixture
def results(cells, tiny_problem):
    return [execute(Task(cell, tiny_problem)) for cell in cells]


@pytest.fixture
def path(tmp_path):
    return tmp_path / "results.sqlite"


@pytest.fixture
def open_store(path, tiny_case):
    return lambda **options: Store(path, {"tiny": tiny_case}, **options)


def test_results_come_back_to_the_last_bit(open_store, cells, results):
    with open_store() as store:
        assert store.missing(cells) == cells
        store.add(*results)
        assert store.missing(cells) == []
    with open_store(write=False) as store:
        assert all(same(a, b) for a, b in zip(store.results(cells), results, strict=True))


def test_parametric_motions_infinite_history_and_failures_survive_too(tiny_problem, cells):
    motion = curve_named("bspline").motion(tiny_problem.waypoints, np.array([1.0, 1.2, 0.9]))
    free = replace(tiny_problem, end=EndCondition.FREE)
    history = np.array([[1.0, np.inf], [2.0, 3.1]])
    whole = Result(
        cells[0], Status.NOT_CONVERGED, "é", motion, judge(free, motion), None, 2, 1, history, {"bound": 1 / 3}, 0.25
    )
    for result in (whole, replace(whole, motion=None, verdict=None, status=Status.FAILED)):
        assert same(decode(cells[0], *encode(result), 0.25), result)
        assert encode(result) == encode(result)


def test_wall_times_among_the_details_are_kept_outside_the_digest(tmp_path, tiny_case, cells, results):
    digests = []
    for seconds in (0.1, 0.2):
        result = replace(results[0], details={"bound": 3.0, "solve_seconds": seconds})
        with Store(tmp_path / f"{seconds}", {"tiny": tiny_case}) as store:
            store.add(result)
            digests.append(store.digest())
            assert store.results(cells[:1])[0].details == {"bound": 3.0, "solve_seconds": seconds}
    assert digests[0] == digests[1]


def test_an_unknown_kind_of_motion_is_refused(cells):
    class Other:
        pass

    result = Result(cells[0], Status.FINISHED, "", Other(), None, None, 0, 0, np.empty((0, 2)), {}, 0.0)
    with pytest.raises(
        StudyError, match="must be one of Trajectory, ParametricTrajectory, the planner returned a Other"
    ):
        encode(result)


def test_arrays_with_pickled_objects_are_refused():
    with pytest.raises(ValueError, match="'a' is of object"):
        pack_arrays({"a": np.array([object()])})
    archive = io.BytesIO()
    np.savez(archive, a=np.array([object()]))
    with pytest.raises(ValueError, match="allow_pickle=False"):
        unpack_arrays(archive.getvalue())
    crafted = pack_arrays({"a": np.zeros(1)}).replace(b'"<f8"', b'"|O8"')
    with pytest.raises(ValueError, match="'a' is of object"):
        unpack_arrays(crafted)


def test_arrays_come_back_as_they_were_and_so_do_those_of_the_first_layout():
    arrays = {
        "a": np.arange(3.0),
        "b": np.zeros((0, 2)),
        "c": np.arange(6, dtype=np.int8).reshape(2, 3).T,
        "d": np.array(True),
    }
    archive = io.BytesIO()
    np.savez(archive, **arrays)
    for blob in (pack_arrays(arrays), archive.getvalue()):
        found = unpack_arrays(blob)
        assert list(found) == list(arrays)
        assert all(
            same(found[name], np.ascontiguousarray(array).reshape(array.shape)) for name, array in arrays.items()
        )


def test_the_key_follows_the_content(tiny_problem, cells):
    cell = cells[0]
    key = cell_key(cell, tiny_problem, "1")
    assert key == cell_key(replace(cell, label="another label"), tiny_problem, "1")
    waypoints = tiny_problem.waypoints.copy()
    waypoints[1, 1] = np.nextafter(waypoints[1, 1], 1)
    limits = tiny_problem.limits
    others = [
        cell_key(cell, replace(tiny_problem, waypoints=waypoints), "1"),
        cell_key(cell, replace(tiny_problem, limits=replace(limits, jerk=np.full(2, 9.0))), "1"),
        cell_key(cell, replace(tiny_problem, end=EndCondition.REST), "1"),
        cell_key(cell, replace(tiny_problem, path=Tube(0.1)), "1"),
        cell_key(cell, replace(tiny_problem, path=StraightPath(0.1)), "1"),
        cell_key(cell, tiny_problem, "2"),
        cell_key(replace(cell, planner="other"), tiny_problem, "1"),
        cell_key(replace(cell, settings=replace(cell.settings, seed=9)), tiny_problem, "1"),
    ]
    assert len({key, *others}) == 9


@pytest.mark.parametrize("curve", ["poly353", '"seed":0, \\"é'])
def test_keys_and_settings_that_are_put_together_are_the_plain_json(cells, curve):
    for seed in (0, 7, -3, 10**12):
        cell = replace(cells[0], settings=replace(cells[0].settings, seed=seed, curve=curve, time_limit=1e-4))
        text = canonical(vars(cell.settings))
        assert settings_text(cell.settings) == text
        whole = canonical([RESULTS_FORMAT, "problem", cell.planner, text, 'version "1"'])
        assert cell_key_in("problem", cell, 'version "1"') == hashlib.sha256(whole.encode()).hexdigest()


def test_a_changed_case_is_missing_again(path, tiny_case, cells, results, open_store):
    with open_store() as store:
        store.add(*results)
    slower = replace(tiny_case, problem=replace(tiny_case.problem, limits=JointLimits(np.array([0.5, 0.5]))))
    with Store(path, {"tiny": slower}) as store:
        assert store.missing(cells) == cells


def test_adding_twice_keeps_the_first(open_store, cells, results):
    with open_store() as store:
        store.add(*results)
        before = store.digest()
        store.add(*(replace(result, wall_time=99.0) for result in results))
        assert store.digest() == before
        assert max(result.wall_time for result in store.results(cells)) < 99


def test_the_digest_ignores_order_and_wall_time_and_nothing_else(tmp_path, tiny_case, results):
    def digest(name, results):
        with Store(tmp_path / name, {"tiny": tiny_case}) as store:
            store.add(*results)
            return store.digest()

    reference = digest("a", results)
    assert digest("b", [replace(r, wall_time=7.0) for r in reversed(results)]) == reference
    assert digest("c", results[:-1]) != reference
    assert digest("d", [replace(results[0], iterations=12), *results[1:]]) != reference


def test_the_lineup_of_the_last_run_is_remembered(path, open_store, cells):
    with open_store() as store:
        store.remember_lineup(cells, {"tiny": "tiny"})
        store.remember_lineup(cells[:2], {"tiny": "/somewhere/tiny.yaml"})
    assert remembered_lineup(path) == (cells[:2], {"tiny": "/somewhere/tiny.yaml"})


def test_a_second_writer_is_refused_and_readers_are_not(open_store, results, cells):
    with open_store() as store:
        store.add(*results)
        with pytest.raises(StudyError, match=r"another run is writing to .*results.sqlite"):
            open_store()
        with open_store(write=False) as reader:
            assert len(reader.results(cells)) == len(cells)
    open_store().close()


def test_asking_before_any_run_says_so(open_store):
    with pytest.raises(StudyError, match=r"there are no results at .*run `study run` first"):
        open_store(write=False)


@pytest.mark.parametrize("damage", ["text", "header", "middle", "cut"])
def test_a_damaged_file_is_refused_and_left_untouched(path, open_store, results, damage):
    with open_store() as store:
        store.add(*results)
    content = bytearray(path.read_bytes())
    if damage == "text":
        content = bytearray(b"these are no results, whatever their name says" * 30)
    elif damage == "header":
        content[:16] = b"\0" * 16
    elif damage == "middle":
        content[4096:12288] = os.urandom(8192)
    else:
        del content[len(content) // 2 :]
    path.write_bytes(content)
    for write in (True, False):
        with pytest.raises(StudyError, match=r"is damaged.*left untouched; move it away, or name another folder"):
            open_store(write=write)
    assert path.read_bytes() == content


def test_a_changed_number_is_noticed(path, open_store, cells, results):
    with open_store() as store:
        store.add(*results)
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE results SET duration = duration - 1")
    connection.close()
    with (
        open_store() as store,
        pytest.raises(StudyError, match=r"the row of stub-steady on tiny \(seed 0\) is damaged"),
    ):
        store.results(cells)


@pytest.mark.parametrize(
    ("statement", "sentence"),
    [
        ("PRAGMA application_id = 5", "is an SQLite file of another program"),
        ("PRAGMA user_version = 99", "has layout 99, this version reads up to"),
    ],
)
def test_files_of_others_and_of_the_future_are_refused(path, open_store, statement, sentence):
    open_store().close()
    connection = sqlite3.connect(path)
    connection.execute(statement)
    connection.close()
    with pytest.raises(StudyError, match=sentence):
        open_store()


def test_a_full_disk_loses_nothing_and_stores_no_half(open_store, cells, results, path):
    with open_store() as store:
        store.add(*results[:2])
        before = store.digest()
        pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
        store._connection.execute(f"PRAGMA max_page_count = {pages}")  # SQLite then answers as on a full disk
        large = [replace(r, history=np.zeros((5000, 2))) for r in results[2:]]
        with pytest.raises(StudyError, match="disk is full; results stored before are safe"):
            store.add(*large)
        assert store.digest() == before
    with open_store() as store:
        assert store.missing(cells) == cells[2:]
        store.add(*large)
        assert store.missing(cells) == []


def test_an_unwritable_folder_is_one_sentence(tmp_path, tiny_case):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StudyError, match=r"cannot make the output folder .*name another one with --out"):
        Store(tmp_path / "file" / "results.sqlite", {"tiny": tiny_case})


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may write anywhere")
def test_a_read_only_file_and_folder_are_one_sentence_each(tmp_path, path, open_store, cells, results):
    with open_store() as store:
        store.add(*results)
    path.chmod(0o400)
    with pytest.raises(StudyError, match=r"cannot use the results file .*readonly"):
        open_store()
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(StudyError, match="cannot write to the output folder"):
            open_store()
        with open_store(write=False) as store:
            assert len(store.results(cells)) == len(cells)
    finally:
        tmp_path.chmod(0o700)


def test_a_file_that_sqlite_may_not_write_is_one_sentence(open_store, monkeypatch, results):
    open_store().close()
    connect = sqlite3.connect

    def read_only(target, **options):
        name = str(target)
        return (
            connect(f"{Path(name).as_uri()}?mode=ro", uri=True, **options)
            if name.endswith(".sqlite")
            else connect(target, **options)
        )

    monkeypatch.setattr(store_module.sqlite3, "connect", read_only)
    with pytest.raises(StudyError, match="attempt to write a readonly database"):
        open_store()


def test_documents_are_plain_json(results):
    document = json.loads(encode(results[0])[0])
    assert document["status"] == "FINISHED"
    assert document["motion"] == "Trajectory"
    assert Status[document["status"]] is Plan(Status.FINISHED).status


def test_infinite_limits_have_a_key_too(cells):
    problem = Problem("p", np.array([[0.0], [1.0]]), JointLimits(np.ones(1)))
    assert len(cell_key(cells[0], problem, "1")) == 64


@pytest.mark.parametrize(
    "change",
    [
        {"stops": (1,)},
        {"dwells": {1: 0.5}},
        {"tolerance": 0.01},
        {"start": State(velocity=np.array([0.1]))},
        {"segment_limits": {0: JointLimits(velocity=[0.5])}},
        {"timing": Timing(at_least=9.0)},
        {"limits": JointLimits(velocity=[1.0], min_velocity=[-0.5])},
    ],
    ids=lambda change: next(iter(change)),
)
def test_everything_that_a_problem_asks_is_part_of_its_key(change):
    problem = Problem("keyed", np.array([[0.0], [0.5], [0.2]]), JointLimits(velocity=[1.0]))
    assert problem_digest(replace(problem, **change)) != problem_digest(problem)
