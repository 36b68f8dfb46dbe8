import json
import re
from dataclasses import replace

import numpy as np
import pytest

from study.cases.library import case_names, load_case
from study.cases.published import claims
from study.comparison.build import compare, flags, said, trial_jobs
from study.comparison.claims import HEADLINES
from study.comparison.contestants import level_cells
from study.comparison.effort import FULL
from study.comparison.ioh import write_ioh
from study.comparison.pages import PAGES, tables_of, write_pages
from study.runs.runner import run_jobs
from study.runs.selections import YARDSTICKS
from study.store.store import Store
from tests.helpers.comparisons import CASES, TINY
from tests.helpers.threads import no_processes

pytest.importorskip("scikit_posthocs", reason="the comparison needs the extra 'compare'")

WALL = ("wall", "seconds")


def timeless(found):
    """All findings as records, without what no two runs share."""
    tables = tables_of(found)
    return {
        name: [{key: value for key, value in record.items() if not any(w in key for w in WALL)} for record in records]
        for name, records in tables.items()
    }


def compared(path, told=lambda part, done, total: None):
    """Compare with one worker, told of every part how far it is."""
    with Store(path) as store, pytest.MonkeyPatch.context() as patch:
        no_processes(patch)

        def run(part, jobs):
            done = len(jobs) - len(store.missing(jobs))

            def finished(job, outcome):
                nonlocal done
                done += 1
                told(part, done, len(jobs))

            told(part, done, len(jobs))
            run_jobs(jobs, store, workers=1, on_outcome=finished)

        return compare(CASES, TINY, store, run)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "results.sqlite"
    return path, compared(path)


@pytest.mark.slow
def test_interrupted_and_resumed_gives_the_same_numbers(whole, tmp_path):
    path = tmp_path / "results.sqlite"

    def interrupting(part_wanted, share):
        def told(part, done, total):
            if part == part_wanted and done >= share * total:
                raise KeyboardInterrupt

        return told

    for part, share in (("planners", 0.4), ("ablations", 0.3)):
        with pytest.raises(KeyboardInterrupt):
            compared(path, interrupting(part, share))
    counts = {}

    def last(part, done, total):
        counts.setdefault(part, done)

    resumed = compared(path, last)
    assert 0 < counts["ablations"] < len(trial_jobs(list(CASES.values()), TINY)["ablations"])
    assert timeless(resumed) == timeless(whole[1])


def test_nothing_is_run_twice(whole):
    path, found = whole
    counts = []
    again = compared(path, lambda *told: counts.append(told))
    assert all(done == total for _, done, total in counts)
    assert len(counts) == 4
    assert tables_of(again) == tables_of(found)


def test_flags_are_kept_for_the_report(whole, tmp_path):
    path, found = whole
    assert flags(path) == found.audit.flags
    assert [sentence.partition(" the ")[0] for sentence in said(path)] == ["On", "On"]
    assert flags(tmp_path / "nothing.sqlite") == {}
    assert said(tmp_path / "nothing.sqlite") == []


def test_every_table_holds_the_trivial_opponents(whole):
    _, found = whole
    for level, contestants in found.field.levels.items():
        for case in CASES:
            planners = {one.planner for one in contestants if one.case == case}
            assert set(YARDSTICKS) < planners, (level, case)
    assert all(set(YARDSTICKS) < set(one.planners) for one in found.omnibus)


def test_budgets_are_equal_and_seeds_paired():
    for level in ("scaled", "penalty"):
        cells = level_cells(list(CASES.values()), level, TINY)
        assert {cell.settings.evaluations for cell in cells} == {120}
        seeds = {}
        for cell in cells:
            seeds.setdefault((cell.case, cell.planner), []).append(cell.settings.seed)
        assert {tuple(values) for values in seeds.values()} == {(0, 1), (0,)}
    assert FULL.seeds == 30


def test_the_reference_is_the_shortest_feasible_motion_of_the_same_level(whole):
    _, found = whole
    for case, reference in found.field.references.items():
        levels = [one for level in found.field.levels.values() for one in level if one.case == case]
        assert reference.value <= min(one.durations.min() for one in levels)
        assert reference.curve == CASES[case].curve
        assert all(one.gap >= 0 for level in found.measured.values() for one in level)


def test_claims_stand_beside_their_counterparts(whole):
    _, found = whole
    assert {one.headline.case for one in found.claims} == set(CASES)
    for one in found.claims:
        printed = claims(one.headline.paper)
        assert one.printed_saving == printed[one.headline.saving].printed
        assert one.total == printed[one.headline.total].value
        assert one.above_optimum == pytest.approx(one.ours.total / one.reference.value - 1)
        assert one.ruckig is not None
        assert len(one.ruckig.wall) == TINY.seeds  # one call would count the loading of the library
        assert 0 < one.ruckig.wall.min() < one.ours.wall.sum() + 1


