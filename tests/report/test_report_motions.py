"""Files that a row of the report leads to: its motion as a file, its recording and the command that makes it again."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

from study.analysis.case_summary import CaseSummary, summarise_case
from study.cases.library import load_case
from study.report.page import build_report
from study.report.tables import RATE, motion_files
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells


class Links(HTMLParser):
    """Addresses of a page's links."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep where a link goes."""
        self.found += [value for name, value in attrs if tag == "a" and name == "href" and value]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[CaseSummary, Path]:
    case = load_case("puma560")
    specs = [Spec("chaotic-spso", "scaled", "shared"), Spec("ruckig-stops"), Spec("toppra")]
    cells = make_cells([case], specs, Budget(seeds=2, evaluations=100))
    results = [CellJob(cell, case.problem).run() for cell in cells]
    out = tmp_path_factory.mktemp("motions")
    (out / "recordings").mkdir()
    (out / "recordings" / "puma560.rrd").write_bytes(b"")
    summary = summarise_case(case, results)
    return summary, build_report([summary], out / "report", {}).parent


def test_every_motion_is_a_file_that_holds_it(made: tuple[CaseSummary, Path]) -> None:
    summary, folder = made
    files = motion_files(summary.methods)
    assert {"chaotic-spso:scaled,shared", "ruckig-stops", "published: RRT-SPSO"} < files.keys()
    assert {path.name for path in (folder / "tables" / "puma560").iterdir()} == set(files.values())
    for method in summary.whole:
        if method.label in files:
            assert method.motion is not None
            table = np.loadtxt(folder / "tables" / "puma560" / files[method.label], delimiter=",", skiprows=1)
            orders = (table.shape[1] - 1) // method.motion.n_joints  # without rates that step
            expected = [method.motion(table[:, 0], order) for order in range(orders)]
            np.testing.assert_allclose(table[:, 1:], np.hstack(expected), rtol=0, atol=1e-14)
            assert table[-1, 0] == method.motion.duration
            assert np.diff(table[:-1, 0]) == pytest.approx(1 / RATE)


def test_every_row_leads_to_its_motion_its_recording_and_its_command(made: tuple[CaseSummary, Path]) -> None:
    summary, folder = made
    text = (folder / "puma560.html").read_text(encoding="utf-8")
    files = motion_files(summary.methods)
    rows = re.findall(r'<th scope="row" data-value="([^"]*)">(.*?)</th>', text, re.DOTALL)
    assert {name for name, _ in rows} >= files.keys()
    for name, cell in rows:
        links = Links(cell).found
        assert links == ([f"tables/puma560/{files[name]}", "../recordings/puma560.rrd"] if name in files else [])
        ran = any(method.label == name and method.planner != "published" for method in summary.methods)
        assert (f"study run --cases puma560 --planners {name}" in cell) == ran


def test_every_link_resolves(made: tuple[CaseSummary, Path]) -> None:
    folder = made[1]
    for page in folder.glob("*.html"):
        links = Links(page.read_text(encoding="utf-8")).found
        assert len(links) > 5
        for link in links:
            place, _, mark = unquote(link).partition("#")
            if not place.startswith("https://doi.org/"):
                target = folder / place if place else page
                assert target.is_file(), link
                assert not mark or f'id="{mark}"' in target.read_text(encoding="utf-8")


def test_a_judged_total_is_featured_before_a_shorter_one_that_cannot_be_judged(
    made: tuple[CaseSummary, Path],
) -> None:
    summary, folder = made
    best = summary.best
    assert best.published is not None
    assert (best.published.label, best.published.duration) == ("published: RRT-SPSO", pytest.approx(2.41665, abs=1e-9))
    assert best.fixed is None  # TOPP-RA needs acceleration limits
    index = (folder / "index.html").read_text(encoding="utf-8")
    assert "2.4166 s" in index or "2.4167 s" in index
    assert "2.0718 s" not in index
