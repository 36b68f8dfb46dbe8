import sqlite3
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, replace

import pytest

from study.cases.library import load_case
from study.comparison import tasks, trialstore
from study.comparison.audit import audited_searches, function_jobs, trajectory_jobs
from study.comparison.build import trial_jobs
from study.comparison.effort import QUICK
from study.comparison.staleness import drop_stale_trials
from study.comparison.trials import Job, Outcome, Trial, run_trial, run_trials
from study.comparison.trialstore import TrialStore, batches, key_of, run_jobs
from study.errors import StudyError
from study.search.pso import PSO
from study.search.random_search import RandomSearch
from study.search.woa import WOA
from study.store.maintenance import merge, verify

TRIAL = Trial("woa", "sphere", tasks.SHIFTED, 1, 100, 10, 4)
JOBS = [Job(replace(TRIAL, seed=seed), WOA()) for seed in range(3)] + [Job(replace(TRIAL, search="pso"), PSO())]
SMALL = replace(QUICK, functions=("ackley",), dosed=("ackley",), dimensions=5, population=7, generations=6)


@pytest.fixture
def filled(tmp_path):
    path = tmp_path / "results.sqlite"
    with TrialStore(path) as store, ThreadPoolExecutor(1) as pool:
        run_jobs(JOBS, store, pool)
    return path


def change(path, statement):
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute(statement)


def test_a_trial_repeats_and_its_key_follows_its_content():
    job = Job(TRIAL, WOA())
    assert run_trial(job).value == run_trial(job).value
    assert key_of(job) == key_of(Job(replace(TRIAL, search="another name"), WOA()))
    others = [
        Job(TRIAL, WOA(spiral=2.0)),
        Job(replace(TRIAL, seed=2), WOA()),
        Job(replace(TRIAL, view="origin"), WOA()),
    ]
    assert len({key_of(one) for one in (job, *others)}) == 4


@pytest.mark.parametrize(
    ("changed", "stale"), [("study.search.woa", 3), ("study.comparison.trials", 4), ("study.x", 0)]
)
def test_changed_code_makes_its_own_trials_stale_and_no_others(filled, monkeypatch, changed, stale):
    real = trialstore.code_digest
    monkeypatch.setattr(trialstore, "code_digest", lambda module: "other" if module == changed else real(module))
    trialstore._shared_content.cache_clear()
    with TrialStore(filled, write=False) as store:
        assert len(JOBS) - len(store.outcomes(JOBS)) == stale
    trialstore._shared_content.cache_clear()


@pytest.fixture
def compared(tmp_path):
    """One trial of every search on every kind of task, as a comparison stores them, with outcomes made up."""
    effort = replace(SMALL, trial_seeds=1, function_seeds=1, printed=True, formulations=("penalty", "scaled"))
    parts = trial_jobs([load_case("woodworking"), load_case("ur5-helix")], effort)
    jobs = list({key_of(job): job for part in parts.values() for job in part}.values())
    with TrialStore(tmp_path / "results.sqlite") as store:
        store.add(jobs, [Outcome(1.0, "", 0.1)] * len(jobs))
    return tmp_path / "results.sqlite", jobs


def test_trials_of_the_present_code_are_not_stale(compared):
    path, jobs = compared
    assert len(jobs) > 200
    assert drop_stale_trials(path) == 0
    assert verify(path) == (len(jobs), [])


def test_stale_trials_are_dropped_and_those_that_cannot_be_told_stay(compared, monkeypatch):
    path, jobs = compared
    woa = [job for job in jobs if type(job.search) is WOA]
    unknown = [Job(replace(TRIAL, search="a stranger's"), WOA(spiral=2.0)), Job(replace(TRIAL, task="my robot"), WOA())]
    other_constant, twin = Job(TRIAL, WOA(spiral=3.0)), Job(replace(TRIAL, search="woa", seed=7), PSO())
    helix = load_case("ur5-helix").problem
    moved = Job(replace(TRIAL, task="ur5-helix", dimensions=0), WOA(), replace(helix, duration_bounds=(0.5, 9.0)))
    with TrialStore(path) as store:
        added = [*unknown, other_constant, moved, twin]
        store.add(added, [Outcome(1.0, "", 0.1)] * len(added))
    damaged = next(job for job in jobs if job not in woa)
    change(path, f"UPDATE trials SET value = 2.0 WHERE key = '{key_of(damaged)}'")
    real = trialstore.code_digest
    monkeypatch.setattr(trialstore, "code_digest", lambda module: "other" if module == WOA.__module__ else real(module))
    trialstore._shared_content.cache_clear()
    assert len(woa) > 10
    assert drop_stale_trials(path) == len(woa) + 2
    count, wrong = verify(path)
    assert (count, len(wrong)) == (len(jobs) + len(added) - len(woa) - 2, 1)
    with closing(sqlite3.connect(path)) as connection:
        left = {row[0] for row in connection.execute("SELECT trial FROM trials")}
    assert sum("a stranger's" in trial or "my robot" in trial for trial in left) == 2
    assert drop_stale_trials(path) == 0
    monkeypatch.undo()
    trialstore._shared_content.cache_clear()


