"""Short output for long inputs, on narrow and wide terminals."""

import numpy as np
import pytest
from rich.cells import cell_len

from study.cli import check
from study.cli.screen import SafeConsole
from study.cli.terminal import MOST_ROWS, times_text


@pytest.fixture(scope="module")
def big(tmp_path_factory):
    path = tmp_path_factory.mktemp("big") / "big.yaml"
    steps = np.random.default_rng(3).uniform(-2.5, 2.5, (30_000, 7)).round(4)
    rows = "".join(f"  - {row}\n" for row in steps.tolist())
    path.write_text(f"units: rad\nlimits: {{velocity: 2, acceleration: 10, jerk: 500}}\nwaypoints:\n{rows}")
    return path


@pytest.mark.parametrize("width", [60, 80, 200])
def test_thirty_thousand_waypoints_fill_no_more_than_a_page(study_command, monkeypatch, big, width):
    monkeypatch.setattr(check, "make_console", lambda: SafeConsole(width=width, markup=False, emoji=False))
    ended = study_command("check", big)
    assert ended.returncode == 0, ended.stderr
    assert "30000 waypoints" in ended.stdout
    assert "waypoints 9 to 29,992 are not shown" in ended.stdout
    assert len(ended.stdout.splitlines()) <= (60 if width >= 80 else 80)
    table = [line for line in ended.stdout.splitlines() if line.startswith(("│", "┃", "┏", "┡", "└", "┌"))]
    assert max(map(cell_len, table)) <= width


def test_times_of_many_waypoints_are_cut_in_the_middle():
    times = np.arange(MOST_ROWS + 1) / 10
    assert times_text(times[:-1], 9.0).count(", ") == MOST_ROWS - 1
    said = times_text(times, 9.0)
    assert said.startswith("0.0000, 0.1000, ")
    assert f", 0.7000, ... {MOST_ROWS + 1 - 16} more ..., 3.3000, " in said
    assert said.endswith("4.0000")
