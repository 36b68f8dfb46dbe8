import json
from dataclasses import dataclass, replace

import numpy as np
import pytest

from study.cases.library import load_case
from study.comparison.audit import audited_searches
from study.comparison.audit_functions import function_jobs
from study.comparison.audit_trajectories import trajectory_jobs
from study.comparison.build import trial_jobs
from study.comparison.effort import QUICK
from study.comparison.tasks import FunctionView
from study.comparison.trials import TOGETHER, Trial, TrialJob, TrialOutcome, repeated
from study.planning import Status
from study.runs.runner import run_jobs
from study.search.pso import PSO
from study.search.random_search import RandomSearch
from study.search.woa import WOA
from study.store.kept import key_of
from study.store.maintenance import merge, verify
from study.store.store import Store

TRIAL = Trial("woa", "sphere", FunctionView.SHIFTED, 0, 100, 10, 4)
JOBS = [TrialJob(TRIAL, WOA(), range(3)), TrialJob(replace(TRIAL, search="pso"), PSO(), range(1))]
SMALL = replace(QUICK, functions=("ackley",), dosed=("ackley",), dimensions=5, population=7, generations=6)


@pytest.fixture
def filled(tmp_path):
    path = tmp_path / "results.sqlite"
    with Store(path) as store:
        run_jobs(JOBS, store, workers=1)
    return path


def test_a_trial_repeats_and_its_key_follows_its_content():
    job = JOBS[0]
    assert job.run() == job.run()
    assert key_of(job) == key_of(replace(job, trial=replace(TRIAL, search="another name")))
    others = [
        replace(job, search=WOA(spiral=2.0)),
        replace(job, search=PSO()),
        replace(job, seeds=range(1, 4)),
        replace(job, seeds=range(2)),
        replace(job, trial=replace(TRIAL, view="origin")),
    ]
    assert len({key_of(other) for other in (job, *others)}) == 6


def test_a_moved_limit_of_a_case_makes_another_trial():
    problem = load_case("ur5-helix").problem
    job = TrialJob(replace(TRIAL, task="ur5-helix", formulation="penalty"), PSO(), range(2), problem, "poly353")
    assert key_of(job) != key_of(replace(job, problem=replace(problem, duration_bounds=(0.5, 9.0))))
    assert key_of(job) != key_of(replace(job, curve="cubic-spline"))


def test_trials_are_kept_as_they_came_and_equal_ones_once(filled):
    twin = replace(JOBS[0], trial=replace(TRIAL, search="twin"))
    with Store(filled) as store:
        assert store.missing([*JOBS, twin]) == []
        kept = [outcome for _, outcome in store.outcomes([*JOBS, twin])]
    assert kept == [JOBS[0].run(), JOBS[1].run(), JOBS[0].run()]
    assert verify(filled) == (2, [])


def test_trials_are_merged_like_all_results(filled, tmp_path):
    merged = merge(tmp_path / "ours.sqlite", filled)
    assert (merged.added, merged.known, merged.contrary) == (2, 0, 0)


def test_a_comparison_has_a_key_for_every_search_on_every_kind_of_task():
    effort = replace(SMALL, trial_seeds=1, function_seeds=1, printed=True, formulations=("penalty", "scaled"))
    parts = trial_jobs([load_case("woodworking"), load_case("ur5-helix")], effort)
    jobs = [job for part in parts.values() for job in part]
    assert len({key_of(job) for job in jobs}) > 200
    roots = {root for job in jobs for root in json.loads(job.code())}
    assert {"study.comparison.trials", "study.search.woa", "study.search.ssa"} <= roots


def test_many_repetitions_are_cut_into_jobs():
    jobs = repeated(TRIAL, WOA(), 2 * TOGETHER + 5)
    assert [len(job.seeds) for job in jobs] == [TOGETHER, TOGETHER, 5]
    assert [trial.seed for job in jobs for trial in job.trials] == list(range(2 * TOGETHER + 5))


def test_a_crash_of_a_trial_is_an_outcome_of_each_repetition():
    assert JOBS[0].failed("it crashed", 1.0, Status.FAILED) == (TrialOutcome(np.inf, "it crashed"),) * 3


@pytest.mark.parametrize("name", audited_searches(printed=True))
def test_runs_together_end_as_they_do_alone(name):
    searches, case = {name: audited_searches(printed=True)[name]}, load_case("ur5-helix")
    own = replace(SMALL, trial_seeds=2, function_seeds=3, trial_evaluations=40)
    jobs = function_jobs(searches, own) + trajectory_jobs(searches, [case], own, ["penalty", "scaled"])
    for job in jobs:
        assert job.run() == tuple(map(job.run_alone, job.seeds))


@dataclass(frozen=True)
class Fragile(RandomSearch):
    """Breaks down when its third population begins with a large coordinate."""

    def tell(self, state, values, rng):
        if state.generation == 2 and state.candidates[0, 0] > 0.0:
            raise ArithmeticError("too large")
        return super().tell(state, values, rng)


def test_a_run_that_breaks_down_leaves_the_others_alone():
    found = TrialJob(TRIAL, Fragile(), range(8)).run()
    broken = [end for end in found if end.reason]
    assert {end.reason for end in broken} == {"ArithmeticError: too large"}
    assert 0 < len(broken) < len(found)
    plain = TrialJob(TRIAL, RandomSearch(), range(8)).run()
    assert all(end.value == other.value for end, other in zip(found, plain, strict=True) if not end.reason)
