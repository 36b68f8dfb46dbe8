"""Recordings read back and compared value for value with the motions they show."""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader

from study.analysis.case_summary import summarise_case
from study.cases.library import Case, load_case
from study.curves import curve_named
from study.errors import StudyError
from study.problem import Floats, JointLimits, Problem
from study.recording import APPLICATION, case_recording, record_case, scene
from study.recording.contents import NANOSECOND, gather, sample_times
from study.recording.process import private_environment
from study.recording.signals import lane_path
from study.recording.stream import entity, method_part
from study.recording.summary import markdown, plain
from study.robots import robot_named
from tests.helpers.recordings import chunks, columns, on_curve, result, series, some_results, stepping

HOSTILE = ("pso:scaled,shared", "we/ird né `|` #1 <b>", "a\\:b", "a:b", "_limit", "../up", "__properties")


@pytest.fixture(scope="module")
def woodworking() -> Case:
    return load_case("woodworking")


@pytest.fixture(scope="module")
def recorded(woodworking: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record_case(
        summarise_case(woodworking, some_results(woodworking)), tmp_path_factory.mktemp("rrd") / "woodworking.rrd"
    )


@pytest.mark.parametrize("name", ["woodworking", "ur5-bspline", "ur5-helix"])
def test_every_signal_is_the_motion_itself(name: str, tmp_path: Path) -> None:
    case = load_case(name)
    results = some_results(case)
    path = record_case(summarise_case(case, results), tmp_path / "a.rrd", samples=40)
    shown = {one.label: one.motion for one in gather(summarise_case(case, results), 40).shown}
    assert {"pso:scaled,shared", "hasty", "steps"} < shown.keys()
    for label, motion in shown.items():
        for order, signal in enumerate(("q", "v", "a", "jerk")):
            for joint, joint_name in enumerate(case.problem.joint_names):
                times, values = series(path, entity(signal, joint_name, label))
                expected = motion(times * NANOSECOND, order)[:, joint]
                np.testing.assert_array_equal(values[:, 0], expected)  # float64, bit for bit
                peak = motion.extrema(order).peak[joint]
                assert np.abs(values).max() == pytest.approx(peak, rel=1e-6, abs=1e-9)


def test_samples_hold_the_ends_the_peaks_and_both_sides_of_every_knot(woodworking: Case) -> None:
    motion = stepping(woodworking)
    times = sample_times(motion, 50)
    assert times[0] == 0
    assert motion.duration - 2 * NANOSECOND < times[-1] * NANOSECOND <= motion.duration
    assert len(times) == len(np.unique(times)) >= 50
    for knot in motion.knots[1:-1]:
        before, after = (
            motion(t * NANOSECOND, 1)[0]
            for t in (times[times * NANOSECOND < knot][-1], times[times * NANOSECOND > knot][0])
        )
        jump = motion.jumps(1)[list(motion.knots[1:-1]).index(knot)]
        np.testing.assert_allclose(after - before, jump, atol=1e-12)


def test_limit_lines_reach_over_the_longest_motion(recorded: Path, woodworking: Case) -> None:
    longest = gather(summarise_case(woodworking, some_results(woodworking)), 250).longest
    for signal, limit in (("v", woodworking.problem.limits.velocity), ("a", woodworking.problem.limits.acceleration)):
        for joint, name in enumerate(woodworking.problem.joint_names):
            times, values = series(recorded, entity(signal, name, "_limit"))
            assert times[0] == 0
            assert longest <= times[1] * NANOSECOND < longest + 2 * NANOSECOND
            np.testing.assert_array_equal(values, [[limit[joint], -limit[joint]]] * 2)
    paths = RrdReader(str(recorded)).store().schema().entity_paths()
    assert not [path for path in paths if path.startswith("/jerk/") and "_limit" in path]  # there is no such limit


def test_marks_stand_only_where_a_limit_is_used_up(recorded: Path, woodworking: Case) -> None:
    marked = [p for p in RrdReader(str(recorded)).store().schema().entity_paths() if p.endswith("/saturated")]
    assert marked
    rates = dict(zip(("v", "a"), woodworking.problem.limits.rates, strict=False))
    for path in marked:
        signal, joint = path.split("/")[1], int(path.split("\\ ")[1].split("/")[0]) - 1
        _, values = series(recorded, path)
        assert (np.abs(values) >= 0.9989 * rates[signal][joint]).all()


def test_the_most_used_limit_of_a_stretched_candidate_is_marked_and_stands_in_its_lane(
    recorded: Path, woodworking: Case
) -> None:
    row = next(
        e
        for e in gather(summarise_case(woodworking, some_results(woodworking)), 250).methods
        if e.label == "pso:scaled,shared"
    )
    verdict = row.representative.verdict if row.representative else None
    assert verdict is not None
    order, joint = np.unravel_index(verdict.ratios.argmax(), verdict.ratios.shape)
    name = woodworking.problem.joint_names[joint]
    times, _ = series(recorded, entity(("v", "a", "jerk")[order], name, row.label, "saturated"))
    assert np.abs(times * NANOSECOND - verdict.times[order, joint]).min() < 0.1
    contents = gather(summarise_case(woodworking, some_results(woodworking)), 250)
    each = next(one for one in contents.shown if one.label == row.label)
    where = lane_path(contents, ("velocity", "acceleration", "jerk")[order], each)
    assert re.fullmatch(r"/?\w+/\d\d_pso_scaled_shared", where)
    (batch,) = chunks(recorded, where, "StateChange:state")
    changes = batch.column("t").cast(pa.int64()).to_numpy() * NANOSECOND
    states = [state[0] for state in batch.column("StateChange:state").to_pylist()]
    assert states[-1] == ""
    assert name in states[np.searchsorted(changes, verdict.times[order, joint], side="right") - 1]


def test_the_arm_stands_where_forward_kinematics_puts_it(recorded: Path, woodworking: Case) -> None:
    robot = robot_named(str(woodworking.robot))
    one = next(
        o for o in gather(summarise_case(woodworking, some_results(woodworking)), 250).shown if o.label == "steps"
    )
    (batch,) = chunks(recorded, entity("arms", "steps", "links"), "Capsules3D:lengths")
    times = batch.column("t").cast(pa.int64()).to_numpy()
    origins = robot.frames(woodworking.robot_configuration(one.motion(times * NANOSECOND)))[:, :, :3, 3]
    lengths = batch.column("Capsules3D:lengths").flatten().to_numpy().reshape(len(times), -1)
    (batch,) = chunks(recorded, entity("arms", "steps", "links"), "Capsules3D:translations")
    starts = batch.column("Capsules3D:translations").flatten().flatten().to_numpy()
    (batch,) = chunks(recorded, entity("arms", "steps", "links"), "Capsules3D:quaternions")
    turns = batch.column("Capsules3D:quaternions").flatten().flatten().to_numpy()
    starts, turns = starts.reshape(*lengths.shape, 3), turns.reshape(*lengths.shape, 4)
    x, y, z, w = np.moveaxis(turns, -1, 0)
    along = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=-1)
    kept = np.linalg.norm(np.diff(origins, axis=1), axis=2).max(axis=0) > 1e-6
    np.testing.assert_allclose(starts, origins[:, :-1][:, kept], atol=2e-6)
    np.testing.assert_allclose(starts + lengths[..., None] * along, origins[:, 1:][:, kept], atol=2e-6)


