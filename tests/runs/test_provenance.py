"""Code behind a result: an edited file makes every job that depends on it anew, whatever its kind, and no other."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
OPTIMA = {"cell casadi-nlp", "optimum"}
WHALES = {f"{kind} woa" for kind in ("cell", "function trial", "case trial", "benchmark", "motion")}
TRIALS = {f"{kind} trial {name}" for kind in ("function", "case") for name in ("woa", "pso")}
SEARCHED = {f"{kind} {name}" for kind in ("cell", "case trial", "motion") for name in ("woa", "pso")}
EDITS = {
    "baselines/segment_times/nlp.py": ("", "\n# edited\n", OPTIMA),
    "study/search/woa.py": ("", "\n# edited\n", WHALES),
    "study/comparison/tasks.py": ("", "\n# edited\n", TRIALS),
    "study/pathfinding/rrt.py": ("", "\n# edited\n", {"path"}),
    "study/reproduction/genetic_runs.py": ("", "\n# edited\n", {"genetic"}),
    "study/reproduction/kinematics_runs.py": ("", "\n# edited\n", {"kinematics"}),
    "study/report/page.py": ("", "\n# edited\n", set()),
    "study/runs/pool.py": ("", "\n# edited\n", set()),
    "study/cli/main.py": ("", "\n# edited\n", set()),
    "study/judge.py": ("", "\n# edited\n", None),
    "data/cases/woodworking.yaml": ("lower: 1.0", "lower: 1.1", OPTIMA | SEARCHED | {"cell toppra"}),
    "data/robots/puma560-table1.yaml": ("a: 100,", "a: 101,", {"path"}),
}
"""By file of the tree: an edit, and the jobs that it makes anew; None for all of them."""

SCRIPT = """
import json, os, sys
from pathlib import Path

import study
from study import code_digest
from study.cases.library import _library, load_case
from study.comparison import tasks
from study.comparison.tasks import FunctionView, TrajectoryView
from study.comparison.trials import Trial, TrialJob
from study.reproduction.benchmark_runs import BenchmarkJob
from study.reproduction.genetic_runs import GeneticJob
from study.reproduction.kinematics_runs import KinematicsJob
from study.reproduction.motion_runs import MotionJob, OptimumJob
from study.reproduction.path_runs import PathJob
from study.robots import robot_named
from study.runs.execute import CellJob
from study.runs.lineup import Budget, make_cells, parse_specs
from study.search.pso import PSO
from study.search.woa import WOA
from study.store.kept import key_of
from study.store.provenance import code_behind


def jobs():
    case = load_case("woodworking")
    made = {
        "optimum": OptimumJob("woodworking", 0),
        "genetic": GeneticJob("puma560", 0, 6, 2, 1),
        "kinematics": KinematicsJob(4, 1),
        "path": PathJob("rrt", 0, 1, 5, 3),
    }
    for name in ("casadi-nlp", "toppra", "woa", "pso"):
        made[f"cell {name}"] = CellJob(make_cells([case], parse_specs(name), Budget(1, 40))[0], case.problem)
    for name, search in {"woa": WOA(), "pso": PSO()}.items():
        seen = Trial(name, "woodworking", TrajectoryView.AS_IT_IS, 0, 20, 5, formulation="scaled")
        made[f"function trial {name}"] = TrialJob(Trial(name, "sphere", FunctionView.ORIGIN, 0, 20, 5, 3), search, range(2))
        made[f"case trial {name}"] = TrialJob(seen, search, range(2), case.problem, case.curve)
        made[f"benchmark {name}"] = BenchmarkJob("woodworking-golds-pso", "F5", "standard", search, 5, 3, 2)
        made[f"motion {name}"] = MotionJob("woodworking", search, 0, 5, 3, 2)
    return made


def keys(file=""):
    'Keys by the sources and data as they are now: a fork forgets what it has read of them.'
    mine, theirs = os.pipe()
    if os.fork() == 0:
        for remembered in (code_digest.code_digest, code_digest._text, code_digest._file_digest, code_behind):
            remembered.cache_clear()
        if file.startswith("data/"):
            _library.cache_clear()
            robot_named.cache_clear()
        os.write(theirs, json.dumps({name: key_of(job) for name, job in jobs().items()}).encode())
        os._exit(0)
    os.close(theirs)
    os.wait()
    with open(mine) as answer:
        return json.load(answer)


tree = Path.cwd()
assert Path(study.__file__).is_relative_to(tree), study.__file__
for name in list(sys.modules):  # parses every source once; no edit changes an import
    code_digest.code_digest(name)
jobs()
after = {"": keys()}
for file, (old, new, _) in json.load(sys.stdin).items():
    text = (tree / file).read_text()
    assert old in text
    (tree / file).write_text(text.replace(old, new, 1) if old else text + new)
    after[file] = keys(file)
    (tree / file).write_text(text)
print(json.dumps(after))
"""


@pytest.fixture(scope="module")
def after(tmp_path_factory):
    """Keys of one job of every kind after each edit in a copy of the tree, and before any."""
    tree = tmp_path_factory.mktemp("tree")
    for part in ("study", "baselines", "data"):
        shutil.copytree(ROOT / part, tree / part, ignore=shutil.ignore_patterns("__pycache__"))
    edits = json.dumps({file: [*edit[:2], None] for file, edit in EDITS.items()})
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tree), os.environ.get("PYTHONPATH", "")])}
    ended = subprocess.run(
        [sys.executable, "-c", SCRIPT], input=edits, capture_output=True, text=True, cwd=tree, env=environment
    )
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks to read sources anew")
@pytest.mark.parametrize("file", EDITS)
def test_an_edited_file_makes_its_own_jobs_anew_and_no_others(after, file):
    before, expected = after[""], EDITS[file][2]
    changed = {name for name in before if after[file][name] != before[name]}
    assert changed == (set(before) if expected is None else expected)
