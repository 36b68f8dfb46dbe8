"""Limits of torque and of the tool in the recording and on the report's page."""

import numpy as np
import pytest

from study import JointLimits, Problem
from study.analysis.arm_uses import arm_uses
from study.analysis.case_summary import summarise_case
from study.arm import ArmLimits
from study.planning import usual_settings
from study.recording.arm_limits import SPEED, TORQUE
from study.recording.case_recording import record_case
from study.recording.stream import entity
from study.report.case_page import CaseReport, case_page
from study.report.own_page import own_page
from study.runs.execute import CellJob
from study.store.results import Cell
from tests.helpers.arms import two_links
from tests.helpers.recordings import columns

POINTS = np.array([[0.0, 0.1], [0.5, 0.5], [0.2, 0.9]])


@pytest.fixture
def summary(make_case):
    arm = ArmLimits(two_links(), [40.0, 9.5], tool_speed=0.25)
    case = make_case(Problem("walk", POINTS, JointLimits([1.5, 1.2], [5.0, 4.0], [50.0, 40.0]), arm=arm))
    cell = Cell(case.name, "ruckig-stops", "ruckig-stops", usual_settings(case.problem))
    return summarise_case(case, [CellJob(cell, case.problem).run()])


def test_the_recording_shows_torque_and_tool_speed_with_their_limits(summary, tmp_path):
    found = columns(record_case(summary, tmp_path / "walk.rrd", samples=40))
    for name, limit in ((TORQUE, 1.0), (SPEED, 0.25)):
        lines = {
            path: values
            for (path, kind), values in found.items()
            if path.startswith(entity("arm", name)) and "Scalars" in kind
        }
        heights = np.concatenate([np.ravel(np.array(values, dtype=float)) for values in lines.values()])
        assert len(lines) == 2
        assert heights.max() == pytest.approx(limit, rel=1e-3)


def test_the_report_says_how_much_of_the_arm_s_limits_is_used(summary):
    said = arm_uses(summary.case.problem, summary.methods[0].representative.verdict)
    assert list(said) == ["torque", "tool speed"]
    assert "m/s" in said["tool speed"]
    report = CaseReport(summary, "walk", {}, None, None, "walk.yaml", {})
    for page in (own_page(report, {}, {}), case_page(report, {}, {})):
        assert "tool speed" in page
        assert said["torque"] in page
