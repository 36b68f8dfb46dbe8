"""The reproduction as a whole: nothing dropped, pages complete, work stored by content, same answer in any pool."""

import csv
import re
import zlib
from concurrent.futures import ThreadPoolExecutor
from html import unescape
from html.parser import HTMLParser

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner

from study import registry
from study.cases.library import load_case
from study.cases.published import claims, papers, statements, tables
from study.cli import reproduce as command
from study.cli.main import app
from study.errors import StudyError
from study.judge import judge
from study.planning import Meter
from study.reproduction import page
from study.reproduction.benchmark_runs import BenchmarkJob, thinned
from study.reproduction.book import PAPERS, Entry, entries_of, jobs_of, paper_named
from study.reproduction.cells import write_cells
from study.reproduction.convergence import LEVELS, arrived_at, late, levels, settled, settled_at
from study.reproduction.effort import FULL, Effort
from study.reproduction.genetic_runs import GeneticJob
from study.reproduction.jobs import Runs
from study.reproduction.kinematics_runs import BRANCH, KinematicsJob, nearest
from study.reproduction.motion_runs import MotionJob, OptimumJob, motion_of
from study.reproduction.page import write_index, write_paper
from study.reproduction.page_tables import named, shown_table
from study.reproduction.path_runs import attempts
from study.reproduction.tally import AGREEING, KEPT, OPEN, Decided, counts_of, decided, sentences
from study.reproduction.verdicts import BY_RUNS, CANNOT_STAND, CLAIM, IN_PRINT, Basis, Outcome, Ruling, claim
from study.robots import inverse, robot_named
from study.robots.helix import helix_configurations
from study.runs.runner import run_jobs
from study.search.loop import minimise
from study.search.pso import PSO
from study.search.sca import SCA
from study.search.state import Box
from study.store.kept import key_of
from study.store.maintenance import verify
from study.store.store import Store
from tests.helpers.troubled import TroubledJob

TINY = Effort("tiny: for tests", 2, 0.02, 2, all_readings=False)
KEYS = list(PAPERS)
DRAWN = ("woodworking-golds-pso", "ur5-tadf-ssa")  # drawing takes seconds; two papers have every kind of figure


@pytest.fixture(scope="module")
def reproduced():
    measure = KinematicsJob.run
    with pytest.MonkeyPatch.context() as patch:  # seconds are measured less often: nothing here looks at them
        patch.setattr(KinematicsJob, "run", lambda self: measure(KinematicsJob(poses=40, repeats=1)))
        runs = Runs((job, job.run()) for job in dict.fromkeys(jobs_of(KEYS, TINY)))
    return {paper: (entries_of(paper, runs, TINY), runs) for paper in KEYS}


def test_no_job_is_shown_by_the_name_of_its_class():
    assert not [job.label for job in jobs_of(KEYS, TINY) if job.label == type(job).__name__]


class Page(HTMLParser):
    """Row heads, column heads and cells of every table that follows a heading `Table n`."""

    def __init__(self, text):
        super().__init__()
        self.found, self.here, self.inside, self.scope = {}, None, None, None
        self.turned = set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "h2":
            self.here, self.inside = None, "h2"
        elif tag == "table" and attributes.get("data-turned"):
            self.turned.add(max(self.found, key=list(self.found).index))
        elif tag == "th":
            self.inside = attributes.get("scope")
            if self.here and self.inside:
                self.here[self.inside].append("")
        elif tag == "br":  # below a head stands its usual verdict
            self.inside = None
        elif tag == "span" and attributes.get("class") == "p" and self.here:
            self.inside = "cell"
            self.here["cell"].append("")

    def handle_data(self, data):
        if self.inside == "h2" and (number := re.match(r"Table \d+", data)):
            self.here = self.found.setdefault(number[0], {"row": [], "col": [], "cell": []})
        elif self.here and self.inside in ("row", "col", "cell"):
            self.here[self.inside][-1] += data

    def handle_endtag(self, tag):
        if tag in ("h2", "th", "span"):
            self.inside = None


def shown(text):
    """Text of a printed number on a page."""
    return unescape(re.sub("<[^>]*>", "", page.powers(text)))


