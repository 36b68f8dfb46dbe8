"""Inputs of hundreds of thousands of rows: the same numbers, and as exact a sentence, as for short ones."""

import numpy as np
import pytest
import yaml
from scipy.interpolate import CubicSpline

from study.errors import StudyError
from study.io import csv_file, documents, xml_file
from study.io import passages as passages_of
from study.io.recordings import read_samples
from study.io.table import plain_table, separator, table_lines
from study.io.waypoints import tidied
from study.trajectory import Trajectory

ROWS = 300_000
HEADER = "time," + ",".join(f"axis {j}" for j in range(7))


@pytest.fixture(scope="module")
def lines():
    """Lines of a table and the numbers in them, shape (ROWS, 8): times and seven joints."""
    cells = np.column_stack([np.arange(ROWS) * 4, np.random.default_rng(7).integers(-3_000_000, 3_000_000, (ROWS, 7))])
    text = [f"{row[0]}e-3," + ",".join(f"{k}e-6" for k in row[1:]) for row in cells.tolist()]
    values = np.array([[float(cell) for cell in line.split(",")] for line in text])
    return text, values


@pytest.fixture
def no_cells(monkeypatch):
    """Fail where a table is taken apart cell by cell."""
    monkeypatch.setattr(csv_file, "_by_lines", lambda *arguments: pytest.fail("read line by line"))


def test_a_long_recording_is_read_at_once_to_the_last_bit(tmp_path, lines, no_cells):
    path = tmp_path / "long.csv"
    path.write_text("\n".join([HEADER, *lines[0]]))
    samples = read_samples(path)
    assert np.array_equal(samples.times, lines[1][:, 0])
    assert np.array_equal(samples.positions, lines[1][:, 1:])
    assert samples.names == tuple(f"axis {j}" for j in range(7))


def test_an_error_deep_in_a_long_recording_names_its_line(tmp_path, lines):
    path = tmp_path / "long.csv"
    for spoilt, sentence in (("0.1,0,0,0,0,oops,0,0", "got 'oops'"), ("0.1,0,0", "expected 8 columns")):
        path.write_text("\n".join([HEADER, *lines[0][:20_000], spoilt, *lines[0][20_000:21_000]]))
        with pytest.raises(StudyError, match="line 20002: .*" + sentence):
            read_samples(path)


@pytest.mark.parametrize(
    "text",
    [
        "# t, a\n0,1\n1,2\n",
        "0,1\n1,2\n2,-3.5e-2\n",
        "t;a\n0;1\n\n1; 2\n",
        "a\n1\n2\n",
        "a b\n1 2\n  3   4\n",
        "# taught by hand\nt,a\n0,1\n1,2\n# by robot\n2,5\n",
        "t,a\r\n0,1\r\n1,1e-300\r\n",
    ],
)
def test_both_ways_of_reading_give_the_same(text, no_cells, request):
    at_once = csv_file.samples_from_csv(text, "here")
    patch = request.getfixturevalue("monkeypatch")
    patch.undo()
    patch.setattr(csv_file, "plain_table", lambda *arguments: None)
    by_lines = csv_file.samples_from_csv(text, "here")
    assert at_once.names == by_lines.names
    assert np.array_equal(at_once.positions, by_lines.positions)
    assert (at_once.times is None) == (by_lines.times is None)
    assert at_once.times is None or np.array_equal(at_once.times, by_lines.times)


@pytest.mark.parametrize("text", ["a,b\n1,x\n", "1,2\n1,inf\n", "1;2\n1,5;2\n", "1,2\n1\n", '"1",2\n3,4\n', ""])
def test_everything_else_is_left_to_the_slower_way(text):
    lines, _ = table_lines(text)
    assert plain_table(lines, separator(lines)) is None


@pytest.mark.parametrize("first", ["nan,1", ",", "inf,2"])
def test_a_first_line_without_numbers_or_names_is_no_row_of_numbers(first, monkeypatch):
    def outcome(read):
        try:
            samples = read(f"{first}\n1,2\n3,4\n", "here")
        except StudyError as error:
            return str(error)
        return samples.names, samples.positions.tolist()

    at_once = outcome(csv_file.samples_from_csv)
    monkeypatch.setattr(csv_file, "plain_table", lambda *arguments: None)
    assert at_once == outcome(csv_file.samples_from_csv)


def test_slow_drift_is_merged_by_the_distance_from_the_waypoint_kept():
    drift = np.concatenate([[0.0], np.arange(1, 9) * 0.4e-9, [1.0, 1.0, 0.5]])[:, None]
    result = tidied(drift, None, (), "here")
    assert result.kept.tolist() == [0, 3, 6, 9, 11]
    assert result.place.tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 4]


def test_a_yaml_text_is_parsed_once_for_all_who_ask(tmp_path, monkeypatch):
    calls, parse = [], yaml.parse
    monkeypatch.setattr(yaml, "parse", lambda *a, **k: calls.append(1) or parse(*a, **k))
    path = tmp_path / "parsed once.yaml"
    path.write_text("rows: [[1.5, 2.5]]\n")
    assert documents.parsed(path) == documents.parsed(path) == {"rows": [[1.5, 2.5]]}
    assert len(calls) == 1
    path.write_text("rows: [[1.5, 3.5]]\n")
    assert documents.parsed(path) == {"rows": [[1.5, 3.5]]}


def test_yaml_of_too_many_values_is_refused_with_the_way_out(tmp_path, monkeypatch):
    monkeypatch.setattr(documents, "MOST_STANDING", 50)
    path = tmp_path / "big.yaml"
    path.write_text("[" + "1, " * 39 + "1]\n")
    assert len(documents.parsed(path)) == 40
    path.write_text("[" + "1, " * 60 + "1]\n")
    with pytest.raises(StudyError, match="more than 50 values; JSON and CSV hold more"):
        documents.parsed(path)


def test_xml_has_a_size_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(xml_file, "MOST_BYTES", 100)
    path = tmp_path / "robot.urdf"
    path.write_text("<robot name='a'>" + " " * 100 + "</robot>")
    with pytest.raises(StudyError, match="larger than"):
        xml_file.read_xml(path)


def test_passages_of_many_waypoints_are_found_by_a_tree(monkeypatch):
    rng = np.random.default_rng(3)
    knots = np.append(0.0, np.cumsum(rng.uniform(0.1, 0.2, 400)))
    coefficients = np.moveaxis(CubicSpline(knots, np.cumsum(rng.normal(size=(401, 3)), axis=0)).c[::-1], 0, 1)
    times = np.sort(rng.uniform(0, knots[-1], 120))
    times[[0, -1]] = knots[[0, -1]]
    waypoints = Trajectory(knots, coefficients, times)(times)
    one_by_one = passages_of.passages(knots, coefficients, waypoints)
    monkeypatch.setattr(passages_of, "_LARGE", 1)
    assert np.allclose(passages_of.passages(knots, coefficients, waypoints), one_by_one, atol=1e-9)
    assert np.allclose(one_by_one, times, atol=1e-9)
