"""Shared by the tests: comparisons."""

from dataclasses import replace

from study.cases.library import load_case
from study.comparison.effort import QUICK

TINY = replace(
    QUICK,
    seeds=2,
    evaluations=120,
    trial_seeds=2,
    trial_evaluations=90,
    function_seeds=2,
    dimensions=4,
    generations=6,
    functions=("sphere",),
    solvers=("ruckig-stops",),
    audit_cases=("woodworking",),
)


CASES = {name: load_case(name) for name in ("puma560", "woodworking")}
