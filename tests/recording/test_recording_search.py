"""What recordings show of searches, read back: populations, wall times; and distances to obstacles."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from study.analysis.case_summary import summarise_case
from study.analysis.replay import replayed
from study.cases.library import Case, load_case
from study.cases.obstacles import world_of
from study.pathfinding.world import arm_clearance
from study.recording import record_case
from study.recording.contents import NANOSECOND, gather
from study.recording.stream import entity
from study.recording.summary import history, wall_times
from study.recording.swarm import swarms_of
from study.robots import robot_named
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells
from study.store.results import Result
from tests.helpers.recordings import chunks, columns, series


def run(case: Case, *specs: Spec, seeds: int = 1) -> list[Result]:
    cells = make_cells([case], specs, Budget(seeds=seeds, evaluations=150))
    return [CellJob(cell, case.problem).run() for cell in cells]


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("woodworking")


@pytest.fixture(scope="module")
def results(case: Case) -> list[Result]:
    return run(case, Spec("golds-pso"), Spec("pso", "scaled", "shared"), Spec("casadi-nlp"))


def test_a_search_is_replayed_to_the_last_bit(case: Case, results: list[Result]) -> None:
    by_label = {one.cell.label: one for one in results}
    together = replayed(case, by_label["pso:scaled,shared"])
    alone = replayed(case, by_label["golds-pso"])
    assert together is not None
    assert alone is not None
    assert together.parts == ("",)
    assert alone.parts == tuple(case.problem.joint_names)
    counts, best = by_label["pso:scaled,shared"].history.T
    sizes = [len(one) for one in together.populations[0]]
    assert np.cumsum(sizes)[-1] >= counts[-1]
    incumbents = np.minimum.accumulate([values.min() for values in together.values[0]])
    np.testing.assert_array_equal(incumbents, best)
    ends = [alone.best(part, alone.generations - 1) for part in range(len(alone.parts))]
    np.testing.assert_array_equal(np.max(ends, axis=0), by_label["golds-pso"].durations)


def test_what_cannot_be_replayed_is_left_out(case: Case, results: list[Result]) -> None:
    search, other = results[0], next(one for one in results if one.cell.planner == "casadi-nlp")
    assert replayed(case, other) is None  # no populations
    assert search.durations is not None
    moved = replace(search, durations=np.nextafter(search.durations, np.inf))
    assert replayed(case, moved) is None  # another search than the one that is stored
    gone = replace(search, cell=replace(search.cell, planner="uninstalled"))
    assert replayed(case, gone) is None


def test_populations_are_drawn_where_they_were(case: Case, results: list[Result], tmp_path: Path) -> None:
    path = record_case(summarise_case(case, results), tmp_path / "a.rrd", samples=20)
    (swarm, _) = swarms_of(gather(summarise_case(case, results), 20))
    (batch,) = chunks(path, entity("population", swarm.shown.label, "0"), "Points2D:positions")
    generations = batch.column("generation").to_numpy() - 1
    assert generations[0] == 0
    assert generations[-1] == swarm.replay.generations - 1
    low, high = np.log10(case.problem.duration_bounds)
    positions = batch.column("Points2D:positions")
    for row, generation in enumerate(generations):
        drawn = np.array(positions[row].as_py())
        share = 1.0 - drawn[:, 1] / 300.0
        durations = 10.0 ** (low + share * (high - low))
        expected = swarm.replay.at(0, int(generation)).ravel()
        np.testing.assert_allclose(durations, expected, rtol=1e-5)


def test_the_same_results_give_the_same_populations(case: Case, results: list[Result], tmp_path: Path) -> None:
    first, second = (
        columns(record_case(summarise_case(case, results), tmp_path / f"{k}.rrd", samples=20)) for k in range(2)
    )
    population = {key for key in first if key[0].startswith(("/population", "/swarm"))}
    assert len(population) > 20
    assert all(first[key] == second[key] for key in population)


def test_wall_times_of_a_history_end_with_the_run(case: Case, results: list[Result]) -> None:
    shown = {one.label: one for one in gather(summarise_case(case, results), 20).shown}
    entry = shown["pso:scaled,shared"].method
    times, (counts, _) = wall_times(entry), history(entry)
    run_of = entry.representative
    assert run_of is not None
    assert times[-1] == pytest.approx(run_of.wall_time)
    np.testing.assert_allclose(times / times[-1], counts / counts[-1])


def test_distances_to_obstacles_and_collisions(results: list[Result], tmp_path: Path) -> None:
    case = load_case("woodworking")
    assert case.robot is not None
    robot = robot_named(case.robot, tuple(case.problem.joint_names))
    tool = robot.frames(case.robot_configuration(case.problem.waypoints))[1, -1, :3, 3]
    case = replace(case, obstacles=np.array([[tool - 0.01, tool + 0.01]]), arm_radius=0.02)
    path = record_case(summarise_case(case, results), tmp_path / "a.rrd", samples=30)
    one = gather(summarise_case(case, results), 30).shown[0]
    times, values = series(path, entity("clearance", one.label))
    chain = robot.frames(case.robot_configuration(one.motion(times * NANOSECOND)))[:, :, :3, 3]
    np.testing.assert_array_equal(values[:, 0], arm_clearance(world_of(case), chain, case.arm_radius))
    assert values.min() < 0
    (hits,) = chunks(path, entity("arms", one.label, "collisions"), "Points3D:positions")
    drawn = hits.column("Points3D:positions").flatten().flatten().to_numpy().reshape(-1, 3)
    np.testing.assert_allclose(drawn, chain[values[:, 0] < 0, -1], atol=1e-6)
    (boxes,) = chunks(path, "/arms/_obstacles", "Boxes3D:half_sizes")
    np.testing.assert_allclose(pa.array(boxes.column("Boxes3D:half_sizes")[0].as_py()).to_pylist()[0], [0.01] * 3, 1e-5)
