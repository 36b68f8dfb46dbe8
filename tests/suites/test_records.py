"""Best known times: what beats them, what contradicts them, and the committed ones under the judge."""

import pytest

from study.cases.records import ProblemRecords, Record, records_of
from study.cases.suite_file import filed_suites
from study.cases.suites import suite_named
from study.planning import Freedom, RunSettings
from study.runs.execute import CellJob
from study.store.results import Cell
from study.suites.records import contradictions, improved, records_text

NAME = "hard:one-joint-alone"
KINDS = {"casadi-nlp": Freedom.CURVE, "ruckig-stops": Freedom.FREE, "any-motion-bound": None}


@pytest.fixture(scope="module")
def case():
    return suite_named("hard").cases[NAME]


@pytest.fixture(scope="module")
def results(case):
    cells = [Cell(case.name, name, name, RunSettings(curve=case.curve, time_limit=5.0)) for name in KINDS]
    return [CellJob(cell, case.problem).run() for cell in cells]


def test_results_become_records_and_ties_stay_with_the_first(case, results):
    records = improved({}, results, KINDS)
    best = records[NAME].best
    assert set(best) == {Freedom.CURVE, Freedom.FREE}
    assert best[Freedom.CURVE].durations is not None
    assert records[NAME].bound_by == "any-motion-bound"
    assert contradictions(records, {NAME: case}) == []
    first = {NAME: records[NAME].model_copy(update={"best": {Freedom.FREE: Record(duration=1e-3, by="someone")}})}
    assert improved(first, results, KINDS)[NAME].best[Freedom.FREE].by == "someone"


def test_impossible_records_are_told(case, results):
    durations = list(improved({}, results, KINDS)[NAME].best[Freedom.CURVE].durations or ())
    short = Record(duration=1.0, by="x", durations=durations)
    broken = Record(duration=1.0, by="x", durations=[each / 2 for each in durations])
    for record, said in ((short, "its durations give"), (broken, "limit")):
        (sentence,) = contradictions({NAME: ProblemRecords(best={Freedom.CURVE: record})}, {NAME: case})
        assert said in sentence
    below = ProblemRecords(best={Freedom.FREE: Record(duration=1.0, by="x")}, bound=2.0)
    assert "below the proved bound" in contradictions({NAME: below}, {NAME: case})[0]


@pytest.mark.parametrize("name", filed_suites())
def test_the_committed_records_hold_under_the_judge(name):
    suite = suite_named(name)
    records = records_of(suite)
    sample = dict(list(records.items())[::9])
    assert contradictions(sample, suite.cases) == []
    if records:
        text = records_text(suite, records)
        assert text.startswith('{"suite": ' + f'"{name}", "checksum": "{suite.checksum}"')
