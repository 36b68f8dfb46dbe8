"""Other packages on the problems of real arms: their motions are read exactly, and the summary adds up."""

import numpy as np
import pytest

from study.bench.arm_peers import PEERS
from study.bench.arms import Answer, Row, said, summary
from study.bench.parts import PARTS, measured
from study.bench.spline_peers import stations_of
from study.errors import StudyError
from study.judge import judge
from study.suites.tasks import arm_problems

PROBLEMS = {problem.name: problem for problem in arm_problems(0) if "pick5" in problem.name}


@pytest.mark.parametrize("peer", [peer for peer in PEERS if peer.package != "pydrake"], ids=lambda peer: peer.name)
def test_a_peers_motion_passes_all_waypoints_and_needs_little_stretching(peer):
    problem = PROBLEMS["ur5e-pick5" if True in peer.jerk else "ur5e-pick5-va"]
    if not peer.plans(problem):
        pytest.skip(f"{peer.package} is not installed")
    motion = peer.motion(problem, peer.solve(problem))
    verdict = judge(problem, motion)
    assert verdict.stretch < 1.2
    assert judge(problem, motion.scaled(verdict.stretch)).feasible


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ur5e-pick5", "ur5e-pick5-va"])
def test_drakes_motions_keep_the_limits_as_they_are(name):
    problem = PROBLEMS[name]
    for peer in PEERS:
        if peer.package == "pydrake" and peer.plans(problem):
            motion = peer.motion(problem, peer.solve(problem))
            assert judge(problem, motion.scaled(1 + 1e-4)).feasible, peer.name


def test_gridpoints_hold_all_knots():
    points = stations_of(np.array([0.0, 1.0, 5.0]))
    assert len(points) == 201
    assert {0.0, 1.0, 5.0} <= set(points)


def test_the_summary_names_the_worst_and_counts_medians():
    fast, best = Answer("fast", 1.2, 1.0, 0.02), Answer("best", 1.1, 1.0, 0.05)
    peers = (
        Answer("toppra-natural", 1.0, 1.0, 0.02),
        Answer("drake-gcs", np.inf, 1.0, 2.0),
        Answer("copp", 1.0, 1.0, 0.01),
    )
    row = Row("arm", fast, best, peers)
    assert (row.peer.name, row.ratio) == ("copp", pytest.approx(1.1))
    texts = summary([row])
    assert "geometric mean 1.1000" in texts[0]
    assert "worst 1.1000 on arm" in texts[0]
    assert "best 50.0 ms, the best peers 10.0 ms" in texts[1]
    assert "True" in texts[2]
    assert texts[3].startswith("fast by toppra, v+a: median 1.00")
    assert said(row).startswith("arm: fast 1.2000 s, 20.0 ms, toppra-natural 20.0 ms; best 1.1000 s")


def test_an_unknown_part_is_refused_with_the_parts_there_are():
    with pytest.raises(StudyError, match=next(iter(PARTS))):
        measured("armz", 0, print)
