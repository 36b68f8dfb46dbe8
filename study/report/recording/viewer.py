"""Open a recording in the viewer, or take its picture without a screen; nothing is sent from this machine."""

from __future__ import annotations

import importlib.util
import os
import socket
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rerun.experimental import ViewerClient

from study.errors import StudyError, unknown
from study.report.recording.stream import TIMELINE

LOOPBACK = "127.0.0.1"


def view(path: Path) -> None:
    """Open a recording in the viewer and wait until its window is closed.

    The viewer listens on this machine only and its usage statistics are switched off; the one thing it may still try
    is to ask for its newest release, which fails silently without a network.

    Raises
    ------
    StudyError
        If the file, the viewer or a display is missing, or the viewer ends with an error.
    """
    _existing(path)
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise StudyError(f"cannot show {path}: there is no display here; copy the file to a desktop and open it there")
    with private_environment() as (program, environment):
        command = [program, str(path.resolve()), "--bind", LOOPBACK, "--port", "auto", "--hide-welcome-screen"]
        try:
            ended = subprocess.run(command, env=environment, stderr=subprocess.PIPE, text=True, check=False)  # noqa: S603
        except KeyboardInterrupt:
            return
    if ended.returncode:
        raise StudyError(f"cannot show {path}: the viewer ended with an error: {_last_line(ended.stderr)}")


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
        png.write_bytes(settled_picture(client))
        return complaints(client)


@contextmanager
def headless(recording: Path, size: tuple[int, int] = (1920, 1080), patience: float = 60.0) -> Iterator[ViewerClient]:
    """Run a viewer without a window on a recording, and end it afterwards.

    Raises
    ------
    StudyError
        If the recording is missing or the viewer does not come up.
    """
    _existing(recording)
    with private_environment() as (program, environment), tempfile.TemporaryFile("w+") as log:
        port = _free_port()
        command = [program, "--headless", "--window-size", f"{size[0]}x{size[1]}", "--hide-welcome-screen"]
        command += ["--bind", LOOPBACK, "--port", str(port)]
        process = subprocess.Popen(command, env=environment, stdout=log, stderr=log, text=True)  # noqa: S603
        try:
            client = _connected(process, port, clock.monotonic() + patience)
            if client is None:
                log.seek(0)
                raise StudyError(f"cannot draw {recording}: the viewer did not start: {_last_line(log.read())}")
            client.open(str(recording.resolve()))
            while client.get_state().loading:
                clock.sleep(0.05)
            yield client
        finally:
            process.terminate()
            process.wait()


def settled_picture(client: ViewerClient, patience: float = 30.0) -> bytes:
    """Picture of the whole viewer once two in a row agree; data is loaded while it paints."""
    deadline = clock.monotonic() + patience
    last, picture = b"", client.take_screenshot()
    while picture != last and clock.monotonic() < deadline:
        clock.sleep(0.3)
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


@contextmanager
def private_environment() -> Iterator[tuple[str, dict[str, str]]]:
    """The viewer's program, and an environment in which its usage statistics are off without touching the user's own."""
    found = importlib.util.find_spec("rerun_cli")
    program = (
        Path(found.origin).with_name("rerun.exe" if os.name == "nt" else "rerun") if found and found.origin else None
    )
    if program is None or not program.exists():
        raise StudyError("the viewer is not installed; install it with: pip install rerun-sdk==0.41.0")
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "XDG_CONFIG_HOME": folder}
        quiet = {"env": environment, "check": False, "capture_output": True}
        subprocess.run([str(program), "analytics", "disable"], **quiet)  # type: ignore[call-overload]  # noqa: S603
        yield str(program), environment


def _connected(process: subprocess.Popen[str], port: int, deadline: float) -> ViewerClient | None:
    while process.poll() is None and clock.monotonic() < deadline:
        try:
            with socket.create_connection((LOOPBACK, port), timeout=1.0):
                client = ViewerClient.connect(f"rerun+http://{LOOPBACK}:{port}/proxy")
            client.get_state()
            return client
        except (OSError, RuntimeError, ValueError):
            clock.sleep(0.1)
    return None


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def _existing(path: Path) -> None:
    if not path.is_file():
        raise StudyError(f"no recording at {path}; make it with: study run")


def _last_line(text: str | None) -> str:
    lines = [line.strip() for line in (text or "").splitlines() if line.strip()]
    return lines[-1] if lines else "no message"
