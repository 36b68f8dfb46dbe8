import os
from dataclasses import fields, replace

import numpy as np
import pytest

from study.curves import curve_named
from study.errors import StudyError
from study.judge import judge
from study.planning import Status
from study.problem import EndCondition, JointLimits, Problem, State, StraightPath, Timing, Tube
from study.runs.execute import CellJob, cell_jobs, stored_results
from study.runs.remembered import remember_lineup, remembered_lineup
from study.store.codec import decode, encode, pack_arrays, plain, problem_digest, unpack_arrays
from study.store.kept import key_of
from study.store.results import Result
from study.store.store import Store
from tests.conftest import case_of
from tests.helpers.stores import TINY, change, with_jobs

TINY_CASES = {"tiny": case_of(TINY)}


def same(a, b):
    """Compare two values to the last bit."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if hasattr(a, "__dataclass_fields__") and type(a) is type(b):
        return all(same(getattr(a, field.name), getattr(b, field.name)) for field in fields(a))
    return a == b


@pytest.fixture
def jobs(cells):
    return cell_jobs(cells, TINY_CASES)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "results.sqlite"


@pytest.fixture
def open_store(path):
    return lambda **options: Store(path, **options)


def test_results_come_back_to_the_last_bit(open_store, cells, jobs, results):
    with open_store() as store:
        assert store.missing(jobs) == jobs
        store.add(*with_jobs(results))
        assert store.missing(jobs) == []
    with open_store(write=False) as store:
        assert all(same(a, b) for a, b in zip(stored_results(store, cells, TINY_CASES), results, strict=True))


def test_parametric_motions_infinite_history_and_failures_survive_too(tiny_problem, cells):
    motion = curve_named("bspline").motion(tiny_problem.waypoints, np.array([1.0, 1.2, 0.9]))
    free = replace(tiny_problem, end=EndCondition.FREE)
    history = np.array([[1.0, np.inf], [2.0, 3.1]])
    whole = Result(
        Status.NOT_CONVERGED,
        motion,
        None,
        2,
        1,
        history,
        "é",
        {"bound": 1 / 3},
        cell=cells[0],
        verdict=judge(free, motion),
        wall_time=0.25,
    )
    proved = replace(whole, motion=None, verdict=None, lower_bound=1 / 7)
    for result in (whole, proved, replace(whole, motion=None, verdict=None, status=Status.FAILED)):
        assert same(decode(cells[0], encode(result)), result)


def test_wall_times_among_the_details_are_kept_outside_the_digest(tmp_path, tiny_case, cells, results):
    digests = []
    for seconds in (0.1, 0.2):
        result = replace(results[0], details={"bound": 3.0, "solve_seconds": seconds})
        with Store(tmp_path / f"{seconds}") as store:
            store.add(*with_jobs([result]))
            digests.append(store.digest())
            assert stored_results(store, cells[:1], TINY_CASES)[0].details == {"bound": 3.0, "solve_seconds": seconds}
    assert digests[0] == digests[1]


def test_an_unknown_kind_of_motion_is_refused(cells):
    class Other:
        pass

    result = Result(Status.FINISHED, Other(), cell=cells[0])
    with pytest.raises(
        StudyError, match="must be one of Trajectory, ParametricTrajectory, the planner returned a Other"
    ):
        encode(result)


def test_arrays_with_pickled_objects_are_refused():
    with pytest.raises(ValueError, match="'a' is of object"):
        pack_arrays({"a": np.array([object()])})
    crafted = pack_arrays({"a": np.zeros(1)}).replace(b'"<f8"', b'"|O8"')
    with pytest.raises(ValueError, match="'a' is of object"):
        unpack_arrays(crafted)


def test_adding_twice_keeps_the_first(open_store, cells, results):
    with open_store() as store:
        store.add(*with_jobs(results))
        before = store.digest()
        store.add(*with_jobs(replace(result, wall_time=99.0) for result in results))
        assert store.digest() == before
        assert max(result.wall_time for result in stored_results(store, cells, TINY_CASES)) < 99


def test_the_digest_ignores_order_and_wall_time_and_nothing_else(tmp_path, tiny_case, results):
    def digest(name, results):
        with Store(tmp_path / name) as store:
            store.add(*with_jobs(results))
            return store.digest()

    reference = digest("a", results)
    assert digest("b", [replace(r, wall_time=7.0) for r in reversed(results)]) == reference
    assert digest("c", results[:-1]) != reference
    assert digest("d", [replace(results[0], iterations=12), *results[1:]]) != reference


def test_a_second_writer_is_refused_and_readers_are_not(open_store, results, cells):
    with open_store() as store:
        store.add(*with_jobs(results))
        with pytest.raises(StudyError, match=r"another run is writing to .*results.sqlite"):
            open_store()
        with open_store(write=False) as reader:
            assert len(stored_results(reader, cells, TINY_CASES)) == len(cells)
    open_store().close()


def test_asking_before_any_run_says_so(open_store):
    with pytest.raises(StudyError, match=r"there are no results at .*run `study run` first"):
        open_store(write=False)


@pytest.mark.parametrize("damage", ["text", "header", "middle", "cut"])
def test_a_damaged_file_is_refused_and_left_untouched(path, open_store, results, damage):
    with open_store() as store:
        store.add(*with_jobs(results))
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
        store.add(*with_jobs(results))
    change(path, "UPDATE results SET duration = duration - 1")
    with (
        open_store() as store,
        pytest.raises(StudyError, match=r"the row of stub-steady on tiny \(seed 0\) is damaged"),
    ):
        stored_results(store, cells, TINY_CASES)


@pytest.mark.parametrize(
    ("statement", "sentence"),
    [
        ("PRAGMA application_id = 5", "is an SQLite file of another program"),
        ("PRAGMA user_version = 99", "has layout 99, this version reads layout 3"),
        ("PRAGMA user_version = -1", "has layout -1, this version reads layout 3"),
        ("PRAGMA user_version = 2", "has layout 2 of an earlier version, whose results would all be run again"),
        ("CREATE VIEW trials AS SELECT 1", r"has other tables than this program makes \('trials'\)"),
        ("CREATE TRIGGER t AFTER INSERT ON notes BEGIN DELETE FROM results; END", r"other tables .* \('t'\)"),
        ("DROP INDEX results_by_label", r"other tables .* \('results_by_label'\)"),
    ],
)
def test_files_of_others_of_the_past_and_of_the_future_are_refused_untouched(path, open_store, statement, sentence):
    open_store().close()
    change(path, "PRAGMA journal_mode = DELETE", statement)
    before = path.read_bytes()
    for write in (True, False):
        with pytest.raises(StudyError, match=sentence):
            open_store(write=write)
    assert path.read_bytes() == before


def test_a_full_disk_loses_nothing_and_stores_no_half(open_store, jobs, results):
    with open_store() as store:
        store.add(*with_jobs(results[:2]))
        before = store.digest()
        pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
        store._connection.execute(f"PRAGMA max_page_count = {pages}")  # SQLite then answers as on a full disk
        large = [replace(r, history=np.zeros((5000, 2))) for r in results[2:]]
        with pytest.raises(StudyError, match="disk is full; results stored before are safe"):
            store.add(*with_jobs(large))
        assert store.digest() == before
    with open_store() as store:
        assert store.missing(jobs) == jobs[2:]
        store.add(*with_jobs(large))
        assert store.missing(jobs) == []


def test_an_unwritable_folder_is_one_sentence(tmp_path, tiny_case):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StudyError, match=r"cannot make the output folder .*name another one with --out"):
        Store(tmp_path / "file" / "results.sqlite")


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may write anywhere")
def test_a_read_only_file_and_folder_are_one_sentence_each(tmp_path, path, open_store, cells, results):
    with open_store() as store:
        store.add(*with_jobs(results))
    path.chmod(0o400)
    with pytest.raises(StudyError, match=r"cannot use the results file .*readonly"):
        open_store()
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(StudyError, match="cannot write to the output folder"):
            open_store()
        with open_store(write=False) as store:
            assert len(stored_results(store, cells, TINY_CASES)) == len(cells)
    finally:
        tmp_path.chmod(0o700)


def test_arrays_come_back_as_they_were():
    arrays = {
        "a": np.arange(3.0),
        "b": np.zeros((0, 2)),
        "c": np.arange(6, dtype=np.int8).reshape(2, 3).T,
        "d": np.array(True),
    }
    found = unpack_arrays(pack_arrays(arrays))
    assert list(found) == list(arrays)
    assert all(same(found[name], np.ascontiguousarray(array).reshape(array.shape)) for name, array in arrays.items())
    with pytest.raises(ValueError, match="no block of arrays"):
        unpack_arrays(b"PK")


def test_the_key_follows_the_content(tiny_problem, cells):
    cell = cells[1]
    key = key_of(CellJob(cell, tiny_problem))
    assert key == key_of(CellJob(replace(cell, label="another label"), tiny_problem))
    waypoints = tiny_problem.waypoints.copy()
    waypoints[1, 1] = np.nextafter(waypoints[1, 1], 1)
    limits = tiny_problem.limits
    others = [
        CellJob(cell, replace(tiny_problem, waypoints=waypoints)),
        CellJob(cell, replace(tiny_problem, limits=replace(limits, jerk=np.full(2, 9.0)))),
        CellJob(cell, replace(tiny_problem, end=EndCondition.REST)),
        CellJob(cell, replace(tiny_problem, path=Tube(0.1))),
        CellJob(cell, replace(tiny_problem, path=StraightPath(0.1))),
        CellJob(replace(cell, planner="stub-steady"), tiny_problem),
        CellJob(replace(cell, settings=replace(cell.settings, seed=9)), tiny_problem),
        CellJob(replace(cell, settings=replace(cell.settings, time_limit=9.0)), tiny_problem),
    ]
    assert len({key, *map(key_of, others)}) == 9


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


def test_a_job_that_is_asked_for_twice_is_missing_once(open_store, jobs, cells):
    with open_store() as store:
        assert store.missing([*jobs, *cell_jobs(cells, TINY_CASES)]) == jobs


def test_a_checksum_is_made_of_all_that_an_object_holds_or_not_at_all():
    kept = plain({"problem": TINY, "seeds": range(2), "status": Status.FAILED})
    assert kept["seeds"] == [0, 1]
    assert kept["problem"][1]["limits"][1]["velocity"] == [1.0, 0.8]
    assert kept["status"] == Status.FAILED.name
    with pytest.raises(TypeError, match="no checksum can be made of <function"):
        plain([lambda: None])


def test_the_lineup_of_the_last_run_is_remembered(path, open_store, cells):
    with open_store() as store:
        remember_lineup(store, cells, {"tiny": "tiny"})
        remember_lineup(store, cells[:2], {"tiny": "/somewhere/tiny.yaml"})
    assert remembered_lineup(path) == (cells[:2], {"tiny": "/somewhere/tiny.yaml"})


@pytest.mark.parametrize(
    "content",
    [
        {},
        {"cells": [[1]], "sources": {}},
        [1],
        {"cells": [["c", "p", "l", "{", [1]]], "sources": {}},
        *(
            {"cells": [["c", "p", "l", '{"curve": "bspline"}', [seed]]], "sources": {}}
            for seed in (np.inf, -1, 1.5, 2**70, "1")
        ),
    ],
)
def test_a_lineup_that_cannot_be_read_is_one_sentence(path, open_store, content):
    with open_store() as store:
        store.note("line-up", content)
    if content:
        with pytest.raises(StudyError, match="its line-up cannot be read"):
            remembered_lineup(path)
    change(path, "UPDATE notes SET text = '[]'")
    with pytest.raises(StudyError, match="its note 'line-up' is damaged"):
        remembered_lineup(path)
