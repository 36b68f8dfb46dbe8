"""Exports of a suite's runs: what other platforms' readers find is what the runs say, failures included."""

import json
import math
from dataclasses import replace

import pytest

from study.cases.suites import suite_named
from study.cli.suite_run import exported
from study.errors import StudyError
from study.suites.export import Platform, export
from study.suites.measures import FAILED, Field
from study.suites.runs import Run, read_runs

FOUND = Run(
    "scaling:s3-j7-a", 3, 7, False, "pso", "case's curve", 1000, 0, "FINISHED", True, 2.02, 1.0, 2.0, 0.0, "", 1000,
    (50, 400), (0.25, 0.0),
)  # fmt: skip
FAILURE = replace(FOUND, seed=1, feasible=False, duration=math.inf, curve_evaluations=(), curve_above=())
OLD = replace(FOUND, problem="scaling:s9-j7-a", segments=9, spent=0, curve_evaluations=(), curve_above=())
EXACT = replace(FOUND, planner="casadi-nlp", evaluations=0, spent=0, duration=2.0, curve_evaluations=(), curve_above=())


@pytest.fixture
def field():
    return Field(
        (FOUND, FAILURE, OLD, EXACT), {(f"scaling:{name}", "case's curve"): 2.0 for name in ("s3-j7-a", "s9-j7-a")}
    )


@pytest.fixture(scope="module")
def suite():
    return suite_named("scaling")


def test_a_coco_archive_names_its_runs_and_holds_every_improvement(suite, field, tmp_path):
    info, _ = export(suite, field, Platform.COCO, tmp_path)
    head, about, runs = info.read_text().splitlines()
    assert head.startswith(
        "suite = 'time-optimal-study-scaling', funcId = 1, DIM = 3, Precision = 1.000e-08, algId = 'pso-1000'"
    )
    assert about.startswith("% scaling:s3-j7-a, suite checksum ")
    assert runs == "data_f1/bbobexp_f1_DIM3.dat, 1:1000|1.0e-02, 2:1000|1.0e+01"
    text = (info.parent / "data_f1" / "bbobexp_f1_DIM3.dat").read_text()
    assert text == (info.parent / "data_f1" / "bbobexp_f1_DIM3.tdat").read_text()
    first, second = text.split("% f evaluations")[1:]
    rows = [[float(word) for word in line.split()] for line in first.splitlines()[1:]]
    assert [row[:3] for row in rows] == [
        [1, 0, FAILED],
        [50, 0, pytest.approx(0.2625)],
        [400, 0, pytest.approx(0.01)],
        [1000, 0, pytest.approx(0.01)],
    ]
    assert [line.split()[0] for line in second.splitlines()[1:]] == ["1", "1000"]


def test_ioh_files_are_one_function_for_each_problem(suite, field, tmp_path):
    documents = [json.loads(path.read_text()) for path in export(suite, field, Platform.IOH, tmp_path)]
    assert [one["function_name"] for one in documents] == ["s3-j7-a", "s9-j7-a"]
    first = documents[0]["scenarios"][0]
    assert first["dimension"] == 3
    assert first["runs"][0]["best"] == {"evals": 400, "y": 2.02, "x": []}
    assert documents[1]["scenarios"][0]["runs"][0]["best"]["evals"] == 1000


def test_iohinspector_reads_the_runs(suite, field, tmp_path):
    iohinspector = pytest.importorskip("iohinspector")
    export(suite, field, Platform.IOH, tmp_path)
    manager = iohinspector.DataManager()
    manager.add_folder(str(tmp_path))
    assert sorted(manager.overview["function_name"].to_list()) == ["s3-j7-a", "s3-j7-a", "s9-j7-a"]
    rows = manager.select(function_ids=[1]).load(monotonic=True, include_meta_data=True)
    assert rows["raw_y"].min() == pytest.approx(2.02)


def test_one_table_holds_all_runs(suite, field, tmp_path):
    (path,) = export(suite, field, Platform.PARQUET, tmp_path / "new")
    assert read_runs(path) == list(field.runs)


def test_what_cannot_be_written_is_told(suite, field, tmp_path):
    with pytest.raises(StudyError, match="no search among the runs"):
        export(suite, Field((EXACT,), field.best), Platform.COCO, tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="cannot be written"):
        export(suite, field, Platform.PARQUET, tmp_path / "file")
    with pytest.raises(StudyError, match="no platform 'csv'"):
        exported("hard", "csv", tmp_path, None)


def test_committed_runs_are_written(tmp_path):
    said = exported("hard", "parquet", tmp_path, None)
    assert said.endswith(f"of suite 'hard' written for parquet: 1 file in {tmp_path}")
    assert {run.problem for run in read_runs(tmp_path / "hard.parquet")} <= suite_named("hard").cases.keys()
