"""Anyone's trajectory as a record: read, slowed where it must be, judged, written and judged again."""

import json

import pytest

from study.cases import records
from study.cases.records import records_of
from study.cases.suites import suite_named
from study.errors import StudyError
from study.io.export import write_motion
from study.planning import RunSettings
from study.registry import method_named
from study.suites.submission import record_text, refuted, submission

NAME = "hard:staircase"


@pytest.fixture(scope="module")
def suite():
    return suite_named("hard")


@pytest.fixture(scope="module")
def motion(suite):
    case = suite.cases[NAME]
    plan = method_named("ruckig-stops").plan(case.problem, RunSettings(curve=case.curve))
    return plan.motion


@pytest.mark.parametrize("ending", [".exact.json", ".csv"])
def test_a_feasible_motion_is_a_record_in_any_format(suite, motion, tmp_path, ending):
    case = suite.cases[NAME]
    given = submission(write_motion(motion, case.problem, tmp_path / f"mine{ending}"), case, "rad")
    assert given.verdict.duration == pytest.approx(motion.duration, rel=1e-3)
    if given.verdict.feasible:
        path = tmp_path / "record.exact.json"
        path.write_text(record_text(given, suite, "me"))
        assert refuted(path, suite.cases) == ""


def test_a_motion_that_is_too_fast_is_slowed_by_the_least_factor(suite, motion, tmp_path):
    case = suite.cases[NAME]
    given = submission(write_motion(motion.scaled(0.8), case.problem, tmp_path / "fast.exact.json"), case)
    assert given.stretch == pytest.approx(1.25, rel=1e-5)
    assert given.verdict.feasible


def test_what_misses_a_waypoint_is_no_record(suite, motion, tmp_path):
    other = suite.cases["hard:u-turns"]
    given = submission(write_motion(motion, suite.cases[NAME].problem, tmp_path / "other.exact.json"), other)
    assert not given.verdict.feasible
    with pytest.raises(StudyError, match="no record"):
        record_text(given, suite, "me")


def test_a_contributed_record_counts_where_it_is_better_and_a_forged_one_is_refuted(
    suite, motion, tmp_path, monkeypatch
):
    case = suite.cases[NAME]
    given = submission(write_motion(motion, case.problem, tmp_path / "mine.exact.json"), case)
    with pytest.raises(StudyError, match="who found"):
        record_text(given, suite, " ")
    folder = tmp_path / "records" / "hard"
    folder.mkdir(parents=True)
    path = folder / "mine.exact.json"
    path.write_text(record_text(given, suite, "me"))
    monkeypatch.setattr(records, "suites_folder", lambda: tmp_path)
    assert next(iter(records_of(suite)[NAME].best.values())).by == "me"
    content = json.loads(path.read_text())
    content["record"]["duration"] /= 2
    path.write_text(json.dumps(content))
    assert "its motion takes" in refuted(path, suite.cases)


def test_all_contributed_records_hold_under_the_judge():
    for name in ("hard", "robots", "scaling", "scaling-second"):
        suite = suite_named(name)
        for path in records.records_file(suite).with_suffix("").glob("*.exact.json"):
            assert refuted(path, suite.cases) == "", path.name


def test_the_command_judges_and_writes(study_command, suite, motion, tmp_path):
    file = write_motion(motion, suite.cases[NAME].problem, tmp_path / "mine.exact.json")
    out = tmp_path / "record.exact.json"
    ended = study_command("suite", "submit", file, "--problem", NAME, "--by", "me", "--out", out)
    assert ended.returncode == 0, ended.stderr
    assert out.is_file()
    assert study_command("suite", "submit", file, "--problem", "hard:u-turns", "--by", "me").returncode == 3
    assert study_command("suite", "submit", file, "--problem", "nope", "--by", "me").returncode == 2
