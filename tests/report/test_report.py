"""The report: whole, honest, self-contained and the same every time."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pyarrow.parquet as pq
import pytest

from study.analysis.case_summary import summarise, summarise_case
from study.analysis.tables import raw
from study.cases.library import Case, load_case
from study.errors import StudyError
from study.problem import JointLimits, Problem
from study.report.case_page import STANDINGS
from study.report.page import build_report
from study.report.rendering import SCRIPTS
from study.report.tables import COLUMNS
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells
from study.store.results import Result

NASTY = "<script>alert('x')</script> & \"q\" $y$ {{ 7*7 }}"
ENVIRONMENT = {"Python": "3.x", "a <b>": NASTY}


class Page(HTMLParser):
    """A page taken apart: elements in order, and whatever does not balance."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.faults: list[str] = []
        self.text: list[str] = []
        self._open: list[str] = []
        self.feed(text)
        self.close()
        self.faults += [f"never closed: {tag}" for tag in self._open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {key: value or "" for key, value in attrs}))
        if tag not in {"meta", "link", "br", "wbr"}:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {key: value or "" for key, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        if not self._open or self._open.pop() != tag:
            self.faults.append(f"unexpected </{tag}> at {self.getpos()}")

    def handle_data(self, data: str) -> None:
        self.text.append(data)

    def having(self, attribute: str) -> list[str]:
        return [attrs[attribute] for _, attrs in self.elements if attribute in attrs]


def _results(case: Case, specs: list[str]) -> list[Result]:
    cells = make_cells([case], [Spec(*name.split(":")) for name in specs], Budget(seeds=2, evaluations=150))
    return [CellJob(cell, case.problem).run() for cell in cells]


@pytest.fixture(scope="module")
def material() -> tuple[dict[str, Case], list[Result]]:
    """A paper's case, and a user's whose every name tries to break out of the page."""
    wood = load_case("woodworking")
    nasty = Problem(
        NASTY,
        wood.problem.waypoints[:, :2],
        _two_joints(wood),
        joint_names=(NASTY, "b&b"),
    )
    mine = replace(
        wood,
        name=NASTY,
        title=NASTY,
        paper=NASTY,
        problem=nasty,
        robot=None,
        units=("m", "m"),
        published=(),
        notes=(NASTY,),
    )
    results = _results(wood, ["golds-pso", "pso:scaled:shared", "centre", "direct", "ruckig-stops", "toppra"])
    results += _results(mine, ["pso", "centre"])
    bad = next(one for one in results if one.cell.label == "centre")
    failed = replace(
        bad, cell=replace(bad.cell, label="broken", planner="broken"), motion=None, verdict=None, message=NASTY
    )
    return {case.name: case for case in (wood, mine)}, [*results, failed]


def _two_joints(case: Case) -> JointLimits:
    limits = case.problem.limits
    return JointLimits(*limits.rates[:, :2], limits.lower[:2], limits.upper[:2])


@pytest.fixture(scope="module")
def report(material: tuple[dict[str, Case], list[Result]], tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("study-output")
    (out / "recordings").mkdir()
    (out / "recordings" / "woodworking.rrd").write_bytes(b"")
    return build_report(summarise(*material), out / "report", ENVIRONMENT).parent


def pages(report: Path) -> Iterator[tuple[str, str, Page]]:
    for path in sorted(report.glob("*.html")):
        text = path.read_text(encoding="utf-8")
        yield path.name, text, Page(text)


def test_one_page_for_every_case_and_an_index(report: Path) -> None:
    names = [name for name, _, _ in pages(report)]
    assert len(names) == 3
    assert {"index.html", "woodworking.html"} <= set(names)


def test_pages_are_well_formed(report: Path) -> None:
    for name, text, page in pages(report):
        assert page.faults == [], name
        ids = page.having("id")
        assert len(ids) == len(set(ids)), name
        assert text.startswith("<!DOCTYPE html>")
        assert ("html", {"lang": "en"}) in page.elements


def test_pages_are_readable_without_eyes(report: Path) -> None:
    for name, text, page in pages(report):
        tags = [tag for tag, _ in page.elements]
        assert tags.count("h1") == 1
        assert tags.count("table") == tags.count("caption"), name
        for tag, attrs in page.elements:
            if tag == "th":
                assert attrs.get("scope") in {"col", "row", "rowgroup"}, (name, attrs)
            if tag == "svg":
                assert attrs.get("role") == "img" or attrs.get("aria-hidden") == "true", name
        known = set(page.having("id"))
        assert {word for words in page.having("aria-labelledby") for word in words.split()} <= known
        assert text.count("<title id=") == sum(attrs.get("role") == "img" for _, attrs in page.elements)


def test_nothing_comes_from_elsewhere(report: Path) -> None:
    for name, text, page in pages(report):
        assert "default-src 'none'" in text
        for tag, attrs in page.elements:
            assert "src" not in attrs or (attrs["src"] in SCRIPTS and (report / attrs["src"]).is_file()), (name, tag)
            target = attrs.get("href", "")
            if re.match(r"[a-z]+:", target):
                assert (tag == "link" and target == "data:,") or target.startswith("https://doi.org/10."), (
                    name,
                    target,
                )
        assert not re.search(r"url\((?!#)|@import|fetch\(|XMLHttpRequest", text), name


def test_links_lead_somewhere(report: Path) -> None:
    for name, _, page in pages(report):
        ids = set(page.having("id"))
        for target in page.having("href") + page.having("xlink:href"):
            if target.startswith("#"):
                assert target[1:] in ids, (name, target)
            elif ":" not in target:
                path, _, place = unquote(target).partition("#")
                assert (report / path).is_file(), (name, target)
                assert not place or f'id="{place}"' in (report / path).read_text(encoding="utf-8"), (name, target)


def test_a_recording_is_linked_only_where_there_is_one(report: Path) -> None:
    linked = {name for name, text, _ in pages(report) if "../recordings/" in text}
    assert linked == {"index.html", "woodworking.html"}


def test_names_of_users_are_text_and_nothing_else(report: Path) -> None:
    for name, text, page in pages(report):
        assert "<script>alert" not in text, name
        scripts = [attrs for tag, attrs in page.elements if tag == "script"]
        assert [attrs["src"] for attrs in scripts if "src" in attrs] == list(SCRIPTS), name
        assert all("src" in attrs or attrs == {"type": "application/json"} for attrs in scripts), name
        assert NASTY in "".join(page.text), name
    assert all(re.fullmatch(r"[A-Za-z0-9_.-]+", path.name) for path in report.rglob("*"))


class ResultsTable(HTMLParser):
    """The results table: for every row its group and its cells' `data-value`s."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[tuple[str, list[str]]] = []
        self._inside, self._group = False, ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {key: value or "" for key, value in attrs}
        if tag == "table":
            self._inside = given.get("id") == "results-table"
        if not self._inside:
            return
        if tag == "tbody":
            self._group = given["class"]
        if tag == "tr" and self._group and given.get("class") != "group":
            self.rows.append((self._group, []))
        if "data-value" in given:
            self.rows[-1][1].append(given["data-value"])


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_the_table_on_the_page_is_the_one_in_the_file(report: Path, kind: str) -> None:
    shown = ResultsTable((report / "woodworking.html").read_text(encoding="utf-8")).rows
    path = report / "tables" / f"woodworking-results.{kind}"
    if kind == "csv":
        records: list[dict[str, Any]] = read_csv(path)
    else:
        records = [{key: raw(value) for key, value in row.items()} for row in pq.read_table(path).to_pylist()]
    stored = [[row[column.key] for column in COLUMNS] for row in records if "joint " not in row["method"]]
    assert len(shown) > 8
    assert [cells for _, cells in shown] == stored


def read_csv(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_infeasible_never_stands_above_feasible(report: Path) -> None:
    keys = [column.key for column in COLUMNS]
    for name, text, _ in pages(report):
        rows = [(group, dict(zip(keys, cells, strict=True))) for group, cells in ResultsTable(text).rows]
        groups = [group for group, _ in rows]
        assert groups == sorted(groups, key=list(STANDINGS).index), name
        for group, row in rows:
            assert (not row["feasible"].startswith("0/")) == (group == "feasible"), row
            assert bool(row["rank"]) == (group == "feasible"), row
        medians = [float(row["median_s"]) for group, row in rows if group == "feasible"]
        assert medians == sorted(medians)


def test_what_failed_is_shown_with_its_reason(report: Path) -> None:
    rows = ResultsTable((report / "woodworking.html").read_text(encoding="utf-8")).rows
    assert "infeasible" in {group for group, cells in rows if "broken" in cells}
    assert "alert(&#39;x&#39;)" in (report / "woodworking.html").read_text(encoding="utf-8")


def test_single_joints_are_judged_but_not_ranked(report: Path) -> None:
    text = (report / "woodworking.html").read_text(encoding="utf-8")
    assert "acceleration of joint 1 reaches 1.07" in text
    assert not any("joint 1" in cell for _, cells in ResultsTable(text).rows for cell in cells)


def test_commands_run_the_rows_again(report: Path) -> None:
    commands = {row["method"]: row["command"] for row in read_csv(report / "tables" / "woodworking-results.csv")}
    run = "study run --cases woodworking --planners"
    assert commands["golds-pso"] == f"{run} golds-pso --seeds 2 --evaluations 150 --out again"
    assert commands["direct"] == f"{run} direct --evaluations 150 --out again"
    assert commands["toppra"] == f"{run} toppra --out again"
    assert commands["published: GoldS-PSO"] == f"{run} centre --out again"


def test_a_command_says_where_an_own_case_is_and_how_long_its_planners_had(tiny_case: Case, tmp_path: Path) -> None:
    (cell,) = make_cells([tiny_case], [Spec("centre")], Budget(time_limit=7.0))
    result = CellJob(cell, tiny_case.problem).run()
    build_report([summarise_case(tiny_case, [result])], tmp_path, {}, sources={tiny_case.name: "my cases/tiny.yaml"})
    shown = {row["method"]: row["command"] for row in read_csv(tmp_path / "tables" / "tiny-results.csv")}
    assert shown["centre"] == "study run --cases 'my cases/tiny.yaml' --planners centre --time-limit 7 --out again"


def test_an_own_case_is_not_said_to_have_a_paper(
    material: tuple[dict[str, Case], list[Result]], tmp_path: Path
) -> None:
    case = replace(material[0]["woodworking"], paper="own", published=(), notes=(), title="Mine")
    build_report([summarise_case(case, material[1])], tmp_path, {})
    text = (tmp_path / "woodworking.html").read_text(encoding="utf-8")
    assert "The best metaheuristic that ran" in text
    for words in ("paper's curve", "Curve of the paper", "The paper", "the paper's own", "Reproduced"):
        assert words not in text, words


def test_every_run_stands_in_a_table(report: Path, material: tuple[dict[str, Case], list[Result]]) -> None:
    _, results = material
    runs = pq.read_table(report / "tables" / "all-runs.parquet").to_pylist()
    assert len(runs) == len(results)
    expected = sorted(one.verdict.duration for one in results if one.verdict)
    assert sorted(run["duration_s"] for run in runs if run["duration_s"] is not None) == expected


def test_the_same_results_give_the_same_bytes(
    report: Path, material: tuple[dict[str, Case], list[Result]], tmp_path: Path
) -> None:
    (tmp_path / "recordings").mkdir()
    (tmp_path / "recordings" / "woodworking.rrd").write_bytes(b"")
    again = build_report(summarise(*material), tmp_path / "report", ENVIRONMENT).parent
    first = {path.relative_to(report): path.read_bytes() for path in report.rglob("*") if path.is_file()}
    second = {path.relative_to(again): path.read_bytes() for path in again.rglob("*") if path.is_file()}
    assert first == second


def test_without_results_there_is_still_a_page(tiny_case: Case, tmp_path: Path) -> None:
    index = build_report([summarise_case(tiny_case, [])], tmp_path / "report", {})
    assert "no results yet" in index.read_text(encoding="utf-8")
    assert "nothing to judge" in (index.parent / "tiny.html").read_text(encoding="utf-8")


def test_cases_with_like_names_get_pages_of_their_own(tiny_case: Case, tmp_path: Path) -> None:
    cases = {name: replace(tiny_case, name=name, published=()) for name in ("a/b", "a b", "index", "../x")}
    out = build_report(summarise(cases, []), tmp_path / "report", {}).parent
    assert len(list(out.glob("*.html"))) == len(cases) + 1


def test_a_folder_that_cannot_be_written_is_one_sentence(tiny_case: Case, tmp_path: Path) -> None:
    (tmp_path / "report").write_text("a file stands here")
    with pytest.raises(StudyError, match=r"the report cannot be written to .*; choose another folder"):
        build_report([summarise_case(tiny_case, [])], tmp_path / "report", {})


def test_flagged_searches_are_marked_in_every_table(
    material: tuple[dict[str, Case], list[Result]], tmp_path: Path
) -> None:
    cases, results = material
    cell = next(result.cell for result in results if result.motion is not None)
    build_report([summarise_case(cases[cell.case], results)], tmp_path, {}, {cell.planner: "moves with the <optimum>"})
    (page,) = (path.read_text() for path in tmp_path.glob("*.html") if path.stem != "index")
    assert 'title="moves with the &lt;optimum&gt;">⚑' in page
    assert "The audit of <code>study compare</code>" in page