def test_waypoints_are_labelled_points_on_the_tool_path(recorded: Path, woodworking: Case) -> None:
    (batch,) = chunks(recorded, entity("arms", "steps", "waypoints"), "Points3D:positions")
    places = np.array(batch.column("Points3D:positions").to_pylist()[0])
    frames = robot_named(str(woodworking.robot)).frames(woodworking.robot_configuration(woodworking.problem.waypoints))
    np.testing.assert_allclose(places, frames[:, -1, :3, 3], atol=1e-6)
    (labels,) = chunks(recorded, entity("arms", "steps", "waypoints"), "Points3D:labels")
    assert labels.column("Points3D:labels").to_pylist()[0] == ["1", "2, 4", "3", ""]  # the end is where the second is


def test_convergence_is_the_history_without_what_is_infinite(recorded: Path, woodworking: Case) -> None:
    contents = gather(summarise_case(woodworking, some_results(woodworking)), 250)
    run = next(e.representative for e in contents.methods if e.label == "pso:scaled,shared")
    assert run is not None
    counts, values = series(recorded, entity("convergence", "value", "pso:scaled,shared"), "evaluation")
    np.testing.assert_array_equal(counts, [20, 30, 50])
    np.testing.assert_array_equal(values[:, 0], run.history[1:, 1])
    _, gaps = series(recorded, entity("convergence", "gap", "pso:scaled,shared"), "evaluation")
    np.testing.assert_allclose(10 ** gaps[:, 0], np.maximum(run.history[1:, 1] / contents.best - 1, 1e-6), rtol=1e-12)


def test_the_summary_hides_nothing_and_names_the_reason(recorded: Path) -> None:
    (batch,) = chunks(recorded, "/summary", "TextDocument:text")
    text = batch.column("TextDocument:text").to_pylist()[0][0]
    rows = {line.split("|")[1].strip(): line for line in text.splitlines() if line.startswith("| ")}
    assert "**infeasible**" in rows["hasty"]
    assert "no motion" in rows["helpless"]
    assert "gave \\| up" in text
    assert "| feasible |" in rows["pso:scaled,shared"]
    order = list(rows)
    assert order.index("pso:scaled,shared") < order.index("hasty")


