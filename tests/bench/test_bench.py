"""The bench: its yardsticks against the exact kernels, its arithmetic, its files, and counted work instead of clocks."""

from __future__ import annotations

import sys
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

from study import engine
from study.analysis.formatting import wall
from study.bench import growth, papers_way, searches, wording
from study.bench.growth import Point, peak_bytes
from study.bench.kernels import peaks_call, sample
from study.bench.measuring import Measurement, interleaved, unmet
from study.bench.page import write_page
from study.bench.run import Bench, read, write
from study.curves import CURVES
from study.errors import StudyError
from study.planners.other_searches import PSO_STANDARD
from study.planning import Meter
from study.problem import Floats
from study.search.loop import minimise
from study.search.state import Box

ROWS = (
    Measurement("Kernels", "3-5-3", "the papers' way", "candidate", (1e-6, 2e-6, 1e-6), (3e-3, 3e-3, 1e-3), 2000.0),
    Measurement("Kernels", "spline", "the papers' way", "candidate", (1e-6,), (5e-4,), 700.0),
    Measurement("End to end", "PSO", "mealpy", "", target=20.0, missing="mealpy is not installed"),
    Measurement("Search overhead", "pso", "", "evaluation", (5e-7, 6e-7), most=1e-6),
)
POINTS = tuple(
    Point(axis, curve, by, size, (1e-6 * size, 2e-6 * size), 1000 * size)
    for axis in ("waypoints", "joints", "population")
    for curve in ("poly353", "bspline")
    for by in ("numpy", "numba")
    for size in (5, 10)
)
BENCH = Bench({"Python": "3"}, True, {"poly353": 0.5}, ROWS, POINTS, 2**28)


def test_the_papers_way_approaches_the_exact_peaks_from_below() -> None:
    waypoints, durations = sample(4, 3, 6)
    for row in durations:
        exact = CURVES["poly353"].peaks(waypoints, row[None], (1, 2))[0]
        sampled = papers_way.peaks_353(waypoints, row)
        assert (sampled <= exact * (1 + 1e-9)).all()
        np.testing.assert_allclose(sampled, exact, rtol=5e-3)


def test_the_library_spline_approaches_the_exact_peaks_from_below() -> None:
    waypoints, durations = sample(8, 2, 3)
    for row in durations:
        exact = CURVES["cubic-spline"].peaks(waypoints, row[None])[0]
        sampled = papers_way.peaks_spline(waypoints, row)
        assert (sampled <= exact * (1 + 1e-9)).all()
        np.testing.assert_allclose(sampled, exact, rtol=5e-3)


def test_ratios_are_peers_by_ours_and_judged_by_their_median() -> None:
    assert ROWS[0].ratios == pytest.approx((3000, 1500, 1000))
    assert ROWS[0].middle == pytest.approx(1500)
    assert [row.met for row in ROWS] == [False, False, None, True]
    assert unmet(ROWS) == list(ROWS[:2])


def test_calls_take_turns() -> None:
    order: list[str] = []

    def call(name: str, loops: int) -> None:
        order.append(name)
        sum(range(loops))

    taken = interleaved({"a": lambda: call("a", 3_000_000), "b": lambda: call("b", 3_000_000)}, 3, {"a": 1, "b": 10})
    assert order[-6:] == ["a", "b"] * 3
    assert len(taken["a"]) == len(taken["b"]) == 3
    assert min(taken["a"]) > max(taken["b"])  # ten units in the same time


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    write(BENCH, tmp_path / "new" / "bench.json")
    assert read(tmp_path / "new" / "bench.json") == BENCH


@pytest.mark.parametrize("text", ["", "[]", '{"version": 1}', '{"version": 99}'])
def test_refuses_what_is_no_bench(tmp_path: Path, text: str) -> None:
    (tmp_path / "bench.json").write_text(text)
    with pytest.raises(StudyError, match="bench"):
        read(tmp_path / "bench.json")
    with pytest.raises(StudyError, match="does not exist"):
        read(tmp_path / "none.json")


