"""Cost of the report and of a recording of one case."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path

from study.analysis.case_summary import summarise
from study.bench.measuring import Measurement, interleaved
from study.cases.library import load_case
from study.runs.environment import environment
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells

TOPIC = "Report and recording"
CASE = "woodworking"
PLANNERS = ("pso", "golds-pso", "casadi-nlp", "ruckig-stops")


def output_rows(repetitions: int) -> list[Measurement]:
    """Write the report and the recording of a small run, again and again, into a folder that is then removed."""
    from study.recording import record_case
    from study.report.page import build_report  # here: plotting and recording are slow to import

    case = load_case(CASE)
    cells = make_cells([case], [Spec(name) for name in PLANNERS], Budget(seeds=2, evaluations=500))
    results = [CellJob(cell, case.problem).run() for cell in cells]
    summaries = summarise({case.name: case}, results)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        calls = {
            "report": partial(build_report, summaries, out / "report", environment()),
            "recording": partial(record_case, summaries[0], out / "case.rrd"),
        }
        taken = interleaved(calls, repetitions, dict.fromkeys(calls, 1))
    return [
        Measurement(TOPIC, f"{name} of {CASE}, {len(results)} runs", "", name, seconds)
        for name, seconds in taken.items()
    ]
