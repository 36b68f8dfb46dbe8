"""Clearance of an arm that moves: proved between instants, from obstacles and from itself."""

from dataclasses import replace
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from study import EndCondition, JointLimits, Problem, Trajectory, judge, plan
from study.analysis.case_summary import summarise_case
from study.cases import obstacles
from study.cases.library import load_case
from study.cases.obstacles import DRIVEN, UNFOLLOWED, may_be_driven, nearest, said_of
from study.cli.check import report_verdict
from study.cli.run_tables import reasons
from study.pathfinding.world import segment_distances
from study.planning import RunSettings
from study.recording.contents import Contents
from study.recording.summary import _winner, markdown, plain
from study.report.tables import RESULTS, records
from study.robots import robot_named
from study.runs.execute import CellJob
from study.store.results import Cell


@pytest.fixture
def arm(make_case):
    """The UR5 turning its base by a third of a turn at one radian per second."""
    start = np.array([0.0, -1.0, 1.0, 0.3, 0.2, 0.1])
    points = start + np.array([[0.0], [2.0]]) * np.eye(6)[0]
    problem = Problem("arm", points, JointLimits(np.full(6, 1.2)), EndCondition.FREE)
    return replace(make_case(problem), robot="ur5", arm_radius=0.04)


def turning(case):
    step = np.diff(case.problem.waypoints, axis=0)[0] / 2.0
    return Trajectory(np.array([0.0, 2.0]), np.stack([case.problem.waypoints[0], step])[None], np.array([0.0, 2.0]))


def flange(case, time):
    return robot_named("ur5").frames(turning(case)(time))[0, -1, :3, 3]


def thin_wall(case, time, size=1e-4):
    """A box of a tenth of a millimetre where the flange is at a time."""
    place = flange(case, time)
    return replace(case, obstacles=np.array([[place - size / 2, place + size / 2]]))


@pytest.mark.parametrize("time", np.linspace(0.1, 1.9, 7) + 0.00123)
def test_a_hit_between_instants_is_found(arm, time, monkeypatch):
    monkeypatch.setattr(obstacles, "INSTANTS", 5)
    found = nearest(replace(thin_wall(arm, time), arm_radius=0.001), turning(arm))
    assert found.distance < 0
    assert not found.clear
    assert "hits an obstacle" in found.sentence


def test_the_smallest_distance_is_proved_to_a_millimetre(arm):
    far = arm.obstacles
    box = flange(arm, 1.0) * [2.0, 2.0, 1.0]
    case = replace(arm, obstacles=np.array([[box - 0.05, box + 0.05]]))
    assert not len(far)
    found, times = nearest(case, turning(arm)), np.linspace(0, 2, 20001)
    places = robot_named("ur5").frames(turning(arm)(times))[:, :, :3, 3]
    truth = obstacles.arm_clearance(obstacles.world_of(case), places, case.arm_radius).min()
    assert found.proved <= truth <= found.distance
    assert found.distance - found.proved <= 1e-3
    assert found.clear
    assert "at every instant" in found.sentence


def test_a_motion_may_be_driven_if_it_keeps_its_limits_and_is_clear(arm):
    motion = turning(arm)
    verdict = judge(arm.problem, motion)
    assert may_be_driven(verdict, nearest(arm, motion))
    assert not may_be_driven(verdict, nearest(thin_wall(arm, 1.0), motion))
    assert not may_be_driven(judge(arm.problem, motion.scaled(0.5)), None)


def test_no_point_of_the_arm_is_faster_than_the_bound(arm):
    rng = np.random.default_rng(2)
    points = rng.uniform(-2, 2, (2, 6))
    case = replace(arm, problem=Problem("fast", points, JointLimits(np.full(6, 5.0)), EndCondition.FREE))
    motion, times = turning(case), np.linspace(0, 2, 2001)
    places = robot_named("ur5").frames(motion(times))[:, :, :3, 3]
    fastest = np.linalg.norm(np.diff(places, axis=0), axis=2).max() / times[1]
    assert fastest <= obstacles._fastest(robot_named("ur5"), case, motion)