def test_the_code_behind_a_task_is_behind_its_trials():
    from study.code_digest import _imports

    assert {"study.comparison.tasks", "study.search.loop"} <= set(_imports("study.comparison.trials"))
    assert {"study.curves", "study.formulation", "study.testfunctions"} <= set(_imports("study.comparison.tasks"))


@pytest.mark.parametrize("damage", ["value = value + 1e-9", "reason = 'none'", "digest = ''"])
def test_a_damaged_trial_is_found_when_read_and_when_verified(filled, damage):
    assert verify(filled) == (4, [])
    change(filled, f"UPDATE trials SET {damage} WHERE key = '{key_of(JOBS[1])}'")
    with TrialStore(filled, write=False) as store:
        assert len(store.outcomes([JOBS[0], *JOBS[2:]])) == 3
        with pytest.raises(StudyError, match=r"the trial of woa on sphere \(seed 1\) is damaged"):
            store.outcomes(JOBS)
    count, damaged = verify(filled)
    assert count == 4
    assert len(damaged) == 1
    assert '"seed":1' in damaged[0]


def test_merging_takes_trials_but_not_those_without_checksums(filled, tmp_path):
    ours, old = tmp_path / "ours.sqlite", tmp_path / "old.sqlite"
    with TrialStore(ours):
        pass
    merged = merge(ours, filled)
    assert (merged.added, merged.known, merged.contrary) == (0, 0, 0)  # of planners' results there are none
    with TrialStore(ours, write=False) as store:
        assert len(store.outcomes(JOBS)) == 4
    with TrialStore(old):
        pass
    change(old, "DROP TABLE trials")
    change(old, "CREATE TABLE trials (key TEXT PRIMARY KEY, trial TEXT, value REAL, reason TEXT, wall_time REAL)")
    change(old, "INSERT INTO trials VALUES ('a', '{}', 1.0, '', 0.1)")
    merge(ours, old)
    assert verify(ours) == (4, [])
    assert verify(old) == (0, [])
    with TrialStore(old) as store:  # its trials are named in a way that no run asks for
        assert store.outcomes(JOBS) == {}
        store.add(JOBS[:1], [Outcome(1.0, "", 0.1)])
    assert verify(old) == (1, [])


def test_repetitions_are_run_together_and_equal_trials_once(filled):
    twin = Job(replace(TRIAL, search="twin"), WOA())
    assert [len(batch) for batch in batches([*JOBS, twin], {})] == [3, 1]
    assert batches(JOBS, {job.trial: Outcome(0.0, "", 0.0) for job in JOBS}) == []
    with TrialStore(filled, write=False) as store:
        found = store.outcomes([*JOBS, twin])
    assert found[twin.trial] == found[JOBS[1].trial]


@pytest.mark.parametrize("name", audited_searches(printed=True))
def test_runs_together_end_as_they_do_alone(name):
    searches, case = {name: audited_searches(printed=True)[name]}, load_case("ur5-helix")
    own = replace(SMALL, trial_seeds=2, function_seeds=3, trial_evaluations=40)
    jobs = function_jobs(searches, own) + trajectory_jobs(searches, [case], own, ["penalty", "scaled"])
    for batch in batches(jobs, {}):
        together, alone = run_trials(batch), [run_trial(job) for job in batch]
        assert [one.value for one in together] == [one.value for one in alone]
        assert [one.reason for one in together] == [one.reason for one in alone]


@dataclass(frozen=True)
class Fragile(RandomSearch):
    """Breaks down when its third population begins with a large coordinate."""

    def tell(self, state, values, rng):
        if state.generation == 2 and state.candidates[0, 0] > 0.0:
            raise ArithmeticError("too large")
        return super().tell(state, values, rng)


def test_a_run_that_breaks_down_leaves_the_others_alone():
    batch = [Job(replace(TRIAL, seed=seed), Fragile()) for seed in range(8)]
    found = run_trials(batch)
    broken = [one for one in found if one.reason]
    assert {one.reason for one in broken} == {"ArithmeticError: too large"}
    assert 0 < len(broken) < len(found)
    plain = run_trials([Job(replace(TRIAL, seed=seed), RandomSearch()) for seed in range(8)])
    assert all(one.value == other.value for one, other in zip(found, plain, strict=True) if not one.reason)
