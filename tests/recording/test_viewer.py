"""The viewer itself: every tab of a real recording, drawn without a screen."""

from __future__ import annotations

import subprocess
import time
import zlib
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image
from rerun.experimental import ViewerClient

from study.analysis.case_summary import summarise_case
from study.cases.library import case_names, load_case
from study.errors import StudyError
from study.recording import live_recording, moving_picture, process, record_case, screenshot, view, viewer
from study.recording.contents import NANOSECOND, gather
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells
from tests.helpers.recordings import some_results
from tests.helpers.viewer import can_draw, pixels

TABS = ("Overview", "Position", "Velocity", "Acceleration", "Jerk", "Limits in use", "Convergence", "Durations")
SMALL = (960, 540)
"""Pixels of a viewer that paints in software; its views are the same as in a larger one."""

SEARCHED = ("Overview", "Convergence over wall time", "Search population", "Search population in motion")
OTHERS = [name for name in case_names(default_only=True) if name != "woodworking"]
FIRST_LOOK = "ur5-helix"
"""The case of most waypoints; it has most of a case's own."""


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    case = load_case("woodworking")
    return record_case(summarise_case(case, some_results(case)), tmp_path_factory.mktemp("viewer") / "woodworking.rrd")


@pytest.mark.slow
@can_draw
@pytest.mark.timeout(240)
def test_every_tab_is_drawn_without_complaint(recording: Path) -> None:
    with viewer.headless(recording, SMALL) as client:
        pictures = {}
        for tab in (*TABS, "All arms"):
            viewer.show_tab(client, tab)
            client.set_time("t", duration=1.0, play_state="paused")
            picture = pixels(viewer.settled_picture(client))
            assert viewer.complaints(client) == [], tab
            assert picture.shape == (*SMALL[::-1], 3)
            pictures[tab] = picture
        # something of every method is drawn: bright and coloured pixels, and every tab looks different
        for tab, picture in pictures.items():
            coloured = np.ptp(picture.astype(int), axis=2) > 60
            assert coloured.mean() > 5e-4, tab
        assert len({zlib.crc32(picture.tobytes()) for picture in pictures.values()}) == len(pictures)
        errors = [entry.message for entry in client.get_logs() if entry.level == "ERROR"]
        assert errors == []


@can_draw
@pytest.mark.timeout(120)
@pytest.mark.parametrize(
    ("name", "tabs"),
    [
        (FIRST_LOOK, ("Overview", "Search population in motion")),
        *(pytest.param(name, SEARCHED, marks=pytest.mark.slow) for name in ("woodworking", *OTHERS)),
    ],
)
def test_the_first_look_and_the_searches_of_every_case(name: str, tabs: tuple[str, ...], tmp_path: Path) -> None:
    case = load_case(name)
    cells = make_cells([case], [Spec(case.planner), Spec("pso", "scaled")], Budget(seeds=1, evaluations=100))
    results = [CellJob(cell, case.problem).run() for cell in cells]
    path = record_case(summarise_case(case, [*some_results(case), *results]), tmp_path / f"{name}.rrd", samples=60)
    with viewer.headless(path, SMALL) as client:
        for tab in tabs:
            viewer.show_tab(client, tab)
            client.set_time("t", duration=0.3, play_state="paused")
            picture = pixels(viewer.settled_picture(client))
            assert viewer.complaints(client) == [], tab
            coloured = np.ptp(picture.astype(int), axis=2) > 60
            assert coloured.mean() > 5e-4, tab
        said = [entry.message for entry in client.get_logs() if entry.level in ("ERROR", "WARN")]
        assert [text for text in said if not text.startswith("Software rasterizer")] == []


@can_draw
@pytest.mark.timeout(120)
def test_a_recording_opens_with_the_arms_in_motion(recording: Path) -> None:
    case = load_case("woodworking")
    run_time = gather(summarise_case(case, some_results(case)), 250).run_time
    with viewer.headless(recording, SMALL) as client:
        seen: list[float] = []
        deadline = time.monotonic() + 60
        while len(seen) < 8 and time.monotonic() < deadline:
            client.take_screenshot()  # time goes on as the viewer paints
            (shown,) = client.get_state().recordings
            seen.append((shown.current_time or 0) * NANOSECOND)
        assert shown.current_timeline == "t"
        assert len(set(seen)) > 3  # it moves
        assert max(seen) <= run_time + 0.1 < max(line.end or 0 for line in shown.timelines) * NANOSECOND + 0.2


