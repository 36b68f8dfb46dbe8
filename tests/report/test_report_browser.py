"""The pages in a real browser: figures answer to the pointer, tables sort and filter, and everybody can read them."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import url2pathname

import pytest

from study.analysis.case_summary import summarise
from study.bench.page import write_page
from study.cases.library import load_case
from study.cases.records import records_of
from study.cases.suites import suite_named
from study.cli.example import EXAMPLE
from study.comparison.build import compare
from study.comparison.pages import write_pages
from study.report.case_page import STANDINGS
from study.report.page import build_report
from study.report.rendering import SCRIPTS
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.runner import run_jobs
from study.store.store import Store
from study.suites.law import committed_field
from study.suites.measures import Field, scores
from study.suites.page import write_page as write_suite
from tests.helpers.comparisons import TINY
from tests.helpers.threads import no_processes

playwright = pytest.importorskip("playwright.sync_api", reason="the extra `browser` is not installed")
axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="the extra `browser` is not installed")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no chromium is installed")]

ROOT = Path(__file__).parents[2]
PAGES = [
    "index.html", "woodworking.html", "mine.html", "comparison/index.html", "comparison/targets.html",
    "comparison/ablations.html", "performance.html", "suite/index.html",
]  # fmt: skip
MOST_BYTES = 2_000_000
Open = Callable[..., Any]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the papers' cases, a case of one's own, a comparison and a bench."""
    out = tmp_path_factory.mktemp("out")
    (out / "mine.yaml").write_text(EXAMPLE.replace("NAME", '"mine"'))
    wood, puma, mine = load_case("woodworking"), load_case("puma560"), load_case(str(out / "mine.yaml"))
    names = [
        "pso",
        "random-search",
        "golds-pso:scaled:shared",
        "gold-sa",
        "smwoa",
        "de",
        "centre",
        "ruckig-stops",
        "toppra",
    ]
    cells = make_cells([wood], [Spec(*name.split(":")) for name in names], Budget(seeds=2, evaluations=120))
    cells += make_cells([puma], [Spec("pso", "scaled", "shared"), Spec("centre")], Budget(seeds=1, evaluations=60))
    cells += make_cells(
        [mine],
        [*map(Spec, ("free-path", "ruckig-stops", "casadi-nlp", "golds-pso", "toppra"))],
        Budget(seeds=2, evaluations=200),
    )
    cases = {case.name: case for case in (wood, puma, mine)}
    results = [CellJob(cell, cases[cell.case].problem).run() for cell in cells]
    with Store(out / "results.sqlite") as store, pytest.MonkeyPatch.context() as patch:
        no_processes(patch)
        found = compare({wood.name: wood}, TINY, store, lambda part, jobs: run_jobs(jobs, store, workers=1))
    write_pages(found, out / "report" / "comparison", {"Python": "3.x"})
    write_page(ROOT / "docs" / "bench.json", out / "report")
    suite = suite_named("robots")
    write_suite(suite, committed_field(suite), records_of(suite), [], out / "report" / "suite", {"Python": "3.x"})
    sources = {"mine": str(out / "mine.yaml")}
    return build_report(summarise(cases, results), out / "report", {"Python": "3.x"}, sources=sources).parent


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as driver:
        program = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield program
        program.close()


@pytest.fixture
def look(browser: Any, report: Path) -> Iterator[Open]:
    """Opens a page of the report; what it complains of and asks for is kept in `faults` and `requests`."""
    contexts = []

    def opened(name: str, width: int = 1280, **options: Any) -> Any:
        contexts.append(browser.new_context(viewport={"width": width, "height": 900}, **options))
        page = contexts[-1].new_page()
        page.faults, page.requests = [], []
        page.on("console", lambda message: page.faults.append(message.text))
        page.on("pageerror", lambda error: page.faults.append(str(error)))
        page.on("request", lambda request: page.requests.append(request.url))
        page.goto((report / name).as_uri())
        return page

    yield opened
    for context in contexts:
        context.close()


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("name", PAGES)
def test_no_complaint_no_request_nothing_sticks_out(look: Open, report: Path, name: str, width: int) -> None:
    page = look(name, width)
    page.wait_for_timeout(100)
    assert page.faults == []
    own = {(report / path).as_uri() for path in (name, *SCRIPTS)}
    assert {url for url in page.requests if not url.startswith("data:")} == own
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    boxes = (
        "[...document.querySelectorAll('main > *')].filter((one) => one.getBoundingClientRect().right > innerWidth + 1)"
    )
    assert page.evaluate(f"{boxes}.map((one) => one.outerHTML.slice(0, 80))") == []


