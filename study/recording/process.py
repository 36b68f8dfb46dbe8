"""The viewer's process: started on this machine only, with nothing sent from it."""

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

from rerun.experimental import ViewerClient

from study.errors import StudyError

LOOPBACK = "127.0.0.1"
PATIENCE = 60.0
"""Longest time for the viewer to come up, s."""

_PROXIES = ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY")
_HINT = " (to draw without a screen it needs a Vulkan driver, such as Mesa's software one)"
NOWHERE = {
    **{name: f"http://{LOOPBACK}:9" for upper in _PROXIES for name in (upper, upper.lower())},
    "NO_PROXY": f"{LOOPBACK},localhost",
    "no_proxy": f"{LOOPBACK},localhost",
}
"""Environment in which requests to the outside end at a closed port of this machine."""


def address(port: int) -> str:
    """Address of a viewer on this machine."""
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def require_display(what: str, instead: str = "copy the recording to a desktop and open it there") -> None:
    """Raise a StudyError that begins with `what` and ends with `instead` where there is no display for a window."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise StudyError(f"{what}: there is no display here; {instead}")


@contextmanager
def running_viewer(hidden: tuple[int, int] | None) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """Start a viewer and wait until it listens.

    Parameters
    ----------
    hidden : pair of int, pixels, optional
        Size of the picture of a viewer without a window, which ends with the context; None opens a window that stays.

    Raises
    ------
    StudyError
        If there is no viewer, it does not come up, or it ends while it is in use.
    """
    options = ["--headless", "--window-size", f"{hidden[0]}x{hidden[1]}"] if hidden else []
    with private_environment() as (program, environment), tempfile.TemporaryFile("w+") as log:
        port = free_port()
        command = [program, *options, "--hide-welcome-screen", "--bind", LOOPBACK, "--port", str(port)]
        process = subprocess.Popen(  # noqa: S603
            command, env=environment, stdout=log, stderr=log, text=True, start_new_session=True
        )
        try:
            if not _listening(process, port):
                log.seek(0)
                raise StudyError(f"the viewer did not start{_HINT if hidden else ''}: {reason(log.read())}")
            yield process, port
        except ConnectionError:
            log.seek(0)
            raise StudyError(f"the viewer ended early: {reason(log.read())}") from None
        finally:
            if hidden:
                process.terminate()
                process.wait()


@contextmanager
def private_environment() -> Iterator[tuple[str, dict[str, str]]]:
    """The viewer's program, and an environment that keeps it quiet without touching the user's own settings.

    Its usage statistics are off, and its look for a newer release is sent to a proxy that does not exist.

    Raises
    ------
    StudyError
        If the viewer is not installed.
    """
    package = importlib.util.find_spec("rerun_cli")
    program = (
        Path(package.origin).with_name("rerun.exe" if os.name == "nt" else "rerun")
        if package and package.origin
        else None
    )
    if program is None or not program.exists():
        raise StudyError("the viewer is not installed; install it with: pip install rerun-sdk==0.41.0")
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "XDG_CONFIG_HOME": folder, **NOWHERE}
        quiet = {"env": environment, "check": False, "capture_output": True}
        subprocess.run([str(program), "analytics", "disable"], **quiet)  # type: ignore[call-overload]  # noqa: S603
        yield str(program), environment


def _listening(process: subprocess.Popen[str], port: int) -> bool:
    deadline = clock.monotonic() + PATIENCE
    while process.poll() is None and clock.monotonic() < deadline:
        try:
            with socket.create_connection((LOOPBACK, port), timeout=1.0):
                ViewerClient.connect(address(port)).get_state()
            return True
        except (OSError, RuntimeError, ValueError):
            clock.sleep(0.1)
    return False


def free_port() -> int:
    """A port of this machine on which nothing listens."""
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def reason(text: str | None) -> str:
    """Find in a program's output why it ended: the line of a panic or an error, or else the last line."""
    lines = [line.strip() for line in (text or "").splitlines() if line.strip()]
    telling = [line for line in lines if "panicked at" in line or line.startswith("Error:")]
    return (telling or lines or ["no message"])[-1]