@can_draw
@pytest.mark.timeout(120)
def test_a_screenshot_shows_the_chosen_time(recording: Path, tmp_path: Path) -> None:
    for name, instant in (("start", 0.0), ("middle", 4.0)):
        assert screenshot(recording, tmp_path / f"{name}.png", instant) == []
    start, middle = (pixels((tmp_path / f"{name}.png").read_bytes()) for name in ("start", "middle"))
    assert start.shape == middle.shape == (1080, 1920, 3)
    assert (start != middle).any(axis=2).mean() > 1e-3  # the arms have moved


@can_draw
@pytest.mark.timeout(120)
def test_a_tab_that_is_not_there_is_named(recording: Path, tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"no tab 'Velocities'; did you mean 'Velocity'"):
        screenshot(recording, tmp_path / "a.png", tab="Velocities")


@can_draw
def test_without_a_driver_there_is_one_sentence(
    recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):
        monkeypatch.setenv(name, str(tmp_path / "none.json"))
    with pytest.raises(StudyError, match=r"needs a Vulkan driver.*: .*panicked at|ended early: .*panicked at"):
        screenshot(recording, tmp_path / "a.png")


def test_viewing_needs_a_file_and_a_display(recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(StudyError, match=r"no recording at .*gone\.rrd"):
        view(tmp_path / "gone.rrd")
    monkeypatch.setattr(process.sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(StudyError, match=r"there is no display here"):
        view(recording)


def test_a_missing_viewer_is_one_sentence(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(process.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(StudyError, match=r"the viewer is not installed; install it with"):
        view(recording)


def test_the_viewer_listens_on_loopback_with_statistics_off(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[tuple[list[str], dict[str, str]]] = []
    real = subprocess.run

    def run(command: list[str], **options: object) -> object:
        environment = options["env"]
        assert isinstance(environment, dict)
        calls.append((command, environment))
        if command[1:2] == ["analytics"]:
            return real(command, **options)  # type: ignore[call-overload]
        settings = Path(environment["XDG_CONFIG_HOME"]) / "rerun" / "analytics.json"
        assert '"analytics_enabled":false' in settings.read_text().replace(" ", "")
        assert environment["https_proxy"] == "http://127.0.0.1:9"  # a closed port: looks for new releases end there
        return SimpleNamespace(returncode=7, stderr="first\nError: last words\nReport bugs\n")

    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(viewer.subprocess, "run", run)
    with pytest.raises(StudyError, match=r"ended with an error: Error: last words$"):
        view(recording)
    command = calls[-1][0]
    assert command[command.index("--bind") + 1] == "127.0.0.1"
    assert not Path(calls[-1][1]["XDG_CONFIG_HOME"]).exists()


@can_draw
@pytest.mark.timeout(120)
def test_results_arrive_in_an_open_viewer() -> None:
    case = load_case("woodworking")
    with live_recording(hidden=SMALL) as (live, url):
        client = ViewerClient.connect(url)
        for result in some_results(case):
            live.add(case, result)
        live.close()
        deadline = time.monotonic() + 20
        while not client.get_state().views and time.monotonic() < deadline:
            time.sleep(0.1)
        assert {view.name for view in client.get_state().views} >= {"Convergence", "Table", "Durations"}
        picture = pixels(viewer.settled_picture(client))
        assert (np.ptp(picture.astype(int), axis=2) > 60).mean() > 5e-4
        assert viewer.complaints(client) == []
        with pytest.raises(StudyError, match=r"got a result of case 'woodworking'"):
            live.add(load_case("puma560"), some_results(case)[0])


@can_draw
@pytest.mark.timeout(120)
def test_arms_move_side_by_side_in_a_picture() -> None:
    case = load_case("woodworking")
    summary = summarise_case(case, some_results(case))
    image = Image.open(BytesIO(moving_picture(summary, frames=3)))
    frames = []
    for k in range(image.n_frames):
        image.seek(k)
        frames.append(np.asarray(image.convert("RGB")).astype(int))
    assert (image.n_frames, image.info["loop"]) == (3, 0)
    changed = [(np.abs(frames[k + 1] - frames[k]).max(axis=2) > 40).mean() for k in range(2)]
    assert min(changed) > 1e-3
    assert (np.ptp(frames[1], axis=2) > 60).mean() > 5e-3
    with pytest.raises(StudyError, match=r"has no robot"):
        moving_picture(summarise_case(replace(case, robot=None), some_results(case)))


def test_live_recording_needs_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process.sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(StudyError, match=r"cannot show the run live: there is no display"), live_recording():
        pass
