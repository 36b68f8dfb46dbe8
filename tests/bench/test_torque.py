"""Torques along the papers' motions: rows, sentences, the page and its figure."""

import re
from pathlib import Path

import numpy as np
import pytest

from study.bench import torque
from study.bench.torque import CASES, HEAD, Loaded, loaded, sentences, write_page
from study.bench.torque_peers import torque_peers
from study.cases.library import load_case
from study.cli.bench import bench
from study.errors import StudyError
from study.trajectory import Trajectory

PAGE = Path(__file__).parents[2] / "docs" / "pages"


@pytest.fixture
def papers_alone(monkeypatch):
    monkeypatch.setattr(torque, "PLANNERS", ())
    return list(loaded(lambda part: None))


def test_the_papers_motions_are_there_with_their_torques(papers_alone):
    found = {(row.case, row.label): row for row in papers_alone}
    start = found["puma560-torque", "paper: before optimisation"]
    assert start.duration == pytest.approx(3.0)
    assert 0.2 < start.share < 0.24
    assert not start.steps
    assert found["ur5-bspline-torque", "paper: SMWOA"].steps, "the paper's curve starts in motion"


def test_the_page_in_the_docs_says_what_the_command_finds(papers_alone, tmp_path):
    paths = write_page(papers_alone, tmp_path)
    assert [path.name for path in paths] == ["torque.md", "torque.svg"]
    page, here = (PAGE / "torque.md").read_text(), paths[0].read_text()
    rows = [line for line in here.splitlines() if line.startswith("|")]
    assert len(rows) == 2 + len(papers_alone)
    assert all(row in page for row in rows), "run `study bench --part torque --page docs/pages` again"
    assert (PAGE / "torque.svg").read_text().startswith("<svg")
    assert len(re.findall("<path", paths[1].read_text())) > len(papers_alone)


def test_the_sentences_say_what_torques_cost():
    motion = Trajectory([0.0, 1.0], np.zeros((1, 2, 6)), [0.0, 1.0])
    rows = [
        Loaded(CASES[0], "free-path", motion, False, 2.0, "joint 1", True),
        Loaded(CASES[0], "free-path", motion.scaled(1.5), True, 1.0, "joint 1", False),
    ]
    said = list(sentences(rows))
    assert said[0].endswith("limits of torque cost 50.0% of the time, where without them the velocity steps.")
    assert said[-1].startswith("No masses are published of the arms of")
    assert len(HEAD) == 6


@pytest.mark.parametrize("name", CASES)
def test_the_cases_with_torques_differ_from_their_papers_by_the_torques(name):
    case = load_case(name)
    assert not case.default
    assert np.isfinite(case.problem.arm.torque).all()
    assert not case.problem.arm.mechanism.coulomb.any()
    assert case.sources["torque limits"].startswith("ours")
    np.testing.assert_array_equal(case.problem.waypoints, load_case(case.variant_of).problem.waypoints)


def test_only_that_part_has_a_page():
    with pytest.raises(StudyError, match="only the part 'torque' has a page"):
        bench(part="arms", page=Path("somewhere"))


@pytest.mark.slow
def test_other_packages_find_the_same_times_under_torques():
    part = torque_peers(0, lambda part: None)
    for name in {row[0] for row in part.rows}:
        times = {row[1]: float(row[2]) for row in part.rows if row[0] == name and row[1] != "free-path (ours)"}
        ours = times.pop("toppra (ours)")
        assert "toppra's package" in times
        assert list(times.values()) == pytest.approx([ours] * len(times), rel=0.005)
