"""Fixtures of the store's tests: a few results of stub planners."""

import pytest

from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells


@pytest.fixture
def cells(stubs, tiny_case):
    return make_cells([tiny_case], [Spec("stub-steady"), Spec("stub-seeded")], Budget(3, 50))


@pytest.fixture
def results(cells, tiny_problem):
    return [CellJob(cell, tiny_problem).run() for cell in cells]
