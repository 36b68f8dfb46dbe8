import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = sorted(path for package in ("study", "baselines") for path in (ROOT / package).rglob("*.py"))
OWNERS = {
    "casadi": ("baselines/ipopt.py",),
    "toppra": (
        "baselines/path_timing/toppra.py",
        "baselines/path_timing/arm_limits.py",
        "baselines/peers/toppra_package.py",
        "study/bench/references.py",
        "study/bench/torque_peers.py",
    ),  # as a peer, by its own defaults
    "ruckig": ("baselines/state_to_state/moves.py", "baselines/peers/ruckig_chain.py", "study/bench/planner_parts.py"),
    **dict.fromkeys(("justblend", "roboplan", "tesseract_robotics", "pyroboplan"), ("baselines/peers/",)),
    "rerun": ("study/recording/",),
    "matplotlib": (
        "study/report/bars.py",
        *(
            f"study/{part}/figures.py"
            for part in ("report", "reproduction", "comparison", "suites", "bench", "notebook")
        ),
    ),
    "numba": ("study/curves/compiled/kernels.py", "baselines/free_path/compiled"),
    "pickle": ("study/runs/pool.py",),  # between the run's own processes only
}


def loaded_after(statement: str) -> set[str]:
    """Top-level modules that a fresh interpreter has loaded after a statement."""
    code = f"{statement}\nimport sys\nprint(*sorted({{name.partition('.')[0] for name in sys.modules}}))"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    return set(ended.stdout.split())


def test_the_question_and_the_command_load_no_solver_viewer_or_plotter():
    heavy = {"casadi", "toppra", "ruckig", "rerun", "matplotlib", "baselines", "mealpy", "pymoo", "cmaes", "numba"}
    assert not loaded_after("import study, study.cli.main") & heavy


def test_a_planner_loads_its_own_package_only():
    loaded = loaded_after("from study.registry import planner_named\nplanner_named('golds-pso')")
    assert not loaded & {"casadi", "toppra", "ruckig", "rerun", "matplotlib", "baselines"}


@cache
def imported(path: Path) -> set[str]:
    """Packages that a file imports, also by name through importlib."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add((node.module or "").partition(".")[0])
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "import_module":
            found |= {a.value.partition(".")[0] for a in node.args if isinstance(a, ast.Constant)}
    return found


@pytest.mark.parametrize("package", OWNERS)
def test_heavy_packages_are_imported_in_their_own_files_only(package):
    users = [path.relative_to(ROOT).as_posix() for path in SOURCES if package in imported(path)]
    assert not [path for path in users if not path.startswith(OWNERS[package])]


def test_nobody_sends_waypoints_to_a_server():
    assert not [
        path for path in SOURCES if re.search(r"intermediate_positions\s*=|\.intermediate_positions", path.read_text())
    ]
