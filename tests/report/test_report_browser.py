"""The report in a real browser: no complaint, no request, sorting works, nothing sticks out of a narrow window."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

import pytest

from study.analysis.case_summary import summarise
from study.cases.library import load_case
from study.comparison.build import compare
from study.comparison.pages import write_pages
from study.report.case_page import STANDINGS
from study.report.page import build_report
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells
from study.runs.runner import run_jobs
from study.store.store import Store
from tests.helpers.comparisons import TINY
from tests.helpers.threads import no_processes

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no chromium is installed")

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--no-first-run", "--disable-default-apps", "--disable-dev-shm-usage",
)  # fmt: skip

PROBED = "probed-"

LISTEN = """<script>
const faults = [];
addEventListener("error", (event) => faults.push("error: " + event.message));
addEventListener("securitypolicyviolation", (event) => faults.push("policy: " + event.blockedURI));
for (const kind of ["error", "warn"]) console[kind] = (...words) => faults.push(kind + ": " + words.join(" "));
</script>"""

PROBE = """<script>
const table = document.querySelector("#results-table");
const order = (index) => table && [...table.tBodies].map((body) => [body.className,
  [...body.rows].filter((row) => row.className !== "group").map((row) => row.cells[index].dataset.value)]);
const heads = table ? [...table.tHead.rows[0].cells] : [];
const steps = [];
for (const name of ["Median, s", "Median, s", "Method", "Limit use"]) {
  const index = heads.findIndex((head) => head.textContent.trim() === name);
  if (index < 0) continue;
  const button = heads[index].querySelector("button");
  button.focus();
  const focused = document.activeElement === button;
  button.click();
  steps.push({ name, focused, sorted: heads[index].getAttribute("aria-sort"), others:
    heads.filter((head) => ["ascending", "descending"].includes(head.getAttribute("aria-sort"))).length, order: order(index) });
}
const said = document.querySelector("[role=status]");
const spoken = said && said.textContent;
const tables = [...document.querySelectorAll("table:has(th button)")].map((one) => {
  const index = Math.max(0, [...one.tHead.rows[0].cells].findLastIndex((head) => head.matches(".num:has(button)")));
  const head = one.tHead.rows[0].cells[index];
  head.querySelector("button").click();
  const cells = [...one.tBodies[0].rows].map((row) => row.cells[index]);
  return { head: head.textContent, sorted: head.getAttribute("aria-sort"),
    cells: cells.map((cell) => cell.dataset.value ?? cell.textContent.trim()) };
});
const wide = [...document.querySelectorAll("main > *")].filter((one) => one.getBoundingClientRect().right > innerWidth + 1);
const report = { faults, steps, said: spoken, tables, width: innerWidth,
  overflow: document.documentElement.scrollWidth - innerWidth, wide: wide.map((one) => one.tagName),
  requests: performance.getEntriesByType("resource").map((entry) => entry.name),
  links: [...document.querySelectorAll("a[href]")].map((one) => one.href),
  panels: document.querySelectorAll("svg[role=img]").length };
