"""What a notebook shows of `plan` and `compare`: cards, figures, and the recording in place."""

import os
import re
import sys
from dataclasses import replace
from types import ModuleType, SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

from study import JointLimits, Problem, StudyError, compare, plan
from tests.helpers.recordings import chunks, series

FOUR = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])
LIMITS = JointLimits(np.array([1.0, 0.8]), np.array([2.0, 1.5]), np.array([20.0, np.inf]))
PROBLEM = Problem("mine <b>", FOUR, LIMITS, joint_names=["base & foot", "elbow"])


@pytest.fixture(scope="module")
def planned():
    return plan(PROBLEM, "ruckig-stops")


def test_a_plan_is_three_lines_of_text(planned):
    first, tried, warned = repr(planned).splitlines()
    assert first.startswith(f"Planned 'mine <b>': {planned.duration:.6g} s by ruckig-stops, feasible")
    assert (tried, warned) == ("tried: ruckig-stops", "warnings: none")


def test_a_card_has_verdict_profile_and_shares(planned):
    card = planned._repr_html_()
    assert f"<strong>mine &lt;b&gt;: {planned.duration:.6g} s, feasible</strong>" in card
    assert "ruckig-stops: it was asked for" in card
    assert "base &amp; foot" in card
    assert "no limit" in card
    assert f"{100 * planned.verdict.ratios[0, 0]:.2f} %" in card
    assert len(card) < 80_000
    tree = ElementTree.fromstring(card)
    assert len(tree.findall(".//{http://www.w3.org/2000/svg}svg")) == 1
    assert not re.search(r'(src|href)="https?:', card)


def test_a_card_says_what_is_wrong(planned):
    weak = plan(replace(PROBLEM, limits=JointLimits(LIMITS.velocity)), "straight")._repr_html_()
    assert "no arm can follow such a motion" in weak
    broken = plan(PROBLEM, "toppra-quick")._repr_html_()
    assert "s, infeasible</strong>" in broken
    assert "acceleration of base &amp; foot jumps" in broken
    assert ": no motion</strong>" in plan(PROBLEM, "certified")._repr_html_()


def test_a_comparison_is_a_table():
    table = compare(PROBLEM, ["ruckig-stops", "certified"])._repr_html_()
    assert table.count("<tr>") == 3
    assert "<strong>mine &lt;b&gt;</strong>: 2 runs" in table
    assert table.index("ruckig-stops") < table.index("certified")


def test_plots_stand_against_the_limits(planned):
    figure = planned.plot()
    assert isinstance(figure, Figure)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[1:] == [
        "velocity, % of the limit",
        "acceleration, % of the limit",
        "jerk, % of the limit; joints without one are left out",
    ]
    for order, axes in enumerate(figure.axes[1:]):
        drawn = max(abs(line.get_ydata()).max() for line in axes.lines if len(line.get_ydata()) > 2)
        assert drawn == pytest.approx(100 * planned.verdict.ratios[order].max(), rel=1e-3)
    assert figure._repr_svg_().startswith("<svg")
    one = planned.plot("elbow")
    peak = abs(one.axes[1].lines[0].get_ydata()).max()
    assert peak == pytest.approx(planned.verdict.peaks[0, 1], rel=1e-3)
    assert one.axes[3].get_title(loc="left").endswith("no limit")
    assert planned.plot(1).axes[1].get_ylim() == one.axes[1].get_ylim()


@pytest.mark.parametrize("joint", ["wrist", 2, -1, True, 0.5])
def test_a_joint_that_is_not_there_is_one_sentence(planned, joint):
    with pytest.raises(StudyError, match="joint"):
        planned.plot(joint)


def test_limits_of_a_segment_are_what_a_share_is_taken_of():
    slow = {1: JointLimits(np.array([0.3, 0.3]))}
    planned = plan(replace(PROBLEM, segment_limits=slow), "ruckig-stops")
    drawn = max(abs(line.get_ydata()).max() for line in planned.plot().axes[1].lines if len(line.get_ydata()) > 2)
    assert drawn == pytest.approx(100 * planned.verdict.ratios[0].max(), rel=1e-3)


def test_show_leaves_a_recording_and_says_why_it_is_not_seen(planned, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("study.recording.process.sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    path = planned.show(tmp_path / "mine.rrd")
    assert capsys.readouterr().out.count("there is no display here") == 1
    assert len(series(path, "/q/elbow/ruckig-stops")[0]) > 100
    assert chunks(path, "/summary", "TextDocument:text")


def test_show_draws_an_arm_of_the_problems_joints(tmp_path, monkeypatch):
    monkeypatch.setattr("study.notebook.showing.view", lambda path: None)
    six = Problem("six", np.vstack([np.zeros(6), np.full(6, 0.4)]), JointLimits(np.ones(6), np.ones(6), np.full(6, 9)))
    path = plan(six, "ruckig-stops").show(tmp_path / "six.rrd", robot="ur5")
    assert chunks(path, "/arms/ruckig-stops/tool_path", "LineStrips3D:strips")
    with pytest.raises(StudyError, match="6 moving joints, the problem has 2"):
        plan(PROBLEM, "ruckig-stops").show(tmp_path / "two.rrd", robot="ur5")


@pytest.fixture
def kernel(monkeypatch):
    """A notebook's kernel, as far as `show` asks for one."""
    shown = []
    shell = SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setitem(sys.modules, "IPython.display", SimpleNamespace(display=shown.append))
    return shown


def test_in_a_notebook_the_missing_part_is_named(planned, tmp_path, kernel, monkeypatch, capsys):
    monkeypatch.setattr("study.recording.notebook.find_spec", lambda name: None)
    path = planned.show(tmp_path / "mine.rrd")
    said = capsys.readouterr().out
    assert path.exists()
    assert re.fullmatch(r"the recording is .*mine\.rrd; .*pip install rerun-notebook==\d.*\n", said)
    assert kernel == []


def test_in_a_notebook_the_viewer_gets_the_recording(planned, tmp_path, kernel, monkeypatch):
    module, sent = ModuleType("rerun_notebook"), []
    module.Viewer = lambda **size: SimpleNamespace(send_rrd=sent.append, **size)
    monkeypatch.setitem(sys.modules, "rerun_notebook", module)
    monkeypatch.setattr("study.recording.notebook.find_spec", lambda name: module)
    monkeypatch.delenv("RERUN_NOTEBOOK_ASSET", raising=False)
    path = planned.show(tmp_path / "mine.rrd")
    assert os.environ["RERUN_NOTEBOOK_ASSET"] == "inline"
    assert sent == [path.read_bytes()]
    assert len(kernel) == 1