def links(page: Any) -> list[str]:
    return list(page.evaluate("[...document.querySelectorAll('a[href]')].map((one) => one.href)"))


@pytest.mark.parametrize("name", PAGES)
def test_every_link_resolves(look: Open, report: Path, name: str) -> None:
    for link in links(look(name)):
        parts = urlsplit(link)
        if parts.scheme == "https":
            assert parts.netloc == "doi.org"
            continue
        target = Path(url2pathname(parts.path))
        assert target.is_file(), link
        assert not parts.fragment or f'id="{parts.fragment}"' in target.read_text(encoding="utf-8"), link


def test_the_index_leads_to_every_page_and_every_page_back(look: Open, report: Path) -> None:
    index = (report / "index.html").as_uri()
    seen, ahead = set[str](), [index]
    while ahead:
        at = ahead.pop()
        seen.add(at)
        found = {
            link.partition("#")[0]
            for link in links(look(str(Path(url2pathname(urlsplit(at).path)).relative_to(report))))
        }
        assert index in found or at == index
        ahead += [
            link
            for link in found
            if link.endswith(".html") and link.startswith("file:") and link not in seen | set(ahead)
        ]
    assert seen == {path.as_uri() for path in report.rglob("*.html")}


FIGURE = "document.querySelector('figure.is-live').figure"


@pytest.mark.parametrize("name", ["woodworking.html", "mine.html"])
def test_one_cursor_over_position_velocity_acceleration_and_jerk(look: Open, name: str) -> None:
    page = look(name)
    plots = page.locator("figure.is-live").first.locator(".u-over")
    assert plots.count() == 4
    value = page.locator(".readout td").first
    before = value.inner_text()
    plots.nth(1).scroll_into_view_if_needed()
    plots.nth(1).hover(position={"x": 60, "y": 50})
    caption = page.locator(".readout caption").first.inner_text()
    assert caption.startswith("At 0.")
    assert value.inner_text() not in (before, "–")
    places = page.evaluate(f"{FIGURE}.plots.map((plot) => plot.cursor.idx)")
    assert len(set(places)) == 1
    page.locator(".plots").first.press("ArrowRight")
    assert page.evaluate(f"{FIGURE}.plots.map((plot) => plot.cursor.idx)")[0] > places[0]


def test_values_under_the_cursor_are_those_of_the_motion(look: Open, report: Path) -> None:
    page = look("mine.html")
    page.locator("figure.is-live .u-over").first.hover(position={"x": 100, "y": 50})
    index, time = page.evaluate(
        f"[{FIGURE}.plots[0].cursor.idx, {FIGURE}.plots[0].data[0][{FIGURE}.plots[0].cursor.idx]]"
    )
    shown = page.locator(".readout td").first.inner_text().replace("−", "-")
    assert index > 0
    rows = (report / "tables" / "mine" / "free-path.csv").read_text().splitlines()
    samples = [[float(text) for text in row.split(",")[:2]] for row in rows if row[:1].isdigit()]
    near = min(samples, key=lambda sample: abs(sample[0] - time))
    assert float(shown) == pytest.approx(near[1], abs=0.05)


def test_methods_are_switched_on_and_off(look: Open) -> None:
    page = look("woodworking.html")
    button = page.locator(".readout button").nth(1)
    shown = f"{FIGURE}.plots.map((plot) => plot.series[2].show)"
    assert page.evaluate(shown) == [True] * 4
    button.click()
    assert page.evaluate(shown) == [False] * 4
    assert button.get_attribute("aria-pressed") == "false"
    button.press("Enter")
    assert page.evaluate(shown) == [True] * 4
    page.locator(".tabs button").nth(1).click()
    assert page.evaluate(f"{FIGURE}.view") == 1


