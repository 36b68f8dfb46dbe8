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

import pytest

from study.experiment.cases import load_case
from study.experiment.lineup import Budget, Spec, make_cells
from study.experiment.runner import Task, execute
from study.report.page import STANDINGS, build_report

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no chromium is installed")

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--no-first-run", "--disable-default-apps", "--disable-dev-shm-usage",
)  # fmt: skip

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
const wide = [...document.querySelectorAll("main > *")].filter((one) => one.getBoundingClientRect().right > innerWidth + 1);
const report = { faults, steps, said: said && said.textContent, width: innerWidth,
  overflow: document.documentElement.scrollWidth - innerWidth, wide: wide.map((one) => one.tagName),
  requests: performance.getEntriesByType("resource").map((entry) => entry.name),
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
    results = [execute(Task(cell, case.problem)) for cell in cells]
    return build_report({case.name: case}, results, tmp_path_factory.mktemp("out") / "report", {"Python": "3.x"}).parent


@pytest.fixture(scope="module")
def look(report: Path, tmp_path_factory: pytest.TempPathFactory) -> Look:
    return cache(lambda name, width: _look(report, name, width, tmp_path_factory.mktemp("browser")))


def _look(report: Path, name: str, width: int, tmp_path: Path) -> Seen:
    text = (report / name).read_text(encoding="utf-8")
    probed = report / f"probed-{name}"
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


@pytest.mark.parametrize(
    ("name", "width"), [("index.html", 1280), ("woodworking.html", 1280), ("woodworking.html", 500)]
)
def test_no_complaint_no_request_nothing_sticks_out(look: Look, name: str, width: int) -> None:
    seen = look(name, width)
    assert seen.probe["faults"] == []
    assert seen.probe["requests"] == []
    assert not re.search(r"CONSOLE.*(Uncaught|Refused|Error)", seen.log)
    assert seen.probe["overflow"] <= 0
    assert seen.probe["wide"] == []
    assert seen.probe["panels"] >= 2


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