def test_powers_of_ten_are_raised_and_text_is_escaped():
    assert page.powers("6.4918 x 10^-190 <b>") == "6.4918 × 10<sup>−190</sup> &lt;b&gt;"
    assert page.powers("1.19 x 10^0 to 1.34 x 10^1") == "1.19 × 10<sup>0</sup> to 1.34 × 10<sup>1</sup>"


def test_all_five_papers_are_there():
    assert set(KEYS) == set(papers())


@pytest.mark.parametrize("paper", KEYS)
def test_every_cell_and_every_claim_has_a_verdict(reproduced, paper):
    entries, _ = reproduced[paper]
    cells = [(e.place.table, e.place.row, e.place.column, e.printed) for e in entries if e.place.table != CLAIM]
    printed = [(n, c.row, c.column, c.printed) for n, table in tables(paper).items() for c in table.cells]
    assert cells == printed
    ruled = [e.place.row for e in entries if e.place.table == CLAIM]
    assert list(dict.fromkeys(ruled)) == [*claims(paper), *(s.id for s in statements(paper))]
    for name in set(ruled):
        columns = [e.place.column for e in entries if e.place.table == CLAIM and e.place.row == name]
        assert columns in ([""], [IN_PRINT, BY_RUNS])
    for entry in entries:
        if entry.ruling.outcome in (
            Outcome.IMPOSSIBLE,
            Outcome.CONTRADICTS,
            Outcome.INFEASIBLE,
            Outcome.NOT_REPRODUCIBLE,
        ):
            assert entry.ruling.why, entry.place
        if entry.ruling.outcome is Outcome.IMPOSSIBLE:
            assert entry.ruling.why.endswith("fails")


@pytest.mark.parametrize("paper", KEYS)
def test_every_row_and_column_of_every_table_stands_on_the_page(reproduced, tmp_path, paper, monkeypatch):
    entries, runs = reproduced[paper]
    if paper not in DRAWN:
        monkeypatch.setattr(page, "_drawn", lambda *arguments: ())
    text = write_paper(paper, entries, runs, TINY, tmp_path, {"Python": "3"}).read_text(encoding="utf-8")
    parsed = Page(text)
    assert set(parsed.found) == set(tables(paper))
    for number, table in tables(paper).items():
        rows, columns = list(dict.fromkeys(c.row for c in table.cells)), list(table.columns)
        cells = [shown(c.printed) for c in table.cells]
        if number in parsed.turned:
            rows, columns = columns, rows
            cells = [shown(table[row, column].printed) for column in rows for row in columns]
        assert parsed.found[number] == {"row": rows, "col": columns, "cell": cells}
    for identity in claims(paper):
        assert f'id="{identity}"' in text
    assert ("<svg" in text.split('id="figures"')[1].split('id="readings"')[0]) == (paper in DRAWN)
    assert "mathdefault" not in text
    assert not re.search(r'(?:src|href)="(?:https?:)?//', text.replace('href="https://doi.org', ""))
    with (tmp_path / f"{paper}.csv").open(encoding="utf-8") as file:
        records = list(csv.DictReader(file))
    assert [record["verdict"] for record in records] == [entry.ruling.outcome.value for entry in entries]


def test_the_index_keeps_every_paper_that_lies_there(reproduced, tmp_path, monkeypatch):
    monkeypatch.setattr(page, "_drawn", lambda *arguments: ())
    total = 0
    for paper in KEYS[:2]:
        entries, runs = reproduced[paper]
        write_paper(paper, entries, runs, TINY, tmp_path, {})
        text = write_index(TINY, tmp_path, {}).read_text(encoding="utf-8")
        total += len(entries)
        with (tmp_path / "verdicts.csv").open(encoding="utf-8") as file:
            assert len(list(csv.DictReader(file))) == total
        assert sum(int(n) for n in re.findall(r'<span class="count">(\d+)</span>', text)) == total
    for paper in KEYS:
        assert (f'href="{paper}.html"' in text) == (paper in KEYS[:2])


def test_cells_of_another_version_are_named(reproduced, tmp_path, monkeypatch):
    entries, runs = reproduced[KEYS[1]]
    monkeypatch.setattr(page, "_drawn", lambda *arguments: ())
    write_paper(KEYS[1], entries, runs, TINY, tmp_path, {})
    (tmp_path / f"{KEYS[1]}.csv").write_text("paper,verdict\n", encoding="utf-8")
    with pytest.raises(StudyError, match="another version; reproduce that paper again"):
        write_index(TINY, tmp_path, {})


