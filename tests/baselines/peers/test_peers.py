"""Other packages as planners: they answer with motions through the waypoints, or say in a sentence why not."""

from dataclasses import replace

import numpy as np
import pytest

from baselines.peers.base import Peer
from study.cases.suites import suite_named
from study.judge import judge
from study.planning import Status, usual_settings
from study.registry import peer_names, planner_named, unavailable_planners
from study.runs.execute import CellJob
from study.store.results import Cell
from study.suites.lineups import lineup_named, suite_cells
from study.suites.runs import runs_of
from study.testing import example_problems

EXAMPLES = {problem.name: problem for problem in example_problems()}
MISSING = unavailable_planners()


def peer_or_skip(name):
    if name in MISSING:
        pytest.skip(MISSING[name])
    return planner_named(name)


@pytest.mark.parametrize("name", peer_names())
def test_a_peer_passes_all_waypoints_and_is_at_worst_to_be_slowed_down(name):
    peer, answered = peer_or_skip(name), 0
    for problem in (EXAMPLES["smooth ends"], EXAMPLES["no jerk limit"]):
        plan = peer.plan(problem, usual_settings(problem))
        if plan.motion is None:
            assert plan.status is Status.NOT_APPLICABLE
            assert "the package" in plan.message
            continue
        answered += 1
        stretch = judge(problem, plan.motion).stretch
        assert stretch < 1.2
        assert judge(problem, plan.motion.scaled(stretch * (1 + 1e-6))).feasible
        assert plan.details["package_seconds"] > 0
    assert answered


def test_peers_of_one_kind_agree():
    """Straight moves of one joint in minimum time have one answer."""
    problem = replace(EXAMPLES["smooth ends"], waypoints=EXAMPLES["smooth ends"].waypoints[:2])
    names = [name for name in ("ruckig-chain", "justblend-stop", "ruckig-stops") if name not in MISSING]
    times = [planner_named(name).plan(problem, usual_settings(problem)).motion.duration for name in names]
    assert max(times) == pytest.approx(times[0], rel=0.2)
    assert times[0] == pytest.approx(times[-1], rel=1e-9)


def test_justblend_goes_on_where_the_line_does():
    stop, chain = peer_or_skip("justblend-stop"), planner_named("ruckig-chain")
    problem = suite_named("hard").cases["hard:straight-line-jerk"].problem
    plan = stop.plan(problem, usual_settings(problem))
    assert judge(problem, plan.motion).stretch < 1 + 1e-5
    assert plan.motion.duration < 0.5 * chain.plan(problem, usual_settings(problem)).motion.duration


class Fussy(Peer):
    about = "raises what it is told to"
    jerk = (False,)
    most = 4

    def __init__(self, outcome):
        self.outcome = outcome

    def solve(self, problem, time_limit):
        if isinstance(self.outcome, Exception):
            raise self.outcome
        return self.outcome


@pytest.mark.parametrize(
    ("outcome", "status", "said"),
    [
        (KeyError("inside\nof it"), Status.FAILED, "the package stopped: 'inside"),
        (OSError(), Status.FAILED, "the package stopped: OSError"),
        (None, Status.NOT_CONVERGED, "found no motion in its time"),
    ],
)
def test_what_a_package_raises_is_a_reason(outcome, status, said):
    problem = EXAMPLES["no jerk limit"]
    plan = Fussy(outcome).plan(problem, usual_settings(problem))
    assert plan.status is status
    assert said in plan.message
    assert "\n" not in plan.message


def test_what_a_package_cannot_do_is_said_before_it_is_asked():
    plain = EXAMPLES["no jerk limit"]
    half = replace(plain.limits, jerk=np.array([1.0, np.inf]), min_jerk=None)
    unlimited = np.full(2, np.inf)
    without = replace(plain.limits, acceleration=unlimited, min_acceleration=-unlimited)
    declined = {
        "knows no limit of jerk": EXAMPLES["smooth ends"],
        "of all joints or of none": replace(plain, limits=half),
        "needs finite limits": replace(plain, limits=without),
        "more than 4 waypoints": replace(plain, waypoints=np.arange(10.0).reshape(5, 2)),
        "does not know stops": EXAMPLES["a stop"],
    }
    for said, problem in declined.items():
        plan = Fussy(None).plan(problem, usual_settings(problem))
        assert plan.status is Status.NOT_APPLICABLE
        assert said in plan.message


def test_the_line_up_of_peers_has_those_that_are_installed_and_the_record_shows_the_excess():
    suite, lineup = suite_named("hard"), lineup_named("peers")
    assert set(lineup.limits) == set(peer_names())
    case = next(c for c in suite.cases.values() if not np.isfinite(c.problem.limits.jerk).any())
    cells = suite_cells([case], lineup, quick=True)
    assert [cell.planner for cell in cells] == [name for name in peer_names() if name not in MISSING]
    cell = Cell(case.name, "toppra-default", "toppra-default", usual_settings(case.problem))
    (run,) = runs_of([CellJob(cell, case.problem).run()], {case.name: case})
    assert not run.feasible
    assert 1.0 < run.stretch < 2.0


def test_a_strangers_peer_needs_one_line_to_stand_in_the_line_up(stubs):
    case = next(iter(suite_named("hard").cases.values()))
    assert "stub-peer" in peer_names()
    assert "stub-peer" in {cell.planner for cell in suite_cells([case], lineup_named("peers"), quick=True)}
