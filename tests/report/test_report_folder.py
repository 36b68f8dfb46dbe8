"""One folder holds everything: cases of papers and of one's own, suites and other commands' pages, none of them lost."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from study.analysis.case_summary import CaseSummary, summarise_case
from study.cases.library import Case, load_case
from study.cases.obstacles import UNFOLLOWED
from study.cases.suites import suite_named
from study.cli.folder import last_run
from study.comparison.ablations import AblationFinding, matrix
from study.comparison.statistics import Interval
from study.curves import CURVES
from study.report import live
from study.report.bars import ladder
from study.report.case_page import RUNGS
from study.report.index_page import BESIDE
from study.report.page import build_report
from study.report.plot_style import Bar, Notes, Series, themed
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.remembered import remember_lineup, remembered_lineup
from study.store.store import Store

MOST_BYTES = 2_000_000


@pytest.fixture(scope="module")
def wood() -> CaseSummary:
    case = load_case("woodworking")
    cells = make_cells([case], [Spec(name) for name in ("golds-pso", "ruckig-stops", "toppra")], Budget(1, 100))
    return summarise_case(case, [CellJob(cell, case.problem).run() for cell in cells])


def own(wood: CaseSummary, name: str) -> CaseSummary:
    """The same as a case of one's own."""
    case = replace(wood.case, name=name, paper="own", published=(), notes=())
    results = [
        replace(run, cell=replace(run.cell, case=name)) for m in wood.methods for run in m.results if m.joint is None
    ]
    return summarise_case(case, [run for run in results if run.cell.planner != "published"])


def test_a_run_keeps_the_cases_of_earlier_runs(tiny_case: Case, tmp_path: Path) -> None:
    cases = {name: replace(tiny_case, name=name) for name in "ab"}
    first, second = (make_cells([cases[name]], [Spec("centre")], Budget()) for name in "ab")
    again = make_cells([cases["a"]], [Spec("direct")], Budget())
    with Store(tmp_path / "results.sqlite") as store:
        remember_lineup(store, first, {"a": "a.yaml"})
        remember_lineup(store, second, {"b": "b.yaml"})
        remember_lineup(store, again, {"a": "elsewhere.yaml"})
    cells, sources = remembered_lineup(tmp_path / "results.sqlite")
    assert sorted((cell.case, cell.label) for cell in cells) == [("a", "direct"), ("b", "centre")]
    assert sources == {"a": "elsewhere.yaml", "b": "b.yaml"}


def test_problems_of_a_suite_and_cases_are_kept_apart(tmp_path: Path) -> None:
    wood, problem = load_case("woodworking"), next(iter(suite_named("hard").cases.values()))
    cells = make_cells([wood, problem], [Spec("centre")], Budget())
    with Store(tmp_path / "results.sqlite") as store:
        remember_lineup(store, cells, {case.name: case.name for case in (wood, problem)})
    assert list(last_run(tmp_path)[0]) == ["woodworking"]
    assert list(last_run(tmp_path, "hard")[0]) == [problem.name]


def test_the_index_leads_to_all_that_lies_beside_it_and_leaves_other_pages_alone(
    wood: CaseSummary, tmp_path: Path
) -> None:
    mine = own(wood, "mine")
    build_report([wood], tmp_path, {})
    assert (tmp_path / "woodworking.html").stat().st_size < MOST_BYTES
    assert sorted(path.name for path in (tmp_path / "assets").iterdir()) == ["report.js", "uplot.js"]
    assert "The MIT License" in (tmp_path / "assets" / "uplot.js").read_text(encoding="utf-8")
    own_paper = "reproduction/woodworking-golds-pso.html"
    for path in (*BESIDE, "older.html", own_paper):
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text("<html>")
    (tmp_path / "woodworking.html").write_text("as it was")
    build_report([wood, mine], tmp_path, {}, only=["mine"])
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    for path in (*BESIDE, "older.html", own_paper, "woodworking.html", "mine.html"):
        assert f'href="{path}"' in text, path
    assert (tmp_path / "woodworking.html").read_text() == "as it was"
    assert 'href="index.html"' in (tmp_path / "mine.html").read_text(encoding="utf-8")
    assert text.index("<h1>Do metaheuristic time-optimal planners") < text.index('<h2 id="own">Cases of one\'s own')


