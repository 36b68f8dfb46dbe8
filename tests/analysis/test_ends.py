"""The remark on a motion that starts or ends with a step."""

import pytest

from study.analysis.case_summary import summarise_case
from study.analysis.ends import end_steps
from study.cases.library import load_case
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("ur5-helix", "starts joint 2 at once with acceleration −0.6981 rad/s² (100 % of its limit)"),
        ("woodworking", ""),
        ("ur5-helix-smooth", ""),
    ],
)
def test_a_step_at_an_end_is_said_beside_the_optimum(name: str, said: str) -> None:
    case = load_case(name)
    results = [CellJob(cell, case.problem).run() for cell in make_cells([case], [Spec("casadi-nlp")], Budget(1, 10))]
    text = end_steps(summarise_case(case, results))
    assert said in text
    assert ("`ur5-helix-smooth` is the same case" in text) == bool(said)
