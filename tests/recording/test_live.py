"""`study run --live`: cells show up in a viewer as they finish, and neither a missing nor a closed viewer costs a result."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rerun.experimental import ViewerClient
from typer.testing import CliRunner

from study import recording
from study.cli.main import app
from study.errors import StudyError
from study.recording import LiveRecording, live_recording, viewer
from tests.conftest import stored
from tests.helpers.viewer import can_draw, pixels

Arguments = list[str]


@pytest.fixture
def arguments(case_file: Path, tmp_path: Path) -> Arguments:
    """A run of six cells that streams into a viewer."""
    command = ["run", "--cases", str(case_file), "--planners", "pso,random-search", "--seeds", "3", "--jobs", "1"]
    return [*command, "--evaluations", "200", "--no-report", "--live", "--out", str(tmp_path / "o")]


@can_draw
@pytest.mark.timeout(180)
def test_every_finished_cell_arrives_in_the_viewer(arguments: Arguments, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    running: set[tuple[str, int]] = set()
    seen: dict[str, object] = {}

    @contextmanager
    def hidden() -> Iterator[tuple[LiveRecording, str]]:
        with live_recording((1280, 720)) as (live, url):
            add = live.add
            monkeypatch.setattr(live, "add", lambda case, result: (told.append(result.cell.label), add(case, result)))
            show = live.show
            monkeypatch.setattr(
                live,
                "show",
                lambda case, cell, progress: (
                    running.add((cell.label, cell.settings.seed)),
                    show(case, cell, progress),
                ),
            )
            yield live, url
            live.close()
            client = ViewerClient.connect(url)
            picture = viewer.settled_picture(client)
            seen.update(names={one.name for one in client.get_state().views}, complaints=viewer.complaints(client))
            seen.update(coloured=float((np.ptp(pixels(picture).astype(int), axis=2) > 60).mean()))

    monkeypatch.setattr(recording, "live_recording", hidden)
    ended = CliRunner().invoke(app, arguments)
    assert ended.exception is None, ended.output
    assert sorted(told) == ["pso"] * 3 + ["random-search"] * 3
    assert running == {(label, seed) for label in ("pso", "random-search") for seed in range(3)}  # before they ended
    assert {"Searching now", "Convergence"} <= seen["names"]  # type: ignore[operator]
    assert seen["complaints"] == []
    assert seen["coloured"] > 5e-4  # type: ignore[operator]
    told.clear()
    ended = CliRunner().invoke(app, arguments)  # nothing is left to run: what is stored is shown
    assert ended.exception is None, ended.output
    assert len(told) == 6


@can_draw
@pytest.mark.timeout(180)
@pytest.mark.parametrize(
    "connected", [True, pytest.param(False, marks=pytest.mark.slow)]
)  # a vain connection waits long
def test_closing_the_viewer_does_not_end_the_run(
    arguments: Arguments, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, connected: bool
) -> None:
    @contextmanager
    def closed_soon() -> Iterator[tuple[LiveRecording, str]]:
        with recording.live.running_viewer((640, 480)) as (process, port):
            live = LiveRecording(recording.live.address(port))
            show = live.show

            def show_and_close(*shown: Any) -> None:
                if connected:
                    show(*shown)
                process.kill()
                process.wait()
                if not connected:
                    show(*shown)

            monkeypatch.setattr(live, "show", show_and_close)
            yield live, ""
            assert process.poll() is not None
            live.close()

    monkeypatch.setattr(recording, "live_recording", closed_soon)
    began = time.monotonic()
    ended = CliRunner().invoke(app, arguments)
    assert ended.exception is None, ended.output
    assert stored(tmp_path / "o" / "results.sqlite") == 6
    assert time.monotonic() - began < 60


def test_without_a_display_the_run_does_not_begin(
    arguments: Arguments,
    study_command: Callable[..., subprocess.CompletedProcess[str]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    ended = study_command(*arguments)
    assert ended.returncode == 2
    assert ended.stderr.startswith("study: cannot show the run live: there is no display here; leave out --live")
    assert ended.stderr.count("\n") == 1
    assert stored(tmp_path / "o" / "results.sqlite") == 0


def test_without_a_viewer_the_run_does_not_begin(arguments: Arguments, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(recording.process.importlib.util, "find_spec", lambda name: None)
    ended = CliRunner().invoke(app, arguments)
    assert isinstance(ended.exception, StudyError)
    assert "the viewer is not installed; install it with: pip install rerun-sdk" in str(ended.exception)


def test_the_help_says_what_live_shows() -> None:
    text = " ".join(CliRunner().invoke(app, ["run", "--help"], env={"COLUMNS": "200"}).output.replace("│", " ").split())
    assert "--live" in text
    assert "running searches several times a second" in text