def test_sentences_say_what_is_not_met() -> None:
    texts = wording.summary(BENCH)
    assert texts[0] == "1 of 3 targets are met."
    assert texts[1] == "Not met: kernels, 3-5-3 against the papers' way: 1500, target at least 2000."
    assert "Not measured: PSO: mealpy is not installed." in texts
    assert wall(4.56e-7) == "456 ns"


def test_page_is_made_from_the_record(tmp_path: Path) -> None:
    write(BENCH, tmp_path / "bench.json")
    text = write_page(tmp_path / "bench.json", tmp_path / "report").read_text()
    assert "1 of 3 targets are met." in text
    assert "not met" in text
    assert "<svg" in text
    assert "http://" not in text.replace("http://www.w3.org", "")


def counted(call_sizes: list[int]) -> Meter:
    def objective(x: Floats) -> Floats:
        call_sizes.append(len(x))
        return (x**2).sum(axis=1)

    return Meter(objective, 1000)


def test_a_search_calls_its_objective_once_for_each_generation() -> None:
    sizes: list[int] = []
    minimise(PSO_STANDARD.search, counted(sizes), Box(-np.ones(5), np.ones(5)), 50, np.random.default_rng(0))
    assert sizes == [50] * 20


def lines_run(search: str, population: int, monkeypatch: pytest.MonkeyPatch) -> int:
    """How many lines of Python a search runs for ten generations."""
    seen = 0

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal seen
        seen += event == "line"
        return trace

    monkeypatch.setattr(searches, "POPULATION", population)
    monkeypatch.setenv(engine.VARIABLE, engine.NUMPY)  # compiled steps would hide what they stand for
    call, before = searches.ours(search, generations=10), sys.gettrace()
    sys.settrace(trace)
    try:
        call()
    finally:
        sys.settrace(before)
    return seen


WALKING = {"gold-sa", "golds-pso", "chaotic-spso"}
"""Searches that step through their candidates: golden sections after every evaluation, a chaotic map once at the start."""


@pytest.mark.parametrize("search", [name for name in searches.SEARCHES if name not in WALKING])
def test_no_search_loops_over_its_candidates(search: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Counted work: a population four times as large runs as many lines; GSA goes through its pullers 32 at a time."""
    few, many = (lines_run(search, population, monkeypatch) for population in (20, 80))
    assert many < (1.5 if search == "gsa" else 1.1) * few


@pytest.mark.parametrize(("curve", "arrays"), [("poly353", 60), ("cubic-spline", 10), ("bspline", 50)])
def test_numpy_kernels_hold_few_temporaries(curve: str, arrays: int) -> None:
    """Most memory of one call, in arrays of the size that the kernel works on: it must not grow unseen."""
    n_waypoints, n_joints = (4, 6) if curve == "poly353" else (20, 5)
    waypoints, durations = sample(n_waypoints, n_joints, 400)
    one = 8 * 400 * n_joints * (1 if curve == "poly353" else n_waypoints - 1)
    assert peak_bytes(peaks_call(curve, engine.NUMPY, waypoints, durations, (1, 2))) < arrays * one


@pytest.mark.parametrize("curve", ["poly353", "cubic-spline", "bspline"])
def test_compiled_kernels_allocate_their_result_only(curve: str) -> None:
    pytest.importorskip("numba")
    waypoints, durations = sample(4, 6, 400)
    call = peaks_call(curve, engine.NUMBA, waypoints, durations, (1, 2))
    assert peak_bytes(call) < 3 * 6 * 400 * 8 + 2 * durations.nbytes + 8192


def test_growth_covers_what_it_promises() -> None:
    sizes = list(growth._sizes())
    assert {size for axis, size, *_ in sizes if axis == "waypoints"} >= {5, 200}
    assert {size for axis, size, *_ in sizes if axis == "joints"} >= {1, 14}
    assert {size for axis, size, *_ in sizes if axis == "population"} >= {10, 100_000}