def test_every_papers_headline_is_known():
    assert {one.case for one in HEADLINES} == set(case_names(default_only=True)) & {one.case for one in HEADLINES}
    assert len({one.paper for one in HEADLINES}) == 5
    for one in HEADLINES:
        assert load_case(one.case).paper == one.paper
        assert {one.saving, one.total} <= claims(one.paper).keys()


def test_pages_are_self_contained_and_flag_their_searches(whole, tmp_path):
    _, found = whole
    flagged = replace(found, audit=replace(found.audit, flags={"pso": "its result <depends> on a test"}))
    first = write_pages(flagged, tmp_path / "comparison", {"Python": "3"})
    assert first.name == "index.html"
    for slug in PAGES:
        text = (tmp_path / "comparison" / f"{slug}.html").read_text()
        assert not re.search(r'(?:src|href)="(?:https?:)?//', text)
        assert "How to read this" in text
        assert "Limitations" in text
        assert "Quick mode" in text
        assert "mathdefault" not in text
        assert "{" not in re.sub(r"<(style|script).*?</\1>", "", text, flags=re.DOTALL)
        ids = re.findall(r' id="([^"]+)"', text)
        assert len(ids) == len(set(ids))
        for linked in re.findall(r'href="([^"#][^":]*)"', text):
            assert linked == "data:," or (tmp_path / "comparison" / linked).exists() or linked == "../index.html"
    for name, records in tables_of(flagged).items():
        key = next(
            (key for key in ("planner", "search") if key in records[0]), None
        )  # the ablations' forms are no planners
        assert key is None or all(one["flag"] == flagged.audit.flags.get(one[key], "") for one in records), name
    for slug in ("targets", "tests", "audit"):
        text = (tmp_path / "comparison" / f"{slug}.html").read_text()
        assert 'pso <abbr title="its result &lt;depends&gt; on a test">⚑</abbr>' in text


def test_tables_survive_their_files(whole, tmp_path):
    pandas = pytest.importorskip("pandas")
    _, found = whole
    write_pages(found, tmp_path / "c", {})
    for name, records in tables_of(found).items():
        assert len(pandas.read_csv(tmp_path / "c" / "tables" / f"{name}.csv")) == len(records)
        assert len(pandas.read_parquet(tmp_path / "c" / "tables" / f"{name}.parquet")) == len(records)


def test_ioh_files_say_what_the_histories_say(whole, tmp_path):
    _, found = whole
    files = write_ioh(tmp_path, found.field.levels["scaled"], {"puma560": 3, "woodworking": 3})
    by_name = {(one.planner, one.case): one for one in found.field.levels["scaled"]}
    document = json.loads(next(path for path in files if path.match("pso-scaled/*puma560*")).read_text())
    runs = document["scenarios"][0]["runs"]
    pso = by_name["pso", "puma560"]
    assert [run["best"]["y"] for run in runs] == [history[-1, 1] for history in pso.histories]
    assert [run["evals"] for run in runs] == [120, 120]
    data = tmp_path / "pso-scaled" / document["scenarios"][0]["path"]
    blocks = data.read_text().split("evaluations raw_y\n")[1:]
    assert len(blocks) == 2
    assert all(block.startswith("1 ") for block in blocks)


def test_iohinspector_reads_the_export(whole, tmp_path):
    iohinspector = pytest.importorskip("iohinspector")
    _, found = whole
    levels = [one for level in found.field.levels.values() for one in level]
    write_ioh(tmp_path, levels, {"puma560": 3, "woodworking": 3})
    manager = iohinspector.DataManager()
    manager.add_folder(str(tmp_path))
    assert len(manager.overview) == sum(len(one.durations) for one in levels)
    rows = manager.select(algorithms=["pso-penalty"], function_ids=[2]).load(monotonic=True, include_meta_data=True)
    best = rows.group_by("run_id").min().sort("run_id")["raw_y"].to_list()
    own = next(one for one in levels if (one.planner, one.level, one.case) == ("pso", "penalty", "woodworking"))
    assert np.allclose(best, [history[-1, 1] for history in own.histories])


def test_one_seed_is_refused(tmp_path, study_command):
    refused = study_command("compare", "--cases", "woodworking", "--seeds", 1, "--out", tmp_path)
    assert refused.returncode == 2
    assert "at least 2 seeds" in refused.stderr
