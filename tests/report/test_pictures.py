"""Pictures for the README: from stored results, files of their own, small."""

from __future__ import annotations

import re
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from study import recording
from study.analysis.case_summary import summarise_case
from study.cases.ledger import data_folder
from study.cases.library import load_case
from study.errors import StudyError
from study.report.pictures import pictures_of, standalone, write_pictures
from study.report.readme import answer_in_markdown, put
from study.runs.execute import CellJob
from study.runs.lineup import Budget, make_cells, parse_specs
from tests.helpers.viewer import can_draw

LARGEST = 300_000
Command = Callable[..., subprocess.CompletedProcess[str]]
pytestmark = pytest.mark.usefixtures("threads")


@can_draw
@pytest.mark.timeout(180)
def test_pictures_come_from_the_store_and_are_small(study_command: Command, case_file: Path, tmp_path: Path) -> None:
    arguments = ["--cases", case_file, "--planners", "pso:scaled,casadi-nlp,ruckig-via", "--seeds", 2, "--jobs", 1]
    ran = study_command("run", *arguments, "--evaluations", 200, "--no-report", "--out", tmp_path / "o")
    assert ran.returncode == 0, ran.stderr
    drawn = study_command("pictures", tmp_path / "p", "--case", "mini", "--joint", 2, "--out", tmp_path / "o")
    assert drawn.returncode == 0, drawn.stderr
    names = ["mini-ladder.svg", "mini-profile.svg", "mini-viewer.png"]
    assert sorted(path.name for path in (tmp_path / "p").iterdir()) == names
    assert drawn.stdout.split() == [str(tmp_path / "p" / name) for name in names]
    for name in names[:2]:
        text = (tmp_path / "p" / name).read_text(encoding="utf-8")
        ET.fromstring(text)
        assert "var(" not in text  # a file of its own has no style sheet
        assert not re.search(r'href="(?!#)', text)
        assert len(text.encode()) < LARGEST
    assert "joint 2" in (tmp_path / "p" / "mini-profile.svg").read_text(encoding="utf-8")
    assert "casadi-nlp" in (tmp_path / "p" / "mini-ladder.svg").read_text(encoding="utf-8")
    png = (tmp_path / "p" / "mini-viewer.png").read_bytes()
    assert len(png) < LARGEST
    assert Image.open(BytesIO(png)).width == 1400


def test_where_the_viewer_cannot_draw_nothing_is_written(
    study_command: Command, case_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> bytes:
        raise StudyError("no viewer here")

    monkeypatch.setattr(recording, "picture", refuse)
    arguments = ["--cases", case_file, "--planners", "centre,direct,ruckig-stops", "--jobs", 1, "--evaluations", 50]
    assert study_command("run", *arguments, "--no-report", "--out", tmp_path / "o").returncode == 0
    refused = study_command("pictures", tmp_path / "p", "--case", "mini", "--out", tmp_path / "o")
    assert (refused.returncode, refused.stderr) == (2, "study: no viewer here\n")
    assert not (tmp_path / "p").exists()


def test_mistakes_are_one_sentence(study_command: Command, case_file: Path, tmp_path: Path) -> None:
    arguments = ["--cases", case_file, "--planners", "centre", "--jobs", 1, "--no-report"]
    assert study_command("run", *arguments, "--out", tmp_path / "o").returncode == 0
    for options, sentence in (
        (["--case", "woodworking"], "was not of case 'woodworking'; it was of mini"),
        (["--case", "mini", "--joint", 3], "case 'mini' has 2 joints, got joint 3"),
    ):
        ended = study_command("pictures", tmp_path / "p", *options, "--out", tmp_path / "o")
        assert ended.returncode == 2
        assert sentence in ended.stderr
        assert ended.stderr.count("\n") == 1


def test_names_are_escaped_and_the_ground_is_light() -> None:
    figure = '<svg viewBox="0 0 100 50" style="max-width:125px"><path fill="var(--s1)"/></svg>'
    text = standalone(figure, "a < b", [(0, "<b>")])
    root = ET.fromstring(text)
    assert root.get("viewBox") == "0 0 100 102.0"
    assert [one.text for one in root.iter("{http://www.w3.org/2000/svg}text")] == ["a < b", "<b>"]
    assert "var(" not in text
    assert 'fill="#ffffff"' in text


def test_a_picture_is_as_wide_as_its_legend() -> None:
    figure = '<svg viewBox="0 0 100 50" style="max-width:125px"></svg>'
    width = float(ET.fromstring(standalone(figure, "a", [(0, "n" * 40)])).get("width") or 0)
    assert width > 62 + 40 * 6


def test_the_pictures_of_the_readme_are_there() -> None:
    top = data_folder().parent
    if not (top / "README.md").is_file():
        pytest.skip("this is not a checkout")
    shown = re.findall(r'(?:src="|\]\()(docs/pictures/[^")]+)', (top / "README.md").read_text(encoding="utf-8"))
    assert len(shown) == 4
    largest = {".gif": 2_000_000}
    assert all(0 < (top / name).stat().st_size < largest.get(name[-4:], LARGEST) for name in shown)


def test_too_few_results_and_a_folder_that_cannot_be_written_are_one_sentence(tmp_path: Path) -> None:
    case = load_case("woodworking")

    with pytest.raises(StudyError, match="too few results for pictures"):
        pictures_of(summarise_case(case, []), 0)
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="cannot write"):
        write_pictures(tmp_path / "file" / "p", "a", {"x.svg": b""})


def test_the_answer_goes_between_the_marks_and_says_what_the_judge_says(tmp_path: Path) -> None:
    case = load_case("woodworking")
    specs = parse_specs("random-search:scaled,shared,casadi-nlp:scaled,shared,ruckig-stops")
    results = [CellJob(cell, case.problem).run() for cell in make_cells([case], specs, Budget(1, 100, 20.0))]
    text = answer_in_markdown([summarise_case(case, results)])
    tables = [line for line in text.splitlines() if line.startswith("|")]
    assert len({line.count("|") for line in tables[:3]}) == len({line.count("|") for line in tables[3:]}) == 1
    on_curve, off_curve = tables[2], tables[5]
    assert "| 7.4756 s `casadi-nlp`<br>" in on_curve  # the shared optimum of the paper's own curve, and its wall time
    assert "| 4.0756 s `ruckig-stops` (−45.5 %) |" in off_curve
    assert "random-search" not in on_curve  # no metaheuristic
    readme = tmp_path / "README.md"
    readme.write_text("before\n<!-- answer -->\nold\n<!-- /answer -->\nafter\n", encoding="utf-8")
    for _ in range(2):  # the second time changes nothing
        put(readme, text)
        assert readme.read_text(encoding="utf-8") == f"before\n<!-- answer -->\n{text}\n<!-- /answer -->\nafter\n"


@pytest.mark.parametrize("text", ["no marks", "<!-- /answer --><!-- answer -->", "<!-- answer -->"])
def test_a_file_without_the_marks_is_left_alone(text: str, tmp_path: Path) -> None:
    readme = tmp_path / "README.md"
    readme.write_text(text, encoding="utf-8")
    with pytest.raises(StudyError, match="needs the marks"):
        put(readme, "new")
    assert readme.read_text(encoding="utf-8") == text