@pytest.mark.parametrize("paper", KEYS)
def test_kinds_of_evidence_are_never_added_up(reproduced, paper):
    entries, _ = reproduced[paper]
    counts = counts_of(entries)
    assert sum(sum(outcomes.values()) for outcomes in counts.values()) == len(entries)
    for entry in entries:
        by_runs = entry.ruling.basis in (Basis.RUNS, Basis.FITTED)
        assert by_runs or entry.ruling.outcome is not Outcome.REPRODUCED, entry
        assert not by_runs or entry.ruling.outcome not in (Outcome.CONSISTENT, Outcome.USED), entry
    said = " ".join(sentences(counts))
    for basis in (Basis.RUNS, Basis.PRINT, Basis.FORMULA):
        agreeing = sum(counts[basis].get(outcome, 0) for outcome in AGREEING)
        assert f" {agreeing} are " in said
    assert (
        f"{sum(e.ruling.outcome in CANNOT_STAND for e in entries)} printed numbers or statements cannot stand" in said
    )


@pytest.mark.parametrize("paper", KEYS)
def test_every_main_claim_stands_with_what_became_of_it(reproduced, paper):
    entries, _ = reproduced[paper]
    for main in decided(paper, entries):
        assert main.entries, main.claim
        against = [e for e in main.entries if e.ruling.outcome not in (*KEPT, *OPEN)]
        assert main.failing is (against[0] if against else None)
        assert main.fate.startswith("stands") == any(e.ruling.outcome in KEPT for e in main.entries), main.claim


@pytest.mark.parametrize(
    ("rulings", "fate"),
    [
        ([(Outcome.REPRODUCED, Basis.RUNS)], "stands"),
        ([(Outcome.CONSISTENT, Basis.PRINT)], "stands; by calculation alone, no run stands behind it"),
        (
            [(Outcome.REPRODUCED, Basis.FITTED), (Outcome.WORSE, Basis.RUNS), (Outcome.UNDECIDED, Basis.RUNS)],
            "stands in part, by 1 of 2 tests; with constants fitted to the same table; 1 undecided",
        ),
        ([(Outcome.NOT_CONFIRMED, Basis.RUNS)], "does not stand"),
        (
            [(Outcome.BETTER, Basis.RUNS), (Outcome.CONTRADICTS, Basis.PRINT)],
            "stands in part, by 1 of 2 tests; our runs do better in 1",
        ),
        ([(Outcome.NOT_REPRODUCIBLE, Basis.NOTHING)], "is open; 1 cannot be reproduced"),
    ],
)
def test_the_fate_of_a_claim_is_said_in_one_line(rulings, fate):
    entries = [
        Entry("p", claim("c"), "Section 1", "a claim", "claim", "1", Ruling(outcome, basis=basis))
        for outcome, basis in rulings
    ]
    assert Decided("the claim", entries).fate == fate


def test_a_verdict_of_most_cells_of_a_column_stands_in_its_head_only(reproduced):
    entries, _ = reproduced["ur5-tadf-ssa"]
    uniform = shown_table(tables("ur5-tadf-ssa")["Table 3"], entries)
    assert uniform.everywhere.ruling.outcome is Outcome.CONSISTENT
    mixed = shown_table(tables("ur5-tadf-ssa")["Table 5"], entries)
    for column in mixed.table.columns:
        outcomes = [e.ruling.outcome for e in entries if (e.place.table, e.place.column) == ("Table 5", column)]
        marked = [mixed.marked(e) for e in entries if (e.place.table, e.place.column) == ("Table 5", column)]
        assert all(marked) == (column not in mixed.usual)
        assert (column in mixed.usual) == any(2 * outcomes.count(outcome) > len(outcomes) for outcome in outcomes)


def test_segments_of_durations_carry_no_verdict_of_their_own(reproduced):
    for found, _ in reproduced.values():
        for entry in found:
            assert (entry.ruling.outcome is Outcome.PART) <= (entry.quantity in ("duration", "claim"))
            if entry.quantity == "duration" and entry.place.column not in ("initialisation", "total time"):
                assert entry.ruling.outcome is Outcome.PART, entry.place


