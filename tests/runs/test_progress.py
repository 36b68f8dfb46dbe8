"""Searches that are watched while they run: what they report is true, and watching changes nothing."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from study.cases.library import Case
from study.registry import planner_named
from study.runs import progress
from study.runs.execute import CellJob, cell_jobs
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.pool import Overdue, WorkerPool
from study.runs.progress import Progress, reporter
from study.runs.runner import RunOptions, run_jobs
from study.store.results import Cell
from study.store.store import Store
from study.supervisor import supervised, supervisor


def cells_of(case: Case, specs: str, seeds: int = 1, evaluations: int = 120) -> list[Cell]:
    return make_cells([case], parse_specs(specs), Budget(seeds=seeds, evaluations=evaluations))


@pytest.mark.parametrize("spec", ["pso:scaled,shared", "pso:penalty,shared", "golds-pso:scaled,per-joint", "lbfgsb"])
def test_reports_agree_with_the_history_that_the_search_hands_in(
    tiny_case: Case, spec: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "PERIOD", 0.0)
    (cell,) = cells_of(tiny_case, spec)
    said: list[Progress] = []
    with supervised(reporter(said.append)):
        plan = planner_named(cell.planner).plan(tiny_case.problem, cell.settings)
    assert supervisor() is None
    counts = [one.evaluations for one in said]
    assert counts == sorted(counts)
    assert counts[-1] == plan.evaluations
    assert plan.durations is not None
    np.testing.assert_array_equal(said[-1].durations, plan.durations)
    parts = tiny_case.problem.n_joints if cell.settings.synchronisation == "per-joint" else 1
    assert len(said[-1].candidates) == parts
    assert all(one.shape[1] == tiny_case.problem.n_segments for one in said[-1].candidates)
    if cell.settings.formulation == "scaled" and parts == 1:
        best = dict(plan.history)
        assert [one.durations.sum() for one in said] == pytest.approx([best[count] for count in counts])


def test_a_search_that_nobody_watches_reports_nothing(tiny_case: Case) -> None:
    (cell,) = cells_of(tiny_case, "pso")
    assert supervisor() is None
    assert CellJob(cell, tiny_case.problem).run().verdict is not None
    assert supervisor() is None


@pytest.mark.timeout(90)
def test_watching_a_run_changes_no_result(tiny_case: Case, tmp_path: Path) -> None:
    cells = cells_of(tiny_case, "pso,golds-pso:scaled,shared", seeds=2)
    said: list[tuple[Cell, Progress]] = []
    digests = []
    for name, told in (("alone", None), ("watched", lambda job, report: said.append((job.cell, report)))):
        with Store(tmp_path / f"{name}.sqlite") as store:
            run_jobs(cell_jobs(cells, {"tiny": tiny_case}), store, workers=2, options=RunOptions(on_progress=told))
            digests.append(store.digest())
    assert digests[0] == digests[1]
    assert {cell for cell, _ in said} == set(cells)  # each search reports its first population at once
    assert all(report.evaluations > 0 and report.durations.sum() > 0 for _, report in said)


def talk(seconds: float, pause: float) -> str:
    """Say how often one has spoken, again and again."""
    say, end = supervisor().tell, time.monotonic() + seconds
    spoken = 0
    while say is not None and time.monotonic() < end:
        say(spoken)
        spoken += 1
        time.sleep(pause)
    return "done"


@pytest.mark.timeout(60)
def test_what_a_worker_says_arrives_in_order_and_buys_no_time() -> None:
    heard: list[tuple[int, float]] = []
    with WorkerPool(
        1,
        lambda seconds, _: 40.0 if seconds < 1 else 2.0,
        hear=lambda said, seconds, pause: heard.append((said, seconds)),
    ) as pool:
        assert pool.submit(talk, 0.3, 0.01).result() == "done"
        assert [said for said, _ in heard] == list(range(len(heard)))
        assert len(heard) > 2
        with pytest.raises(Overdue):
            pool.submit(talk, 30.0, 0.05).result()
    assert heard[-1][1] == 30.0
