"""The committed suites: whole, as their generators draw them, honest about limits, and open to new files."""

import json
import shutil

import numpy as np
import pytest
import yaml

from study.cases import suite_file
from study.cases.library import load_case
from study.cases.suite_file import filed_suite, filed_suites, text_of
from study.cases.suites import suite_named, suite_names
from study.datafiles import data_folder
from study.errors import StudyError
from study.robots.arms import arm_named, arm_names
from study.robots.file import ORIGINS
from study.suites import make, robots, scaling
from study.suites.make import RECIPES, differences

ADDED = {
    "name": "my-move",
    "source": "taught by hand",
    "tags": ["move"],
    "task": "a move",
    "units": ["rad"],
    "limits": {"velocity": [1.0], "acceleration": [5.0], "origins": {"velocity": "maker: sheet"}},
    "end": "rest",
    "waypoints": [[0.0], [1.0]],
}


@pytest.fixture
def data(tmp_path, monkeypatch):
    """A copy of the data that a test may add to."""
    for part in ("suites", "robots", "cases"):
        shutil.copytree(data_folder() / part, tmp_path / part)
    monkeypatch.setattr(suite_file, "data_folder", lambda: tmp_path)
    monkeypatch.setattr("study.robots.data_folder", lambda: tmp_path)
    suite_file.filed_suite.cache_clear()
    yield tmp_path
    suite_file.filed_suite.cache_clear()


def test_every_suite_has_what_it_promises():
    assert suite_names() == ["papers", "hard", "robots", "scaling", "scaling-second"]
    assert len(suite_named("papers").cases) == 5
    problems = filed_suite("robots").problems
    assert len(problems) >= 120
    assert len({problem.robot for problem in problems}) == 14
    sizes = {len(problem.waypoints) - 1 for problem in filed_suite("scaling").problems}
    joints = {len(problem.units) for problem in filed_suite("scaling").problems}
    assert (min(sizes), max(sizes), min(joints), max(joints)) == (3, 199, 1, 14)
    assert set(filed_suites()) == set(RECIPES)


@pytest.mark.parametrize("name", sorted(RECIPES))
def test_every_problem_is_a_case_with_source_tags_and_origins(name):
    suite = suite_named(name)
    for key, case in suite.cases.items():
        problem = suite.problems[key]
        assert case.name == key
        assert problem.source
        assert problem.tags
        assert len(case.units) == case.problem.n_joints
        given = {kind for kind in ("velocity", "acceleration", "jerk") if getattr(problem.limits, kind) is not None}
        assert given <= set(problem.limits.origins)
        assert all(text.split(":")[0] in ORIGINS for text in problem.limits.origins.values())
    first = next(iter(suite.cases))
    np.testing.assert_array_equal(load_case(first).problem.waypoints, suite.cases[first].problem.waypoints)


def test_the_committed_numbers_agree_with_the_generators():
    drawn = robots.problems(RECIPES["robots"].seed, ("fr3", "cobra-s600"), ("move", "pick", "boxes", "dense"))
    assert len(drawn) == 8
    assert not differences("robots", drawn)
    for name in ("scaling", "hard"):
        assert not differences(name, RECIPES[name].draw(RECIPES[name].seed))


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(RECIPES))
def test_all_committed_numbers_agree_with_the_generators(name):
    drawn = RECIPES[name].draw(RECIPES[name].seed)
    assert not differences(name, drawn)
    assert [each.name for each in drawn] == [problem.name for problem in filed_suite(name).problems]


def test_another_seed_draws_other_numbers():
    seed = RECIPES["scaling"].seed
    assert len(differences("scaling", scaling.problems(seed + 5))) == len(filed_suite("scaling").problems)


def test_a_suite_is_written_as_it_is_committed():
    for name in filed_suites():
        text = (data_folder() / "suites" / f"{name}.json").read_text()
        assert text_of(filed_suite(name)) == text


def test_who_says_so_is_told_for_every_limit_of_every_arm():
    ours = {name: arm_named(name).origins["acceleration"].startswith("ours") for name in arm_names()}
    assert not any(ours[name] for name in ("fr3", "panda", "xarm6", "xarm7", "gen3"))
    assert all(ours[name] for name in ("ur3e", "ur5e", "ur10e", "iiwa7", "irb120"))
    assert all(arm_named(name).origins["velocity"].split(":")[0] in ("maker", "literature") for name in arm_names())


def test_a_new_problem_is_one_file(data):
    before = suite_named("hard").checksum
    suite_file.filed_suite.cache_clear()
    (data / "suites" / "hard").mkdir()
    (data / "suites" / "hard" / "my-move.yaml").write_text(yaml.safe_dump(ADDED))
    suite = suite_named("hard")
    assert suite.cases["hard:my-move"].problem.n_joints == 1
    assert suite.checksum != before


def test_a_new_arm_is_one_file(data):
    (data / "robots" / "mine.yaml").write_text((data / "robots" / "ur5e.yaml").read_text())
    assert "mine" in arm_names()
    (drawn,) = robots.problems(20, ("mine",), ("pick",))
    assert drawn.robot == "mine"


def test_a_changed_number_and_a_doubled_name_are_noticed(data):
    path = data / "suites" / "hard.json"
    content = json.loads(path.read_text())
    content["problems"][0]["waypoints"][0][0] += 0.1
    path.write_text(json.dumps(content))
    with pytest.raises(StudyError, match="not what its checksum says"):
        suite_named("hard")
    shutil.copy(data_folder() / "suites" / "hard.json", path)
    (data / "suites" / "hard").mkdir()
    (data / "suites" / "hard" / "again.yaml").write_text(yaml.safe_dump(ADDED | {"name": "u-turns"}))
    with pytest.raises(StudyError, match="there twice"):
        suite_named("hard")


@pytest.mark.parametrize(("name", "said"), [("nope:x", "suite"), ("hard:nope", "problem of suite")])
def test_unknown_names_are_told(name, said):
    with pytest.raises(StudyError, match=said):
        load_case(name)
    with pytest.raises(StudyError, match="generator"):
        make.make("papers")