def test_schema_identity_and_layout(recorded: Path, woodworking: Case) -> None:
    reader = RrdReader(str(recorded))
    (entry,) = reader.recordings()
    assert (entry.application_id, entry.recording_id) == (APPLICATION, "woodworking")
    schema = reader.store().schema()
    assert {column.name for column in schema.index_columns()} == {"t", "evaluation"}  # no wall clock
    paths = set(schema.entity_paths())
    everything = {chunk.entity_path for chunk in reader.stream().to_chunks()}
    assert {"/__properties/case", "/__properties/study"} <= everything
    assert {"/summary", "/q/joint\\ 1/pso\\:scaled\\,shared"} <= paths
    (blueprint,) = reader.blueprints()
    layout = {c.entity_path.split("/")[1] for c in reader.stream(store=blueprint).to_chunks()}
    assert {"viewport", "time_panel", "view", "container"} <= layout


def test_verify_passes_and_the_file_is_small(recorded: Path) -> None:
    with private_environment() as (program, environment):
        subprocess.run([program, "rrd", "verify", str(recorded)], env=environment, check=True, capture_output=True)
    assert recorded.stat().st_size < 3e6


def test_the_layout_stands_before_the_data(recorded: Path) -> None:
    with private_environment() as (program, environment):
        printed = subprocess.run(
            [program, "rrd", "print", str(recorded)], env=environment, check=True, capture_output=True, text=True
        ).stdout
    assert printed.index(" - /viewport - ") < min(printed.index(f" - /{part}") for part in ("summary", "q/", "arms/"))


def test_twenty_methods_of_six_joints_stay_under_the_size_limit(tmp_path: Path) -> None:
    case = load_case("puma560")
    durations = np.random.default_rng(1).uniform(0.5, 1.5, size=(20, case.problem.n_segments))
    results = [result(case, f"method {k}", on_curve(case, d)) for k, d in enumerate(durations)]
    assert record_case(summarise_case(case, results), tmp_path / "a.rrd").stat().st_size < 25e6


def test_same_results_give_the_same_columns_in_any_order(woodworking: Case, recorded: Path, tmp_path: Path) -> None:
    again = record_case(summarise_case(woodworking, some_results(woodworking)[::-1]), tmp_path / "again.rrd")
    assert columns(again) == columns(recorded)