def test_an_own_page_is_about_the_motion(wood: CaseSummary, tmp_path: Path) -> None:
    mine = own(wood, "mine")
    (tmp_path / "trajectories").mkdir()
    (tmp_path / "trajectories" / "mine.yaml").write_text("")
    index = build_report([mine], tmp_path / "report", {}, sources={"mine": "mine.yaml"})
    text = (index.parent / "mine.html").read_text(encoding="utf-8")
    assert mine.winner is not None
    assert mine.winner.duration is not None
    for words in (
        "<h1>mine</h1>",
        f"<strong>{mine.winner.duration:.4f} s</strong>",
        "may be driven",
        "../trajectories/mine.yaml",
    ):
        assert words in text, words
    assert "trajectories/mine.csv" not in text  # it is not there
    assert "The best metaheuristic that ran, <code>golds-pso</code>, takes" in text
    for page in (text, index.read_text(encoding="utf-8")):
        assert "Do metaheuristic" not in page
        assert (
            "paper"
            not in re.sub(r"<style>.*?</style>|<svg.*?</svg>", "", page, flags=re.DOTALL)
            .split("<main")[1]
            .split("<h2")[0]
        )


def test_a_motion_that_no_arm_can_follow_is_called_so(wood: CaseSummary, tmp_path: Path) -> None:
    mine = own(wood, "mine")
    assert mine.winner is not None
    mine.__dict__["driving"] = {mine.winner.label: UNFOLLOWED}
    index = build_report([mine], tmp_path, {})
    assert f'<strong class="bad">{UNFOLLOWED}</strong>' in (tmp_path / "mine.html").read_text(encoding="utf-8")
    assert UNFOLLOWED in index.read_text(encoding="utf-8")


def test_where_nothing_may_be_driven_the_page_says_so(wood: CaseSummary, tmp_path: Path) -> None:
    mine = own(wood, "mine")
    bad = [replace(mine.methods[0].results[0], motion=None, verdict=None, message="nothing found")]
    build_report([summarise_case(mine.case, bad)], tmp_path, {})
    assert "No motion that may be driven was found." in (tmp_path / "mine.html").read_text(encoding="utf-8")


def test_the_ladder_goes_down_group_by_group(wood: CaseSummary) -> None:
    groups = [[rung.seconds for rung in wood.rungs if belongs(rung)] for belongs in RUNGS.values()]
    assert sum(map(len, groups)) == len(wood.rungs)
    drawn = ladder("l", [("", [Bar("a", "2 s", 2.0, "", True, 3, "why & <how>")])], 400.0)
    assert 'data-tip="a: 2 s\nwhy &amp; &lt;how&gt;"' in drawn


def test_coordinates_are_short_and_notes_are_whole() -> None:
    notes = Notes()
    mark = notes.add("7.476254 s", 3)
    raw = f'<svg viewBox="0 0 9 9"><g id="{mark}"><path d="M 1.234567 -0.001 L 2.5 3"/></g><text x="1.98765">1.234567 s</text></svg>'
    shown = themed(raw, "k", "t", "d", notes)
    assert (
        '<g class="k3" data-tip="7.476254 s"><path d="M 1.23 0 L 2.5 3"/></g><text x="1.99">1.234567 s</text>' in shown
    )


def test_data_of_figures_cannot_leave_their_element(tiny_case: Case) -> None:
    nasty = "</script><b>&"
    problem = replace(tiny_case.problem, joint_names=(nasty, "b"))
    motion = CURVES["poly353"].motion(problem.waypoints, np.full(problem.n_segments, 0.5))
    text = str(live.profiles_data(problem, ("rad", "m"), [Series(nasty, 0, motion)], {nasty: nasty}))
    inside = text.removeprefix('<script type="application/json">').removesuffix("</script>")
    assert not set(inside) & set("<>&")
    data = json.loads(inside)
    assert data["views"][0]["name"] == nasty
    assert [panel["short"] for panel in data["views"][1]["panels"]] == ["position", "velocity", "acceleration", "jerk"]
    assert data["views"][0]["panels"][0]["y"][0][0] == pytest.approx(problem.waypoints[0, 0], abs=1e-4)


def test_ablations_at_a_glance() -> None:
    def finding(improvement: str, task: str, a12: float) -> AblationFinding:
        return AblationFinding(
            "woodworking-golds-pso",
            improvement,
            task,
            "as it is",
            True,
            1.0,
            0.9,
            a12,
            Interval(-0.1, -0.2, -0.05),
            0.001,
        )

    table = matrix(
        [finding("golden sine", "a", 0.9), finding("golden sine", "b", 0.1), finding("S curve inertia", "a", 0.5)]
    )
    assert table.head == ["Search", "Improvement", "a", "b"]
    rows = {str(row[1]): [re.sub("<[^>]*>", "", str(cell)) for cell in row[2:]] for row in table.rows}
    assert rows == {"S curve inertia": ["", "·"], "golden sine": ["+", "−"]}
