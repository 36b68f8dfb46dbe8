"""What tests of every module may use: two small problems, cases made of them, and planners that misbehave."""

from __future__ import annotations

import gc
import io
import os
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from study.cases.library import Case, Published
from study.cli.main import main
from study.planning import RunSettings
from study.problem import EndCondition, JointLimits, Problem
from tests.helpers.threads import no_processes

STUBS = Path(__file__).parent / "stubs"


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give every file of tests to one worker, so that what its tests share is made once; not without xdist."""
    from xdist.scheduler import LoadFileScheduling

    return LoadFileScheduling(config, log) if config.getvalue("dist") == "load" else None


def pytest_collection_finish() -> None:
    """Spare the collector of garbage what all tests share: modules and thousands of tests, which no test frees."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


for name in ("COLUMNS", "LINES"):  # readline sets them in whatever process starts the workers
    os.environ.pop(name, None)


@pytest.fixture
def tiny_problem() -> Problem:
    """Four waypoints, two joints, velocity and acceleration limited, rest to rest."""
    return Problem(
        "tiny",
        np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]]),
        JointLimits(np.array([1.0, 0.8]), np.array([2.0, 1.5])),
        EndCondition.SMOOTH,
        (0.1, 4.0),
    )


@pytest.fixture
def make_case() -> Callable[..., Case]:
    """Wrap a problem as a case."""
    return case_of


@pytest.fixture
def tiny_case(tiny_problem: Problem) -> Case:
    """The tiny problem as a case on the 3-5-3 curve, with published durations of three kinds."""
    published = (
        Published("slow", 9.0, np.array([3.0, 3.0, 3.0]), None, "Table 1"),
        Published("fast", 0.3, np.array([0.1, 0.1, 0.1]), None, "Table 1"),
        Published("silent", 5.0, None, None, "Section 2"),
        Published("split", None, np.array([2.5, 1.0, 2.5]), 0, "Table 2"),
        Published("split", None, np.array([1.0, 2.5, 1.0]), 1, "Table 2"),
    )
    return case_of(tiny_problem, published=published)


@pytest.fixture
def spline_case() -> Case:
    """Six waypoints, three joints, jerk limited too, on the clamped cubic spline."""
    waypoints = np.array(
        [[0, 0, 0], [0.3, 0.1, -0.2], [0.5, 0.4, 0.1], [0.2, 0.8, 0.3], [-0.1, 0.5, 0.2], [0, 0.2, 0.6]]
    )
    limits = JointLimits(np.full(3, 1.5), np.full(3, 4.0), np.full(3, 30.0))
    return case_of(Problem("tiny-spline", waypoints, limits, EndCondition.REST, (0.05, 3.0)), curve="cubic-spline")


def case_of(problem: Problem, curve: str = "poly353", published: tuple[Published, ...] = ()) -> Case:
    return Case(
        name=problem.name,
        title="a small case for tests",
        paper="none",
        problem=problem,
        curve=curve,
        settings=RunSettings(curve, evaluations=60, population=10, formulation="penalty", synchronisation="per-joint"),
        planner="stub-seeded",
        robot=None,
        units=("rad",) * problem.n_joints,
        published=published,
        notes=(),
    )


@pytest.fixture
def stubs(monkeypatch: pytest.MonkeyPatch) -> Path:
    """Install the stub planners of `tests/stubs`, in this process and in those that it starts."""
    monkeypatch.syspath_prepend(str(STUBS))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [str(STUBS), os.environ.get("PYTHONPATH", "")])))
    return STUBS


CASE_FILE = """\
name: mini
title: A case of one's own
paper: none
units: [rad, rad]
waypoints:
  ours: made up for the tests
  values: [[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]]
limits:
  velocity: {values: [1.0, 0.8], ours: made up}
  acceleration: {values: [2.0, 1.5], ours: made up}
end: smooth
duration_bounds: {lower: 0.1, upper: 4.0, ours: made up}
curve: poly353
planner: pso
settings: {population: 10, iterations: 6, formulation: penalty, synchronisation: per-joint, ours: made up}
"""


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    """A case of one's own as a file."""
    path = tmp_path / "mini.yaml"
    path.write_text(CASE_FILE)
    return path


@pytest.fixture
def threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run jobs in threads of this process; for tests in which worker processes are not the point."""
    no_processes(monkeypatch)


@pytest.fixture
def study_process() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command `study` in a process of its own."""

    def run(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
        options = {"env": dict(os.environ)} | options  # without what readline set behind Python's back
        return subprocess.run(command(*arguments), capture_output=True, text=True, timeout=110, **options)

    return run


@pytest.fixture
def study_command() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command `study` within this process."""
    return run_here


def run_here(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run the command `study` within this process, which is spared a second of imports; no error may escape from it."""
    out, errors = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(errors):
        patch.setattr(sys, "argv", ["study", *map(str, arguments)])
        patch.chdir(cwd or Path.cwd())
        with pytest.raises(SystemExit) as end:
            main()
    return subprocess.CompletedProcess(arguments, end.value.code or 0, out.getvalue(), errors.getvalue())


def command(*arguments: object) -> list[str]:
    """Command line of `study` with the interpreter that runs the tests."""
    return [sys.executable, "-c", "from study.cli.main import main; main()", *map(str, arguments)]


def stored(path: Path) -> int:
    """Count the results in a file that another process may be writing, or has not laid out yet."""
    if not (path.exists() and path.stat().st_size):
        return 0
    with closing(sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True)) as connection:
        try:
            return int(connection.execute("SELECT count(*) FROM results").fetchone()[0])
        except sqlite3.OperationalError:
            return 0


def wait_until(condition: Callable[[], bool], seconds: float = 90.0) -> None:
    """Wait for something that another process does."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)