def test_a_legend_switches_the_marks_of_a_static_figure(look: Open) -> None:
    page = look("index.html")
    entry = page.locator(".legend [data-k]").first
    marks = page.locator(f".wide svg .k{entry.get_attribute('data-k')}")
    assert marks.count()
    entry.locator("button").click()
    assert set(marks.evaluate_all("(all) => all.map((one) => getComputedStyle(one).display)")) == {"none"}
    entry.locator("button").click()
    assert "none" not in marks.evaluate_all("(all) => all.map((one) => getComputedStyle(one).display)")


def test_marks_say_their_values(look: Open) -> None:
    page = look("woodworking.html")
    page.locator("#ladder ~ figure .wide [data-tip]").first.hover()
    said = page.locator(".bubble").inner_text()
    assert " s" in said
    page.mouse.move(2, 2)
    assert page.locator(".bubble").is_hidden()


def column(page: Any, table: str, head: str) -> tuple[int, list[tuple[str, list[str]]]]:
    heads = [text.strip() for text in page.locator(f"{table} thead th").all_inner_texts()]
    at = heads.index(head)
    script = """([table, at]) => [...document.querySelector(table).tBodies].map((body) => [body.className,
      [...body.rows].filter((row) => !row.classList.contains("group") && !row.hidden).map((row) => row.cells[at].dataset.value ?? row.cells[at].textContent.trim())])"""
    return at, [(name, values) for name, values in page.evaluate(script, [table, at])]


@pytest.mark.parametrize(("head", "numeric"), [("Median, s", True), ("Wall", True), ("Gap", True), ("Method", False)])
def test_sorting_puts_blanks_last_and_never_lifts_an_infeasible_method(look: Open, head: str, numeric: bool) -> None:
    page = look("woodworking.html")
    before = dict(column(page, "#results-table", head)[1])
    at = column(page, "#results-table", head)[0]
    for down in (False, True):
        button = page.locator("#results-table thead th").nth(at).locator("button")
        button.press("Enter")
        groups = column(page, "#results-table", head)[1]
        assert [name for name, _ in groups] == sorted(before, key=list(STANDINGS).index)
        for name, values in groups:
            assert sorted(values) == sorted(before[name])
            keys = [float(value) if numeric else value.lower() for value in values if value]
            assert keys == sorted(keys, reverse=down)
            assert values[len(keys) :] == [""] * (len(values) - len(keys))
        said = page.locator("#results [role=status], .scroll:has(#results-table) + [role=status]").first.inner_text()
        assert said == f"Sorted by {head}, {'descending' if down else 'ascending'}, feasible methods first."


def test_wall_times_of_what_never_ran_are_blank(look: Open) -> None:
    values = [value for _, group in column(look("woodworking.html"), "#results-table", "Wall")[1] for value in group]
    assert "" in values
    assert "0.0" not in values


def test_rows_are_filtered(look: Open) -> None:
    page = look("woodworking.html")
    field = page.locator(".filter:has(+ .scroll #results-table) input")
    rows = page.locator("#results-table tbody tr:not(.group)")
    everything = rows.count()
    field.fill("PSO shared")
    shown = [row for row in rows.all() if row.is_visible()]
    assert 0 < len(shown) < everything
    assert all("pso" in row.inner_text().lower() for row in shown)
    assert page.get_by_text(f"{len(shown)} of {everything} rows shown.").count() == 1
    field.fill("")
    assert all(row.is_visible() for row in rows.all())


@pytest.mark.parametrize("width", [1280, 390])
def test_the_head_of_a_long_table_stays_in_sight(look: Open, width: int) -> None:
    page = look("woodworking.html", width)
    page.locator("#results-table tbody tr").last.scroll_into_view_if_needed()
    head, place = (
        page.locator(one).bounding_box() for one in ("#results-table thead th.method", ".scroll:has(#results-table)")
    )
    top = 0 if width == 1280 else place["y"]  # of the window, or of the part that scrolls where the table is too wide
    assert head["y"] == pytest.approx(top, abs=1)
    assert place["height"] < 900 or width == 1280


