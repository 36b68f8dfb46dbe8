"""The command `study`, also as `python -m study`; it says in one sentence if a package that it needs is missing."""

from __future__ import annotations

import gc
import os
import sys
from importlib.metadata import version

from study.cli.interrupts import ending_at_once

GARBAGE = 100_000
"""New objects after which rubbish is looked for: imports make many that stay, and the usual 700 cost a tenth of a second."""


def main() -> None:
    """Run the command."""
    gc.set_threshold(GARBAGE)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as in workers: for small matrices more threads only spin
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")  # no need to look through every package for some
    if sys.argv[1:] == ["--version"]:  # before typer, which is slow to take an option
        print(version("time-optimal-study"))
        return
    try:
        with ending_at_once():
            from study.cli.main import main as run

        run()
    except ModuleNotFoundError as error:
        if str(error.name).partition(".")[0] == "study":
            raise  # a file of ours is missing: no package that could be installed
        print(
            f"study: the command needs the Python package {error.name!r}, which is not installed; install everything with: "
            "pip install time-optimal-study (from Python, study.plan and study.compare work without it)",
            file=sys.stderr,
        )
        sys.exit(2)


if __name__ == "__main__":
    main()
