"""Pages that show a recording in a browser, with the viewer itself inside: no server and no network.

The viewer's program for browsers is part of the installed package, which only hands it out over a local port; it is asked
for it once, and the pages carry it along.
"""

from __future__ import annotations

import base64
import gzip
import json
import subprocess
import time as clock
import urllib.error
import urllib.request
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path

from study.errors import StudyError
from study.files import read_file, write_file
from study.recording.process import LOOPBACK, PATIENCE, free_port, private_environment, reason

FOLDER = "viewer"
ENDING = "-viewer.html"
VIEWER = ("re_viewer.js", "re_viewer_bg.wasm")
"""Names under which the package serves the viewer for browsers: its script and its compiled part."""


def interactive_pages(recordings: Mapping[str, Path], out: Path) -> dict[str, tuple[str, ...]]:
    """Write the viewer and every recording into a folder.

    Parameters
    ----------
    recordings : mapping of str to Path
        By the stem of the page to come.
    out : Path
        Folder of the report; its `viewer` takes the parts, about 20 MB for the viewer and a few for every recording.

    Returns
    -------
    dict of str to tuple of three str
        For every stem the scripts that its page needs, in order, as addresses relative to `out`.

    Raises
    ------
    StudyError
        If the viewer is not installed or does not hand itself out, or the folder cannot be written.
    """
    stem = f"{FOLDER}/rerun-{version('rerun-sdk')}"
    program, machine = f"{stem}.js", f"{stem}.wasm.js"
    if not ((out / program).exists() and (out / machine).exists()):
        script, binary = _viewer_files(next(iter(recordings.values())))
        write_file(out / program, script)
        write_file(out / machine, _packed("VIEWER", binary))
    for name, path in recordings.items():
        write_file(out / FOLDER / f"{name}.rrd.js", _packed("RECORDING", read_file(path)))
    return {name: (program, machine, f"{FOLDER}/{name}.rrd.js") for name in recordings}


def forget_pages(out: Path, stems: Iterable[str]) -> None:
    """Remove pages with recordings in them, so that none shows results that have been replaced."""
    for stem in stems:
        (out / f"{stem}{ENDING}").unlink(missing_ok=True)
        (out / FOLDER / f"{stem}.rrd.js").unlink(missing_ok=True)


def _packed(name: str, content: bytes) -> str:
    """A script that holds compressed bytes: the one kind of file that a page opened from a disk may load."""
    text = base64.b64encode(gzip.compress(content, 6, mtime=0)).decode("ascii")
    return f"window.{name} = {json.dumps(text)};\n"


def _viewer_files(recording: Path) -> tuple[bytes, bytes]:
    """The viewer's script and its compiled part, as the installed package serves them on this machine."""
    port, other = free_port(), free_port()
    with private_environment() as (program, environment):
        command = [program, str(recording.resolve()), "--serve-web", "--bind", LOOPBACK]
        command += ["--port", str(other), "--web-viewer-port", str(port)]
        process = subprocess.Popen(  # noqa: S603
            command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        try:
            files = [_fetched(process, f"http://{LOOPBACK}:{port}/{name}") for name in VIEWER]
        finally:
            process.terminate()
            _, errors = process.communicate()
    script, binary = files
    if script is None or binary is None:
        raise StudyError(f"the viewer does not hand out its page: {reason(errors)}")
    return script, binary


def _fetched(process: subprocess.Popen[str], address: str) -> bytes | None:
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never by way of a proxy
    deadline = clock.monotonic() + PATIENCE
    while process.poll() is None and clock.monotonic() < deadline:
        try:
            with opener.open(address, timeout=PATIENCE) as answer:
                return bytes(answer.read())
        except (urllib.error.URLError, ConnectionError, TimeoutError):
            clock.sleep(0.1)
    return None