def test_dark_and_light_have_their_own_colours(look: Open) -> None:
    grounds, strokes = [], []
    for scheme in ("light", "dark"):
        page = look("woodworking.html", color_scheme=scheme)
        grounds.append(page.evaluate("getComputedStyle(document.body).backgroundColor"))
        strokes.append(page.evaluate(f"{FIGURE}.plots[0].series[1].stroke({FIGURE}.plots[0], 1)"))
    page.emulate_media(color_scheme="light")
    page.wait_for_timeout(200)
    strokes.append(page.evaluate(f"{FIGURE}.plots[0].series[1].stroke({FIGURE}.plots[0], 1)"))
    assert grounds == ["rgb(255, 255, 255)", "rgb(20, 23, 27)"]
    assert strokes[0] == strokes[2] != strokes[1]


@pytest.mark.parametrize("name", ["index.html", "woodworking.html", "mine.html"])
def test_paper_shows_the_static_figures_and_no_controls(look: Open, name: str) -> None:
    page = look(name, color_scheme="dark")
    page.emulate_media(media="print")
    assert not page.locator(".live:visible, .filter:visible").count()
    assert page.locator("svg[role=img]:visible").count()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert len(page.pdf()) > 20_000


@pytest.mark.parametrize("name", ["index.html", "woodworking.html", "mine.html", "comparison/targets.html"])
def test_without_scripts_everything_is_there(look: Open, name: str) -> None:
    page = look(name, java_script_enabled=False)
    assert page.locator("svg[role=img]:visible").count()
    assert page.locator("tbody tr:visible").count()
    assert not page.locator("button, input, .live").count()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", PAGES)
def test_nothing_keeps_anybody_out(look: Open, name: str, scheme: str) -> None:
    """No fault that axe-core calls serious or critical, with everything unfolded."""
    page = look(name, color_scheme=scheme)
    page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    found = axe.Axe().run(page).response["violations"]
    serious = [(one["id"], one["nodes"][0]["html"][:200]) for one in found if one["impact"] in ("serious", "critical")]
    assert serious == []


def test_case_pages_are_small(report: Path) -> None:
    assert max(path.stat().st_size for path in report.rglob("*.html")) < MOST_BYTES


def test_scores_and_problems_of_a_suite_follow_what_is_chosen(look: Open) -> None:
    suite = suite_named("robots")
    field = committed_field(suite)
    chosen = [run for run in field.runs if suite.problems[run.problem].robot == "fr3" and run.segments <= 19]
    page = look("suite/index.html")
    bar, table = page.locator("script.sums + .filter"), page.locator("script.sums ~ .scroll > table").first
    whole = table.inner_text()
    bar.get_by_label("Robot").select_option("fr3")
    bar.get_by_label("Segments").select_option("19")
    wanted = {score.method: score for score in scores(Field(tuple(chosen), field.best))}
    for row in table.locator("tbody tr").all():
        name, _, feasible, gap, own, *near = (cell.inner_text() for cell in row.locator("th, td").all())
        score = wanted[name]
        assert feasible == f"{score.feasible}/{score.runs}"
        for text, value in zip((gap, own, *near[:3]), (score.gap_any, score.gap_own, *score.within), strict=True):
            assert float(text.rstrip(" %").replace("−", "-")) == pytest.approx(100 * value, abs=0.051)
    for name in ("Robot", "Segments"):
        bar.get_by_label(name).select_option("")
    assert table.inner_text() == whole
    problems = page.locator(".filter:has(+ .scroll th[data-choose])")
    problems.get_by_label("Task").select_option("seam")
    shown = page.locator("table:has(th[data-choose]) tbody tr:not([hidden])")
    assert shown.count() == sum(problem.tags[0] == "seam" for problem in suite.problems.values())