const pre = document.createElement("pre");
pre.id = "probe";
pre.textContent = JSON.stringify(report);
document.body.append(pre);
</script>"""


@dataclass(frozen=True)
class Seen:
    """What the probe in the page saw, and what the browser wrote to its log."""

    probe: dict
    log: str


Look = Callable[[str, int], Seen]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    case = load_case("woodworking")
    specs = [
        Spec("pso"),
        Spec("random-search"),
        Spec("golds-pso", "scaled", "shared"),
        Spec("centre"),
        Spec("ruckig-stops"),
    ]
    cells = make_cells([case], specs, Budget(seeds=2, evaluations=120))
    other = load_case("puma560")
    cases = {one.name: one for one in (case, other)}
    cells += make_cells([other], [Spec("pso", "scaled", "shared"), Spec("centre")], Budget(seeds=1, evaluations=60))
    results = [CellJob(cell, cases[cell.case].problem).run() for cell in cells]
    out = tmp_path_factory.mktemp("out")
    with Store(out / "results.sqlite") as store, pytest.MonkeyPatch.context() as patch:
        no_processes(patch)
        found = compare({case.name: case}, TINY, store, lambda part, jobs: run_jobs(jobs, store, workers=1))
    write_pages(found, out / "report" / "comparison", {"Python": "3.x"})
    return build_report(summarise(cases, results), out / "report", {"Python": "3.x"}).parent


@pytest.fixture(scope="module")
def look(report: Path, tmp_path_factory: pytest.TempPathFactory) -> Look:
    return cache(lambda name, width: _look(report, name, width, tmp_path_factory.mktemp("browser")))


def _look(report: Path, name: str, width: int, tmp_path: Path) -> Seen:
    page = report / name
    text = page.read_text(encoding="utf-8")
    probed = page.with_name(f"{PROBED}{page.name}")
    probed.write_text(
        text.replace("</title>", "</title>" + LISTEN, 1).replace("</body>", PROBE + "</body>"), encoding="utf-8"
    )
    done = subprocess.run(
        [str(CHROMIUM), *FLAGS, f"--user-data-dir={tmp_path}", f"--window-size={width},900", "--enable-logging=stderr",
         "--virtual-time-budget=2000", "--dump-dom", probed.as_uri()],
        capture_output=True, text=True, timeout=90,
    )  # fmt: skip
    probed.unlink()
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stderr[-2000:]
    return Seen(json.loads(html.unescape(found[1])), done.stderr)


PAGES = ["index.html", "woodworking.html", "comparison/index.html", "comparison/targets.html"]


@pytest.mark.parametrize("width", [1280, 500])
@pytest.mark.parametrize("name", PAGES)
def test_no_complaint_no_request_nothing_sticks_out(look: Look, name: str, width: int) -> None:
    seen = look(name, width)
    assert seen.probe["faults"] == []
    assert seen.probe["requests"] == []
    assert not re.search(r"CONSOLE.*(Uncaught|Refused|Error)", seen.log)
    assert seen.probe["overflow"] <= 0
    assert seen.probe["wide"] == []
    assert seen.probe["panels"] >= (2 if "comparison" not in name else 0)


@pytest.mark.parametrize("name", PAGES)
def test_every_link_resolves(look: Look, report: Path, name: str) -> None:
    links = look(name, 1280).probe["links"]
    assert len(links) > 5
    for link in links:
        parts = urlsplit(link)
        if parts.scheme == "https":
            assert parts.netloc == "doi.org"
            continue
        assert parts.scheme == "file", link
        target = Path(url2pathname(parts.path))
        target = target.with_name(target.name.removeprefix(PROBED))
        assert target.is_file(), link
        assert not parts.fragment or f'id="{parts.fragment}"' in target.read_text(encoding="utf-8"), link


def test_the_index_leads_to_every_page(look: Look, report: Path) -> None:
    links = {urlsplit(link).path.rpartition("report/")[2] for link in look("index.html", 1280).probe["links"]}
    assert {"woodworking.html", "comparison/index.html"} <= links


@pytest.mark.parametrize("name", PAGES)
def test_every_table_with_buttons_sorts(look: Look, name: str) -> None:
    tables = look(name, 1280).probe["tables"]
    assert tables
    for table in tables:
        assert table["sorted"] in {"ascending", "descending"}
        shown = [text for text in table["cells"] if text not in ("", "–")]
        numbers = [number for number in map(plain_number, shown) if number is not None]
        values = numbers if len(numbers) == len(shown) else [text.lower() for text in shown]
        assert values == sorted(values, reverse=table["sorted"] == "descending"), table
    assert max(len(set(table["cells"])) for table in tables) > (0 if name == "comparison/index.html" else 1)


def plain_number(text: str) -> float | None:
    """A number as the page shows it, in its base unit; None for other text."""
    found = re.fullmatch(r"[+≈≥]?\s*([-−]?[\d\s.,]*\d(?:e[-+]?\d+)?)\s*(%|s|ms|µs|ns)?", text)
    if found is None:
        return None
    return float(re.sub(r"[\s,]", "", found[1].replace("−", "-"))) * {"ms": 1e-3, "µs": 1e-6, "ns": 1e-9}.get(
        found[2], 1.0
    )


def test_sorting_by_a_click_on_a_head(look: Look) -> None:
    steps = look("woodworking.html", 1280).probe["steps"]
    assert [step["sorted"] for step in steps] == ["ascending", "descending", "ascending", "ascending"]
    assert all(step["focused"] and step["others"] == 1 for step in steps)
    for step, (down, numeric) in zip(steps, [(False, True), (True, True), (False, False), (False, True)], strict=True):
        for _, values in step["order"]:
            keys = [float(value) if numeric else value.lower() for value in values if value]
            assert keys == sorted(keys, reverse=down), step["name"]
            assert values[len(keys) :] == [""] * (len(values) - len(keys))


def test_sorting_never_lifts_an_infeasible_method(look: Look) -> None:
    steps = look("woodworking.html", 1280).probe["steps"]
    groups = [[name for name, _ in step["order"]] for step in steps]
    assert all(group == groups[0] for group in groups)
    assert groups[0] == sorted(groups[0], key=list(STANDINGS).index)
    members = [{name: sorted(values) for name, values in step["order"]} for step in steps[:2]]
    assert members[0] == members[1]


def test_a_screen_reader_hears_of_the_sorting(look: Look) -> None:
    said = look("woodworking.html", 1280).probe["said"]
    assert said == "Sorted by Limit use, ascending, feasible methods first."
