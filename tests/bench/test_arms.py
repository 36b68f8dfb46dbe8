"""Other packages on the problems of real arms: their motions are read exactly, and the summary adds up."""

import numpy as np
import pytest

from study.bench.arms import Answer, Row, _peer, said, summary, timed_peers
from study.bench.parts import PARTS, measured
from study.errors import StudyError
from study.splines import stations_of
from study.suites.tasks import arm_problems

PROBLEM = next(problem for problem in arm_problems(0) if problem.name == "ur5e-pick5")


def test_the_bench_takes_the_registered_peers_and_times_their_own_work():
    peers = timed_peers()
    assert {"toppra-natural", "ruckig-chain"} <= set(peers)
    assert not [name for name in peers if name.startswith("tesseract")]  # which work elsewhere
    answer = _peer(PROBLEM, "ruckig-chain", peers["ruckig-chain"])
    assert answer.stretch == pytest.approx(1.0)
    assert 0 < answer.duration < np.inf
    assert answer.seconds > 0


class _Refusing:
    """A peer that finds nothing, or raises what it likes."""

    def __init__(self, error: Exception | None) -> None:
        self.error = error

    def solve(self, problem, time_limit):
        if self.error is not None:
            raise self.error
        return None

    def motion(self, problem, answer):
        return answer.no_such_thing


@pytest.mark.parametrize("error", [None, AttributeError("no"), RuntimeError("no")])
def test_a_peer_that_finds_nothing_is_no_usable_one(error):
    assert _peer(PROBLEM, "refusing", _Refusing(error)).duration == np.inf


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
