"""The viewer inside a notebook; its program comes from the installed package and not from the network."""

from __future__ import annotations

import os
from contextlib import redirect_stdout
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from study.errors import StudyError
from study.files import read_file

HEIGHT = 640
"""Of the viewer in a notebook, pixels."""


def show_in_notebook(path: Path) -> None:
    """Show a recording in place, below the cell that runs this.

    Raises
    ------
    StudyError
        If the file is missing, or the viewer's part for notebooks is not installed.
    """
    content = read_file(path)
    if find_spec("rerun_notebook") is None:
        wanted = f"pip install rerun-notebook=={version('rerun-sdk')}"
        raise StudyError(f"the recording is {path}; to see it in the notebook itself, {wanted} and start it again")
    os.environ.setdefault("RERUN_NOTEBOOK_ASSET", "inline")  # its default is an address on the network
    with redirect_stdout(None):
        from IPython.display import display
        from rerun_notebook import Viewer

    viewer = Viewer(width="auto", height=HEIGHT)
    viewer.send_rrd(content)
    display(viewer)
