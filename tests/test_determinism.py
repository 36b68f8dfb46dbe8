import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from study.cases.library import load_case
from study.code_digest import _imports, code_digest
from study.deadline import NEVER, Deadline
from study.planning import Status
from study.problem import JointLimits
from study.registry import planner_code
from study.runs.execute import CellJob, cell_jobs, stored_results
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.runner import run_jobs
from study.store.store import Store
from study.supervisor import supervised


def digest_of(folder, jobs, planners, seeds):
    case = load_case("woodworking")
    cells = make_cells([case], parse_specs(planners), Budget(seeds, 300))
    with Store(folder / f"{jobs}.sqlite") as store:
        run_jobs(cell_jobs(cells, {case.name: case}), store, workers=jobs)
        return len(stored_results(store, cells, {case.name: case})), store.digest(), store.cut_short()


@pytest.mark.slow
def test_a_study_has_the_same_results_with_one_worker_and_with_two(tmp_path):
    planners = "pso,golds-pso:scaled,shared,smwoa,tadf-ssa,casadi-nlp,toppra,ruckig-stops"
    one, two = (digest_of(tmp_path, jobs, planners, 2) for jobs in (1, 2))
    assert one == two
    assert one[0] == 11
    assert one[2] == 0


SEARCHES = "pso,tadf-ssa,smwoa:scaled,shared,chaotic-spso:scaled,shared,de:scaled,shared,random-search:scaled,shared"
COLUMNS = "subject, label, seed, status, feasible, evaluations, duration, worst_ratio"


def columns_of(path, engine, monkeypatch):
    """Run a small study whose kernels are those of one engine; give its result columns."""
    monkeypatch.setenv("STUDY_ENGINE", engine)
    cases = {name: load_case(name) for name in ("woodworking", "ur5-bspline")}
    cells = make_cells(cases.values(), parse_specs(f"{SEARCHES},certified,toppra"), Budget(2, 400))
    with Store(path) as store:
        run_jobs(cell_jobs(cells, cases), store, workers=1)
        return store._connection.execute(f"SELECT {COLUMNS} FROM results ORDER BY 1, 2, 3").fetchall()


@pytest.mark.timeout(400)
def test_a_study_has_the_same_results_with_numpy_and_with_numba(tmp_path, monkeypatch):
    """Kernels agree to rounding; up to 400 evaluations these searches make nothing more of it."""
    pytest.importorskip("numba", reason="the compiled kernels are an extra")
    plain, compiled = (columns_of(tmp_path / engine, engine, monkeypatch) for engine in ("numpy", "numba"))
    assert [row[:6] for row in plain] == [row[:6] for row in compiled]
    np.testing.assert_allclose([row[6:] for row in plain], [row[6:] for row in compiled], rtol=1e-12)
    exact = [row for row in plain if row[1] in ("certified", "toppra")]
    assert exact == [row for row in compiled if row[1] in ("certified", "toppra")]
    assert len(exact) == 4
    assert len(plain) == 4 + 2 * 6 * 2


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_a_study_has_the_same_results_under_every_python(tmp_path):
    """Give the other interpreters, with this package installed, in STUDY_OTHER_PYTHONS."""
    others = list(filter(None, os.environ.get("STUDY_OTHER_PYTHONS", "").split(os.pathsep)))
    if not others:
        pytest.skip("STUDY_OTHER_PYTHONS names no interpreters")
    plain = f"{SEARCHES},golds-pso,casadi-nlp,certified,any-motion-bound,toppra,ruckig-via,topp3-nlp,bspline-nlp"
    asked = ["--cases", "woodworking,ur5-bspline", "--planners", plain, "--evaluations", "400", "--seeds", "2"]
    digests = {}
    for k, python in enumerate([sys.executable, *others]):
        study = [python, "-m", "study"]
        out = ["--out", str(tmp_path / str(k))]
        subprocess.run([*study, "run", *asked, "--no-report", "--time-limit", "600", *out], check=True)
        digests[python] = subprocess.run([*study, "digest", *out], check=True, capture_output=True, text=True).stdout
    print(digests)
    assert len(set(digests.values())) == 1