def test_an_inferred_limit_makes_no_motion_infeasible(reproduced):
    outcomes = {e.ruling.outcome for e in reproduced["puma560-chaotic-spso"][0]}
    assert Outcome.EXCEEDS_INFERRED in outcomes
    assert Outcome.INFEASIBLE not in outcomes
    assert Outcome.EXCEEDS_INFERRED not in CANNOT_STAND


def test_a_missing_ruling_is_an_error(reproduced, monkeypatch):
    _, runs = reproduced["ur5-tadf-ssa"]
    kind = PAPERS["ur5-tadf-ssa"]
    whole = kind(TINY, runs).rulings()
    monkeypatch.setattr(kind, "rulings", lambda self: dict(list(whole.items())[1:]))
    with pytest.raises(StudyError, match="no ruling on Table 2, 1 / x"):
        entries_of("ur5-tadf-ssa", runs, TINY)


def test_the_committed_verdicts_name_exactly_what_is_printed(reproduced):
    committed = command.read_committed(command.committed_path())
    flat = [entry for found, _ in reproduced.values() for entry in found]
    assert set(committed) == {command.key_of(entry) for entry in flat}
    assert set(committed.values()) <= {outcome.value for outcome in Outcome}
    # what is no result of chance does not depend on the effort either
    given = {
        command.key_of(e): e.ruling.outcome.value
        for e in flat
        if e.ruling.outcome in (Outcome.USED, Outcome.IMPOSSIBLE, Outcome.CONSISTENT, Outcome.PART)
    }
    assert {key: committed[key] for key in given} == given


def test_a_changed_verdict_is_said(reproduced, tmp_path):
    entries, _ = reproduced["aubo-dynamic-adaptive-pso"]
    command.write_committed(entries, tmp_path / "verdicts.csv")
    committed = command.read_committed(tmp_path / "verdicts.csv")
    assert command.changes(entries, committed) == []
    key = command.key_of(entries[0])
    assert f"{' / '.join(key)}: better -> used as given" in command.changes(entries, committed | {key: "better"})[0]
    with pytest.raises(StudyError, match="no table of verdicts"):
        command.read_committed(tmp_path / "none.csv")


CELL = BenchmarkJob("woodworking-golds-pso", "F5", "standard", PSO(), 6, 5, 3)


def test_a_benchmark_cell_is_plain_minimisation():
    record, function = CELL.run(), CELL.benchmark
    best = []
    for seed in range(3):
        meter = Meter(lambda x: function.formula(x), 30)
        minimise(PSO(), meter, Box(function.lower, function.upper), 6, np.random.default_rng(seed))
        best.append(meter.incumbent_value)
    assert len(record["finals"]) == 3
    assert min(best) / 10 < np.mean(record["finals"]) < 10 * max(best)
    assert record["curve"][-1] == pytest.approx(np.median(record["finals"]))
    assert record["generations"][-1] == 5
    assert CELL.run()["finals"] == record["finals"]


@pytest.mark.parametrize(
    ("search", "text"),
    [
        (
            PSO(),
            "PSO(inertia=(0.9, 0.4), cognitive=2.0, social=2.0, flight=Flight(clamp=0.2, unit='share', bounds='clip'))",
        ),
        (SCA(), "SCA(amplitude=2.0, bounds='clip')"),
    ],
)
def test_random_streams_stay_as_they_were_when_the_verdicts_were_committed(search, text):
    job = BenchmarkJob("ur5-smwoa", "F2", "standard", search, 5, 3, 2)
    assert job._stream() == zlib.crc32(f"('ur5-smwoa', 'F2', {text})".encode())


def test_a_joint_that_stands_still_is_fastest_at_the_least_durations():
    lower = load_case("puma560").problem.duration_bounds[0]
    assert OptimumJob("puma560", 3).run()["durations"] == [lower] * 3


def test_convergence_is_counted_from_the_descent():
    assert settled_at(np.array([10.0, 5.0, 0.005, 0.0, 0.0]), 1e-3) == 3
    assert settled_at(np.array([10.0, 5.0, 0.4, 0.0, 0.0]), 5e-2) == 3
    assert settled_at(np.array([1.0, 1.0]), 1e-3) == 1
    assert settled_at(np.array([np.inf, 2.0, 1.0]), 1e-3) == 2
    assert arrived_at(np.array([3.0, 1.0, 1.0])) == 2
    assert thinned(1000)[[0, -1]].tolist() == [0, 999]


