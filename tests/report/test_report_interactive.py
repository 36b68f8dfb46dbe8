"""Pages of the report with the viewer inside: in a real browser, opened from the disk, with nothing sent anywhere."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from study.errors import StudyError
from study.recording import offline
from tests.conftest import CASE_FILE, run_here

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="no chromium is installed")
Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("interactive")
    case = folder / "mini.yaml"
    case.write_text(CASE_FILE.replace("title: A case of one's own", "title: '<b>mine</b>'"))
    arguments = ["--cases", case, "--planners", "pso,centre", "--seeds", 1, "--evaluations", 60, "--no-report"]
    for words in (["run", *arguments, "--jobs", 1], ["report", "--interactive"]):
        done = run_here(*words, "--out", folder / "o")
        assert done.returncode == 0, done.stderr
    return folder / "o"


@needs_chromium
@pytest.mark.slow
@pytest.mark.timeout(240)
def test_the_recording_is_drawn_and_no_request_leaves_the_page(out: Path) -> None:
    playwright = pytest.importorskip("playwright.sync_api", reason="the extra `browser` is not installed")
    page = out / "report" / "mini-viewer.html"
    with playwright.sync_playwright() as driver:
        flags = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=flags)
        tab = browser.new_page(viewport={"width": 800, "height": 600})
        asked, faults = [], []
        tab.on("request", lambda request: asked.append(request.url))
        tab.on("pageerror", lambda error: faults.append(str(error)))
        tab.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
        tab.goto(page.as_uri())
        for _ in range(450):
            if tab.evaluate("document.documentElement.dataset.ready"):
                break
            tab.wait_for_timeout(200)
        assert tab.evaluate("document.documentElement.dataset.ready") == "yes", tab.locator("#said").inner_text()
        coloured = 0.0
        for _ in range(40):
            picture = np.asarray(Image.open(BytesIO(tab.screenshot())).convert("RGB")).astype(int)
            coloured = float((np.ptp(picture[60:], axis=2) > 60).mean())
            if coloured > 3e-3:
                break
        assert coloured > 3e-3  # lines and bars of the recording
        assert tab.locator("h1").inner_text() == "<b>mine</b>"
        files = [url for url in asked if not url.startswith(("data:", "blob:"))]
        assert len(files) == 4  # the page, the viewer in two parts, the recording
        assert all(url.startswith(f"{(out / 'report').as_uri()}/") for url in files)
        assert faults == []
        browser.close()


def test_the_report_leads_to_the_pages_until_they_are_out_of_date(out: Path, study_command: Command) -> None:
    report = out / "report"
    for name in ("index", "mini"):
        assert 'href="mini-viewer.html"' in (report / f"{name}.html").read_text(encoding="utf-8")
    text = (report / "mini-viewer.html").read_text(encoding="utf-8")
    assert "<b>mine</b>" not in text
    assert "connect-src data: blob:" in text
    assert {path.suffix for path in (report / "viewer").iterdir()} == {".js"}
    copy = out.parent / "copy"
    shutil.copytree(out, copy)
    done = study_command("report", "--out", copy)
    assert done.returncode == 0, done.stderr
    assert not (copy / "report" / "mini-viewer.html").exists()
    assert not (copy / "report" / "viewer" / "mini.rrd.js").exists()
    assert "mini-viewer" not in (copy / "report" / "mini.html").read_text(encoding="utf-8")


def test_a_viewer_that_hands_nothing_out_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = tmp_path / "broken.rrd"
    broken.write_bytes(b"")
    monkeypatch.setattr(offline, "PATIENCE", 0.0)
    with pytest.raises(StudyError, match=r"the viewer does not hand out its page: "):
        offline.interactive_pages({"broken": broken}, tmp_path)
