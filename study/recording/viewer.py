"""Open a recording in the viewer, or take its picture without a screen; nothing is sent from this machine."""

from __future__ import annotations

import subprocess
import tempfile
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rerun.experimental import ViewerClient

from study.errors import StudyError, unknown
from study.files import write_file
from study.recording.process import (
    LOOPBACK,
    address,
    private_environment,
    reason,
    require_display,
    running_viewer,
)
from study.recording.stream import TIMELINE


def view(path: Path) -> None:
    """Open a recording in the viewer and wait until its window is closed.

    The viewer listens on this machine only, and nothing that it would send reaches the network.

    Raises
    ------
    StudyError
        If the file, the viewer or a display is missing, or the viewer ends with an error.
    """
    _existing(path)
    require_display(f"cannot show {path}")
    with private_environment() as (program, environment):
        command = [program, str(path.resolve()), "--bind", LOOPBACK, "--port", "auto", "--hide-welcome-screen"]
        try:
            ended = subprocess.run(command, env=environment, stderr=subprocess.PIPE, text=True, check=False)  # noqa: S603
        except KeyboardInterrupt:
            return
    if ended.returncode:
        raise StudyError(f"cannot show {path}: the viewer ended with an error: {reason(ended.stderr)}")


def screenshot(recording: Path, png: Path, time: float = 0.0, tab: str | None = None) -> list[str]:
    """Take a picture of a recording as the viewer opens it, without a screen.

    Parameters
    ----------
    recording : Path
    png : Path
    time : float, s
        Where the time cursor stands.
    tab : str, optional
        Name of the tab to bring forward.

    Returns
    -------
    list of str
        Warnings and errors that views on the picture report; empty when all is well.

    Raises
    ------
    StudyError
        If the recording is missing, there is no such tab, or the viewer cannot draw here (it needs a Vulkan driver; a
        software one such as Mesa's lavapipe will do).
    """
    with headless(recording) as client:
        if tab is not None:
            show_tab(client, tab)
        client.set_time(TIMELINE, duration=time, play_state="paused")
        write_file(png, settled_picture(client))
        return complaints(client)


def picture(recording: Path, time: float = 0.0) -> bytes:
    """PNG of a recording as the viewer opens it.

    Raises
    ------
    StudyError
        As `screenshot` does.
    """
    with tempfile.TemporaryDirectory() as folder:
        png = Path(folder) / "viewer.png"
        screenshot(recording, png, time)
        return png.read_bytes()


@contextmanager
def headless(recording: Path, size: tuple[int, int] = (1920, 1080)) -> Iterator[ViewerClient]:
    """Run a viewer without a window on a recording, and end it afterwards.

    Raises
    ------
    StudyError
        If the recording is missing or the viewer does not come up.
    """
    _existing(recording)
    with running_viewer(size) as (_, port):
        client = ViewerClient.connect(address(port))
        client.open(str(recording.resolve()))
        while client.get_state().loading:
            clock.sleep(0.05)
        yield client


def settled_picture(client: ViewerClient, patience: float = 30.0, pause: float = 0.3) -> bytes:
    """Picture of the whole viewer once two in a row agree; data is loaded while it paints."""
    deadline = clock.monotonic() + patience
    last, picture = b"", client.take_screenshot()
    while picture != last and clock.monotonic() < deadline:
        clock.sleep(pause)
        last, picture = picture, client.take_screenshot()
    return picture


def complaints(client: ViewerClient) -> list[str]:
    """Say what the views on screen report as warnings and errors."""
    return [f"{view.name}: {report.summary}" for view in client.get_state().views for report in view.reports]


def show_tab(client: ViewerClient, name: str) -> None:
    """Bring the tab of this name forward.

    Raises
    ------
    StudyError
        If there is no such tab.
    """
    blueprint: dict[str, Any] = client.get_blueprint("recording").blueprint
    root = blueprint["/container/" + blueprint["/viewport"]["ViewportBlueprint"]["root_container"]][
        "ContainerBlueprint"
    ]
    tabs = {_display_name(blueprint["/" + part]): part for part in root["contents"]}
    if name not in tabs:
        raise unknown("tab", name, tabs)
    root["active_tab"] = tabs[name]
    client.set_blueprint(blueprint, "recording")


def _display_name(part: dict[str, dict[str, Any]]) -> str:
    """Name of a view or container in a blueprint, where it has one."""
    return next((str(fields["display_name"]) for fields in part.values() if "display_name" in fields), "")


def _existing(path: Path) -> None:
    if not path.is_file():
        raise StudyError(f"no recording at {path}; make it with: study run")