def test_the_four_definitions_are_nested_and_a_descent_at_the_end_is_marked():
    curve = np.geomspace(1e3, 1.0, 100)
    record = {"settled": settled([curve, curve]), "generations": [1, 100]}
    found = list(levels(record).values())
    assert list(levels(record)) == list(LEVELS) == ["0.1 %", "1 %", "2 %", "5 %"]
    assert found == sorted(found, reverse=True)
    steep = {"settled": settled([np.linspace(10.0, 0.0, 100)]), "generations": [1, 100]}
    assert late([steep]) == list(LEVELS)
    assert late([{**record, "generations": [1, 200]}]) == []
    assert settled([curve[90:]], [90])["5 %"][0] > 90


def test_faster_on_most_joints_is_less_than_faster_on_all():
    """Records made by hand: earlier on two of three joints at every share of the descent."""
    early, same = list(range(1, 13)), list(range(40, 52))
    steps = {("own", j): early if j < 2 else same for j in range(3)} | {("other", j): same for j in range(3)}
    runs = {job: {"settled": dict.fromkeys(LEVELS, counts)} for job, counts in steps.items()}
    paper = PAPERS["aubo-dynamic-adaptive-pso"](TINY, runs)
    own, other = (lambda j, name=name: (name, j) for name in ("own", "other"))
    assert paper.everywhere(own, other, range(3)).outcome is Outcome.NOT_CONFIRMED
    assert paper.everywhere(own, other, range(3), most=True).outcome is Outcome.REPRODUCED
    assert paper.everywhere(other, own, range(3), most=True).outcome is Outcome.NOT_CONFIRMED


def test_a_reason_names_a_few_places_and_counts_the_rest():
    assert named(["a", "b"]) == "a; b"
    assert named([f"F{k}" for k in range(9)]) == "F0; F1; F2; F3; F4; F5 and 3 more"


def stored(jobs, path, workers=1, **options):
    """Run jobs through the one pool and the one store; their records and the store's digest."""
    with Store(path) as store:
        run_jobs(jobs, store, workers=workers, **options)
        return Runs(store.outcomes(jobs)), store.digest()


def test_records_are_kept_by_content_and_a_repeat_runs_nothing(tmp_path):
    first, _ = stored([CELL], tmp_path / "r")
    again, _ = stored([CELL, CELL], tmp_path / "r", on_outcome=lambda *told: pytest.fail("ran again"))
    assert again[CELL] == first[CELL]
    assert first[CELL]["finals"] == CELL.run()["finals"]
    other = BenchmarkJob("woodworking-golds-pso", "F5", "standard", PSO(cognitive=1.9), 6, 5, 3)
    assert key_of(other) != key_of(CELL)
    with pytest.raises(StudyError, match="nothing was run"):
        first[other]


def test_neither_the_number_of_workers_nor_measured_seconds_change_the_digest(tmp_path):
    jobs = [CELL, MotionJob("woodworking", PSO(), 0, 5, 4, 2), OptimumJob("woodworking", 0), KinematicsJob(4, 1)]
    (alone, digest), (pooled, other) = (stored(jobs, tmp_path / str(workers), workers) for workers in (1, 2))
    assert digest == other
    assert alone[jobs[1]] == pooled[jobs[1]]
    assert alone[jobs[3]]["seconds"] != pooled[jobs[3]]["seconds"]
    assert verify(tmp_path / "1") == (4, [])


@pytest.mark.parametrize(
    "job",
    [
        CELL,
        MotionJob("woodworking", PSO(), 0, 5, 4, 2),
        OptimumJob("woodworking", 0),
        KinematicsJob(4, 1),
        *attempts("rrt", 1, 5, 4),
    ],
    ids=lambda job: job.kind,
)
def test_a_job_names_every_planner_that_it_asks_the_registry_for(job, monkeypatch):
    asked, load = set(), registry._load
    monkeypatch.setattr(registry, "_load", lambda kind, name, path: asked.add(name) or load(kind, name, path))
    job.run()
    assert asked == set(job.planners())