def test_hostile_names_stay_apart_and_readable(tmp_path: Path, woodworking: Case) -> None:
    case = replace(woodworking, name="../c:a/s,e é\n", title="# <script>|`x`", published=(), robot=None)
    motion = on_curve(case, np.ones(3))
    durations = [1.0 + 0.1 * k for k in range(len(HOSTILE))]
    results = [result(case, label, motion.scaled(k)) for label, k in zip(HOSTILE, durations, strict=True)]
    path = record_case(summarise_case(case, results), tmp_path / "a.rrd")
    assert RrdReader(str(path)).recordings()[0].recording_id == case.name
    for label, factor in zip(HOSTILE, durations, strict=True):
        times, _ = series(path, entity("q", "joint 1", method_part(label)))
        assert times[-1] * NANOSECOND == pytest.approx(motion.duration * factor, abs=1e-8)
    assert "we/ird né \\`\\|\\` \\#1 \\<b\\>" in markdown(gather(summarise_case(case, results), 5))


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="open sockets are listed only on Linux")
def test_recording_opens_no_socket(woodworking: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def sockets() -> set[str]:
        links = [Path(f"/proc/self/fd/{fd}") for fd in os.listdir("/proc/self/fd")]
        return {target for link in links if link.is_symlink() and (target := os.readlink(link)).startswith("socket:")}

    seen: list[set[str]] = []
    real = case_recording.log_scene
    monkeypatch.setattr(case_recording, "log_scene", lambda *a: seen.append(sockets()) or real(*a))
    before = sockets()
    record_case(summarise_case(woodworking, some_results(woodworking)), tmp_path / "a.rrd")
    assert seen == [before]
    assert sockets() == before


def test_a_failure_leaves_the_old_recording_and_no_litter(
    woodworking: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = record_case(summarise_case(woodworking, some_results(woodworking)), tmp_path / "a.rrd", samples=5)
    before = path.read_bytes()

    def broken(stream: Any, *rest: Any) -> None:
        import rerun as rr

        stream.log("x", rr.Points3D(np.zeros((2, 7))))  # a wrong shape: strict mode raises, lenient mode would go on

    monkeypatch.setattr(case_recording, "log_scene", broken)
    with pytest.raises(ValueError, match=r"\S"):
        record_case(summarise_case(woodworking, some_results(woodworking)), path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.rrd"]


def test_errors_are_sentences(woodworking: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(StudyError, match=r"no results; run the case first"):
        record_case(summarise_case(replace(woodworking, published=()), []), tmp_path / "a.rrd")
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match=r"cannot write"):
        record_case(summarise_case(woodworking, some_results(woodworking)), tmp_path / "file" / "a.rrd")
    monkeypatch.setenv("RERUN", "off")
    with pytest.raises(StudyError, match=r"unset the environment variable RERUN"):
        record_case(summarise_case(woodworking, some_results(woodworking)), tmp_path / "a.rrd")


@pytest.mark.parametrize("name", ["woodworking", "ur5-bspline", "puma560"])
def test_tool_paths_stand_large_in_the_first_look_and_whole_arms_fill_the_view_of_all(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = load_case(name)
    seen: list[tuple[Any, Any]] = []
    looking = scene._looking

    def noted(arms: Any, obstacles: Floats, at_path: bool = False) -> Any:
        seen.append((looking(arms, obstacles, at_path), arms))
        return seen[-1][0]

    monkeypatch.setattr(scene, "_looking", noted)
    record_case(summarise_case(case, some_results(case)), tmp_path / "a.rrd", samples=20)
    ((far, _), every), ((near, _), first) = seen
    near = min(near, far, key=lambda look: np.linalg.norm(look.eye - look.target))
    whole = np.concatenate([arm.chain.reshape(-1, 3) for arm in every])
    assert used_of_the_view(far, whole).max() == pytest.approx(1.0)
    paths = np.concatenate([arm.chain[:, -1] for arm in first])
    shown = used_of_the_view(near, paths).max()
    assert 0.2 < shown < 1.0 + 1e-9


def used_of_the_view(look: Any, points: Floats) -> Floats:
    """Largest shares of half the view's width and height that points take."""
    eye, target = look.eye, look.target
    back = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    depth = (eye - points) @ back
    shares = np.abs(np.stack([(points - eye) @ right, (points - eye) @ np.cross(back, right)])) / depth
    assert depth.min() > 0
    return np.asarray(shares.max(axis=1) / scene.VIEW)


def test_waypoints_that_lie_together_share_a_label() -> None:
    places = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0.01, 0], [1, 0.5, 0]])
    assert scene._labels(places, 0.1) == ["1, 3", "2", "", "4"]


def names_in_layout(path: Path) -> set[str]:
    reader = RrdReader(str(path))
    (blueprint,) = reader.blueprints()
    found = set()
    for chunk in reader.stream(store=blueprint).to_chunks():
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if name.endswith(":display_name"):
                found |= {text for (text,) in batch.column(name).to_pylist()}
    return found


def test_few_methods_stand_in_front_and_all_of_them_a_click_away(tmp_path: Path) -> None:
    case = load_case("puma560")
    shares = np.random.default_rng(1).uniform(0.5, 1.5, size=(12, case.problem.n_segments))
    results = [result(case, f"method {k}", on_curve(case, d)) for k, d in enumerate(shares)]
    summary = summarise_case(case, results)
    contents = gather(summary, 20)
    assert len(contents.first_look) == 6
    assert len(contents.compared) <= 6 < len(contents.shown)
    path = record_case(summary, tmp_path / "a.rrd", samples=20)
    wanted = {f"{len(contents.compared)} featured methods", f"All {len(contents.shown)} methods", "Position", "Jerk"}
    assert wanted <= names_in_layout(path)


def test_a_case_without_an_arm_says_how_to_give_one(woodworking: Case, tmp_path: Path) -> None:
    case = replace(woodworking, robot=None)
    path = record_case(summarise_case(case, some_results(case)), tmp_path / "a.rrd", samples=20)
    (batch,) = chunks(path, "/no_arm", "TextDocument:text")
    assert "`robot: arm.urdf`" in batch.column("TextDocument:text").to_pylist()[0][0]
    assert "No arm" in names_in_layout(path)


def test_markdown_is_made_harmless() -> None:
    assert plain("a|b\n`c` <i>") == "a\\|b \\`c\\` \\<i\\>"


def test_a_case_with_one_limit_and_no_robot_still_records(woodworking: Case, tmp_path: Path) -> None:
    problem = Problem("free", woodworking.problem.waypoints, JointLimits([np.inf, 5.0, np.inf, np.inf]))
    case = replace(woodworking, name="free", problem=problem, robot=None, published=())
    motion = curve_named(case.curve).motion(problem.waypoints, np.ones(3))
    path = record_case(summarise_case(case, [result(case, "only", motion)]), tmp_path / "a.rrd", samples=5)
    paths = RrdReader(str(path)).store().schema().entity_paths()
    assert [p for p in paths if "_limit" in p] == ["/v/joint\\ 2/_limit"]
    assert not [p for p in paths if p.startswith("/arms")]