def test_an_arm_that_folds_into_itself_is_not_clear(arm):
    folded = np.stack([np.zeros(6), [0, 0, 3.1, 0, 0, 0]])
    problem = Problem("fold", folded, JointLimits(np.full(6, 2.0)), EndCondition.FREE)
    case = replace(arm, problem=problem, self_collision=True)
    found = nearest(case, turning(case))
    assert not found.clear
    assert "hits itself" in found.sentence
    assert nearest(replace(case, self_collision=False), turning(case)) is None
    assert nearest(replace(arm, self_collision=True), turning(arm)).clear


def test_distances_of_segments_match_a_fine_search():
    rng = np.random.default_rng(8)
    ends = rng.normal(size=(4, 200, 3))
    ends[1, :20] = ends[0, :20]  # points
    ends[3, 20:40] = ends[2, 20:40] + (ends[1, 20:40] - ends[0, 20:40])  # parallel
    share = np.linspace(0, 1, 60)[:, None, None]
    first = ends[0] + share * (ends[1] - ends[0])
    second = ends[2] + share * (ends[3] - ends[2])
    fine = np.linalg.norm(first[:, None] - second[None], axis=-1).min(axis=(0, 1))
    exact = segment_distances(*ends)
    assert (exact <= fine + 1e-12).all()
    assert (fine - exact < 0.08).all()


def test_a_case_file_may_ask_for_both(tmp_path):
    path = tmp_path / "arm.yaml"
    text = "units: rad\nwaypoints: [[0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0]]\nlimits: {velocity: 1}\n"
    path.write_text(text + "robot: ur5\nself_collision: true\n")
    assert load_case(path).self_collision


@pytest.mark.parametrize(
    ("planner", "said"), [("straight", UNFOLLOWED), ("casadi-nlp", DRIVEN[True]), ("ruckig-stops", UNFOLLOWED)]
)
def test_a_motion_whose_speed_steps_is_not_said_to_be_one_that_may_be_driven(planner, said):
    limits = JointLimits(np.array([1.0, 0.8]))
    problem = Problem("mine", np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]]), limits)
    verdict = plan(problem, planner).verdict
    assert verdict.feasible
    assert said_of(problem, verdict, True) == said
    assert said_of(problem, verdict, False) == DRIVEN[False]
    bounded = replace(problem, limits=replace(limits, acceleration=np.array([2.0, 1.5])))
    assert said_of(bounded, plan(bounded, "ruckig-stops").verdict, True) == DRIVEN[True]


@pytest.mark.parametrize("clear", [True, False])
def test_terminal_report_and_recording_say_the_same_of_a_motion(arm, clear):
    place = flange(arm, 1.0) * ([2.0, 2.0, 1.0] if clear else 1.0)
    case = replace(arm, obstacles=np.array([[place - 0.01, place + 0.01]]))
    cell = Cell(case.name, "ruckig-stops", "ruckig-stops", RunSettings("cubic-spline"))
    summary = summarise_case(case, [CellJob(cell, case.problem).run()], ())
    [method] = summary.whole
    said = summary.driving["ruckig-stops"]
    assert said.startswith(f"{UNFOLLOWED}: the arm stays" if clear else "must not be driven: the arm hits an obstacle")
    [record] = records(RESULTS, [(summary, method, "arm.yaml")])
    assert record["driving"] == said
    words = markdown(Contents(summary, (), 1.0, 2)).splitlines()
    verdict, _, sentence = said.partition(": ")
    assert any(line.startswith(f"| ruckig-stops | feasible, {verdict} |") for line in words)
    assert f"- **ruckig-stops**: {plain(sentence)}" in words
    console = Console(width=200, record=True, file=StringIO())
    assert report_verdict(case, method.motion, console) is clear
    text = console.export_text()
    assert all(part in text for part in said.split(": "))
    assert summary.clear(method) is clear
    assert (f"ruckig-stops: {said}" in [*reasons(summary)]) is not clear
    headline = _winner(Contents(summary, (), 1.0, 2))
    assert (f"Fastest {UNFOLLOWED}" if clear else "No motion may be driven") in headline