@pytest.mark.parametrize(
    ("trouble", "reason"),
    [
        ("crash", "ended by SIGSEGV during this troubled"),
        ("hang", "time limit of 0.5 s"),
        ("raise", "IndexError: list"),
    ],
)
@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_run_that_crashes_or_hangs_is_one_sentence_and_the_others_are_kept(tmp_path, trouble, reason, elsewhere):
    with (
        ThreadPoolExecutor(1) as executor,
        pytest.raises(StudyError, match=f"failed: .*{reason}.*finished jobs are stored"),
    ):
        stored([CELL, TroubledJob(trouble)], tmp_path / "r", executor=executor if elsewhere else None)
    assert verify(tmp_path / "r") == (1, [])


def test_one_domain_and_the_nearest_of_eight_find_the_same():
    robot = robot_named("ur5e-ssa")
    q = helix_configurations(robot)
    poses = robot.forward(q)
    turned = np.mod(nearest(inverse(robot, poses), q[:, None]) - q + np.pi, 2 * np.pi) - np.pi
    assert np.abs(turned).max() < 1e-6
    assert np.abs(np.mod(inverse(robot, poses, BRANCH) - q + np.pi, 2 * np.pi) - np.pi).max() < 1e-6


def test_inverse_timing_measures_four_ways():
    seconds = KinematicsJob(poses=8, repeats=1).run()["seconds"]
    assert len(seconds) == 4
    assert min(seconds.values()) > 0
    assert seconds["scalar one"] < seconds["scalar eight"]


def test_nsga2_keeps_limits_and_box():
    pytest.importorskip("pymoo")
    case = load_case("puma560")
    found = GeneticJob("puma560", 0, 20, 30, 1).run()["durations"][0]
    lower, upper = case.problem.duration_bounds
    assert all(lower <= value <= upper for value in found)
    assert judge(case.problem.joint(0), motion_of(case, np.array(found), 0)).feasible


def test_attempts_cover_every_world_once():
    seeds = [seed for job in attempts("rrt", 23, 5, 5) for seed in range(job.first, job.first + job.count)]
    assert seeds == list(range(23))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["reproduce"], "not neither"),
        (["reproduce", "aubo", "--all"], "not both"),
        (["reproduce", "aubos"], "did you mean 'aubo'"),
        (["reproduce", "--all", "--quick", "--commit"], "without --quick"),
    ],
)
def test_mistakes_on_the_command_line(arguments, said, tmp_path):
    result = CliRunner().invoke(app, [*arguments, "--out", str(tmp_path)])
    assert isinstance(result.exception, StudyError)
    assert said in str(result.exception)


def test_the_command_leaves_pages_and_cells(tmp_path, monkeypatch, threads):
    monkeypatch.setattr(command, "QUICK", TINY)
    console = Console(record=True, width=160)
    monkeypatch.setattr(command, "make_console", lambda: console)
    monkeypatch.setattr(page, "_drawn", lambda *arguments: ())
    command.reproduce_command("aubo", quick=True, out=tmp_path, jobs=1)
    folder = tmp_path / "report" / "reproduction"
    assert {path.name for path in folder.iterdir()} >= {"index.html", "verdicts.csv", f"{paper_named('aubo')}.html"}
    assert "reproduced" in console.export_text()
    assert "tiny: for tests" in (folder / "index.html").read_text(encoding="utf-8")


def test_a_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="choose another"):
        write_cells(tmp_path / "file" / "cells.csv", [])


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_the_full_reproduction_gives_the_committed_verdicts(tmp_path):
    """Paper scale. Also the targets: mean cells within one order of magnitude under the stated readings."""
    pytest.importorskip("pymoo")
    runs, _ = stored(jobs_of(KEYS, FULL), tmp_path / "r", None)
    entries = {paper: entries_of(paper, runs, FULL) for paper in KEYS}
    for paper, columns in (("woodworking-golds-pso", 5), ("puma560-chaotic-spso", 3)):
        means = [
            entry
            for entry in entries[paper]
            if entry.place.table == "Table 3"
            and entry.quantity == "mean"
            and not (columns == 3 and entry.place.column == "SPSO")
        ]
        assert len(means) == (40 if columns == 5 else 18)
        assert [(e.place, e.ruling.ours) for e in means if not e.ruling.agrees] == []
    flat = [entry for found in entries.values() for entry in found]
    assert command.changes(flat, command.read_committed(command.committed_path())) == []
