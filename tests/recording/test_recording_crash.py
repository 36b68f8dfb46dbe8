"""A run that is killed leaves whole recordings of what was finished: `study report` makes them from the store."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from study.analysis.case_summary import summarise_case
from study.cases.library import load_case
from study.recording.contents import NANOSECOND, gather
from study.recording.process import private_environment
from study.recording.stream import entity
from study.runs.execute import stored_results
from study.runs.remembered import remembered_lineup
from study.store.store import Store
from tests.conftest import command, stored, wait_until
from tests.helpers.recordings import series

Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.mark.slow
@pytest.mark.timeout(240)
def test_a_killed_run_leaves_recordings_of_what_was_finished(
    study_command: Command, case_file: Path, tmp_path: Path
) -> None:
    later = tmp_path / "later.yaml"
    later.write_text(case_file.read_text().replace("name: mini", "name: zzz"))
    out = tmp_path / "o"
    arguments = ["--cases", f"{case_file},{later}", "--planners", "pso,golds-pso", "--seeds", 150, "--evaluations", 60]
    with subprocess.Popen(
        command("run", *arguments, "--jobs", 1, "--out", out), stdout=subprocess.DEVNULL, start_new_session=True
    ) as process:
        wait_until(lambda: stored(out / "results.sqlite") >= 5)
        os.killpg(process.pid, signal.SIGKILL)  # nobody can tidy up after this
    kept = stored(out / "results.sqlite")
    assert 5 <= kept < 600
    assert not (out / "recordings").exists()

    ended = study_command("report", "--out", out)
    assert ended.returncode == 0, ended.stderr
    cells, sources = remembered_lineup(out / "results.sqlite")
    cases = {name: load_case(source) for name, source in sources.items()}
    with Store(out / "results.sqlite", write=False) as store:
        results = stored_results(store, cells, cases)
    assert len(results) == kept
    finished = {result.cell.case for result in results}
    assert {path.stem for path in (out / "recordings").iterdir()} == finished
    for name in finished:
        path = out / "recordings" / f"{name}.rrd"
        with private_environment() as (program, environment):
            assert subprocess.run([program, "rrd", "verify", str(path)], env=environment, check=False).returncode == 0
        own = [result for result in results if result.cell.case == name]
        for one in gather(summarise_case(cases[name], own), 250).shown:
            times, values = series(path, entity("q", "joint 1", one.label))
            np.testing.assert_array_equal(values[:, 0], one.motion(times * NANOSECOND)[:, 0])
