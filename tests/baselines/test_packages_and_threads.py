"""Planners without their packages, and planners in several threads: each in an interpreter of its own."""

import subprocess
import sys

WITHOUT = """
import sys
sys.modules.update(dict.fromkeys(("casadi", "toppra", "ruckig")))
from study.registry import unavailable_planners
for name, reason in unavailable_planners().items():
    print(f"{name}: {reason}")
"""

TOGETHER = """
import threading
from baselines.segment_times import model
model.MOST_MODELS = 1  # threads drop one another's models
from study.planning import RunSettings
from study.registry import planner_named
from study.testing.conformance import example_problems

problems, lines = example_problems(), []

def run(name, k):
    settings = RunSettings("cubic-spline", formulation="scaled", time_limit=20.0)
    for problem in (problems[(k + 2) % 3], problems[k % 3]):
        plan = planner_named(name).plan(problem, settings)
        lines.append(f"{name} {problem.name}: {plan.motion.duration:.9g}")

names = ["casadi-nlp", "bspline-nlp", "quintic-nlp", "free-path-nlp", "casadi-nlp", "quintic-nlp"]
threads = [threading.Thread(target=run, args=(name, k)) for k, name in enumerate(names)]
for thread in threads:
    if SERIAL:
        thread.run()
    else:
        thread.start()
for thread in threads * (not SERIAL):
    thread.join()
print(*sorted(lines), sep="\\n")
"""


def printed(code: str) -> list[str]:
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=110)
    assert ended.returncode == 0, ended.stderr
    assert ended.stderr == ""  # nor does an object complain that outlives the modules
    return ended.stdout.splitlines()


def test_a_planner_whose_package_is_missing_is_named_with_the_package():
    reasons = dict(line.split(": ", 1) for line in printed(WITHOUT))
    for name, package in {"casadi-nlp": "casadi", "free-path-nlp": "casadi", "toppra": "toppra"}.items():
        assert f"needs the Python package {package!r}, which is not installed" in reasons[name]
    assert "'ruckig'" in reasons["ruckig-stops"]
    assert "golds-pso" not in reasons


def test_threads_that_plan_at_once_find_what_they_find_one_after_the_other():
    together = printed(f"SERIAL = False{TOGETHER}")
    assert len(together) == 12
    assert together == printed(f"SERIAL = True{TOGETHER}")