@pytest.mark.parametrize(
    "planner",
    [
        "certified",
        "casadi-nlp",
        "ruckig-via",
        "free-path",
        "free-path-nlp",
        "quintic-nlp",
        "topp3-nlp",
        "bspline-nlp",
        "any-motion-bound",
    ],
)
def test_what_a_clock_decided_says_so(planner):
    """With next to no time every planner that looks at the clock must say that it did."""
    case = load_case("woodworking")
    velocity, acceleration, _ = case.problem.limits.rates
    problem = replace(case.problem, limits=JointLimits(velocity, acceleration, np.full(case.problem.n_joints, 60.0)))
    cell = make_cells([case], parse_specs(planner), Budget(1, 50, 1e-4))[0]
    result = CellJob(cell, problem).run()
    assert result.status in (Status.TIMED_OUT, Status.FAILED)
    assert result.status is not Status.FAILED or "time" in result.message.lower()
    if result.status is Status.TIMED_OUT:
        assert result.message.endswith("a time limit inside the planner was reached")


def test_deadlines_are_recorded_however_deep_and_only_inside_the_block():
    late, soon = Deadline.after(-1.0), Deadline.after(3600.0)
    with supervised() as outer:
        assert not NEVER.passed()
        assert not soon.passed()
        assert not outer.deadline_reached
        with supervised() as inner:
            assert late.passed()
        assert (inner.deadline_reached, outer.deadline_reached) == (True, False)
    assert late.passed()
    assert late.left() == 0.0 < soon.within(60.0).left() <= 60.0 < soon.left()


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package whose planner uses one of its modules and not the other."""
    folder = tmp_path / "strange"
    folder.mkdir()
    files = {
        "__init__": "",
        "planner": "from . import used\nfrom .deeper import more\nfrom study.curves import curve_named\n",
        "used": "X = 1\n",
        "unused": "Y = 1\n",
        "deeper/__init__": "import strange.last\n",
        "deeper/more": "raise RuntimeError('nothing is run to read what it imports')\n",
        "last": "",
    }
    for name, text in files.items():
        (folder / f"{name}.py").parent.mkdir(exist_ok=True)
        (folder / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    return folder


def fresh_digest(module):
    for cached in (
        code_digest,
        _imports,
        *(vars(sys.modules[code_digest.__module__])[n] for n in ("_source", "_text", "_file_digest")),
    ):
        cached.cache_clear()
    return code_digest(module)


def test_code_that_a_planner_uses_is_part_of_its_version_and_no_other(package):
    first = fresh_digest("strange.planner")
    for name, matters in [("unused", False), ("used", True), ("deeper/more", True), ("last", True), ("__init__", True)]:
        file, before = package / f"{name}.py", fresh_digest("strange.planner")
        file.write_text(file.read_text() + "Z = 1\n")
        assert (fresh_digest("strange.planner") != before) == matters, name
    assert fresh_digest("strange.planner") != first


def test_the_digest_does_not_depend_on_where_the_package_stands_or_how_its_lines_end(package, tmp_path, monkeypatch):
    before = fresh_digest("strange.planner")
    shutil.copytree(package, tmp_path / "elsewhere" / "strange")
    shutil.rmtree(package)
    for file in (tmp_path / "elsewhere").rglob("*.py"):
        file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
    monkeypatch.syspath_prepend(str(tmp_path / "elsewhere"))
    assert fresh_digest("strange.planner") == before


@pytest.mark.parametrize(
    ("edited", "matters"),
    [("study.search.compiled", False), ("study.search.pso", True), ("study.curves.compiled.peaks", True)],
)
def test_compiled_searches_give_the_same_bits_and_so_are_no_part_of_a_version(edited, matters, monkeypatch):
    module = sys.modules[code_digest.__module__]
    real, before = module._file_digest, code_digest("study.planners.woodworking")
    monkeypatch.setattr(module, "_file_digest", lambda name: "edited" if name == edited else real(name))
    assert (code_digest.__wrapped__("study.planners.woodworking") != before) == matters


def test_planners_that_share_nothing_have_versions_of_their_own():
    versions = {name: planner_code(name) for name in ("pso", "toppra", "ruckig-stops", "casadi-nlp")}
    assert len(set(versions.values())) == 4
    assert all(version.startswith("time-optimal-study ") for version in versions.values())
    assert Path(sys.modules["study"].__file__).is_file()
