import json

import numpy as np
import pytest

from study.errors import StudyError
from study.io.recordings import read_samples
from study.io.text import read_text

TWO = [[0.5, -1.25], [1.0, 2.0]]
MESSAGE = {
    "header": {"frame_id": ""},
    "joint_names": ["a", "b"],
    "points": [
        {"positions": [0.5, -1.25], "time_from_start": {"sec": 0, "nanosec": 0}},
        {"positions": [1.0, 2.0], "time_from_start": {"sec": 1, "nanosec": 500000000}},
    ],
}


@pytest.mark.parametrize(
    "text",
    {
        "plain": "0.5,-1.25\n1,2\n",
        "no last line end": "0.5,-1.25\n1,2",
        "carriage returns": "0.5,-1.25\r\n1,2\r\n",
        "old Mac": "0.5,-1.25\r1,2\r",
        "byte order mark": "\ufeff0.5,-1.25\n1,2\n",
        "semicolons and decimal commas": "0,5;-1,25\n1;2,0\n",
        "tabs and decimal commas": "0,5\t-1,25\n1,0\t2\n",
        "quoted decimal commas": '"0,5","-1,25"\n"1","2"\n',
        "blanks": "0.5   -1.25\n  1 2\n",
        "comments and empty lines": "# taught by hand\n\n0.5,-1.25\n   \n1,2\n",
        "spaces after commas": "0.5, -1.25\n1, 2\n",
        "exponents": "5e-1,-125E-2\n1e0,2.0e+0\n",
    }.values(),
)
def test_tables_as_people_send_them(tmp_path, text):
    path = tmp_path / "points.csv"
    path.write_bytes(text.encode())
    rows = read_samples(path)
    assert rows.positions.tolist() == TWO
    assert rows.names == ()
    assert not rows.si


def test_a_spreadsheet_in_utf_16(tmp_path):
    path = tmp_path / "points.txt"
    path.write_bytes("q 1\tq 2\r\n0,5\t-1,25\r\n1\t2\r\n".encode("utf-16"))
    assert read_samples(path).names == ("q 1", "q 2")
    assert read_samples(path).positions.tolist() == TWO


@pytest.mark.parametrize(
    "header", ["time", "t", "Time (s)", "time_from_start", "t [s]"], ids=["time", "t", "Time", "ros", "bracket"]
)
def test_a_column_of_times_is_checked_and_left_out(tmp_path, header):
    path = tmp_path / "points.csv"
    path.write_text(f'{header},"joint, 1",<b>"2"</b>\n0,0.5,-1.25\n1.5,1,2\n')
    rows = read_samples(path)
    assert rows.positions.tolist() == TWO
    assert rows.names == ("joint, 1", '<b>"2"</b>')


@pytest.mark.parametrize(
    ("text", "sentence"),
    {
        "times go back": ("time,a\n0,1\n2,2\n1,3\n", "times must increase, but row 3 has 1 s after 2 s"),
        "ragged": ("1,2\n3\n", "line 2: expected 2 columns as in the first line, got 1"),
        "words": ("1,2\n3,four\n", "line 2: expected a finite number, got 'four'"),
        "empty cell": ("1,2\n3,\n", "line 2: expected a finite number, got ''"),
        "not finite": ("1,2\n3,inf\n", "expected a finite number, got 'inf'"),
        "nothing": ("", "there are no waypoints"),
        "header only": ("a,b\n", "there are no waypoints"),
        "thousands": ("a;b\n1.234,5;2\n", "expected a finite number, got '1.234,5'"),
        "header too short": ("a\n1,2\n", "line 2: expected 1 columns"),
    }.values(),
)
def test_what_is_wrong_with_a_table_is_one_sentence(tmp_path, text, sentence):
    path = tmp_path / "points.csv"
    path.write_text(text)
    with pytest.raises(StudyError) as error:
        read_samples(path)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "wrapped", [MESSAGE, {"joint_trajectory": MESSAGE}, {"trajectory": {"joint_trajectory": MESSAGE}}]
)
@pytest.mark.parametrize("ending", ["json", "yaml"])
def test_a_joint_trajectory_gives_names_and_si_units(tmp_path, wrapped, ending):
    path = tmp_path / f"taught.{ending}"
    path.write_text(json.dumps(wrapped))
    rows = read_samples(path)
    assert rows.positions.tolist() == TWO
    assert rows.names == ("a", "b")
    assert rows.si


def test_a_joint_trajectory_without_times_is_waypoints_too(tmp_path):
    path = tmp_path / "taught.json"
    path.write_text(json.dumps({"joint_names": ["a"], "points": [{"positions": [1]}, {"positions": [2]}]}))
    assert read_samples(path).positions.tolist() == [[1.0], [2.0]]


@pytest.mark.parametrize("content", [TWO, {"waypoints": TWO}])
@pytest.mark.parametrize("ending", ["json", "yaml"])
def test_rows_in_yaml_and_json(tmp_path, content, ending):
    path = tmp_path / f"points.{ending}"
    path.write_text(json.dumps(content))
    assert read_samples(path).positions.tolist() == TWO


def test_yaml_numbers_that_yaml_takes_for_text(tmp_path):
    path = tmp_path / "points.yaml"
    path.write_text("- [1e-3, 2]\n- [1_000.5, 3]\n")
    np.testing.assert_array_equal(read_samples(path).positions, [[0.001, 2], [1000.5, 3]])


@pytest.mark.parametrize(
    ("text", "sentence"),
    {
        "short point": (
            '{"joint_names": ["a", "b"], "points": [{"positions": [1]}]}',
            "point 1 has 1 positions for 2 joints",
        ),
        "no positions": ('{"joint_names": ["a"], "points": [{"velocities": [1]}]}', "point 1 has no list of positions"),
        "no names": ('{"joint_names": [], "points": []}', "joints must have names"),
        "no points": ('{"joint_names": ["a"], "points": []}', "there are no waypoints"),
        "times go back": (
            '{"joint_names": ["a"], "points": [{"positions": [1], "time_from_start": {"sec": 2}},'
            '{"positions": [2], "time_from_start": {"sec": 1}}]}',
            "row 2 has 1 s after 2 s",
        ),
        "odd stamp": (
            '{"joint_names": ["a"], "points": [{"positions": [1], "time_from_start": "soon"}]}',
            "'time_from_start' must be {sec, nanosec}",
        ),
        "broken": ('{"joint_names": [', "not valid JSON at line 1"),
        "text": ('"hello"', "expected a list of waypoints"),
        "true is no number": ("[[true, 1]]", "expected a finite number, got 'True'"),
        "nested": ("[[[1]]]", "expected a finite number"),
        "flat": ("[1, 2]", "waypoint 1 must be a list of numbers"),
    }.values(),
)
def test_what_is_wrong_with_a_message_is_one_sentence(tmp_path, text, sentence):
    path = tmp_path / "taught.json"
    path.write_text(text)
    with pytest.raises(StudyError) as error:
        read_samples(path)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(StudyError, match="does not exist"):
        read_text(tmp_path / "nothing.csv")
    with pytest.raises(StudyError, match="cannot be read"):
        read_text(tmp_path)
    (tmp_path / "latin.csv").write_bytes("größe\n1\n".encode("latin-1"))
    with pytest.raises(StudyError, match="save it as UTF-8"):
        read_text(tmp_path / "latin.csv")
    (tmp_path / "zeros.csv").write_bytes(b"1,2\0")
    with pytest.raises(StudyError, match="zero bytes"):
        read_text(tmp_path / "zeros.csv")
