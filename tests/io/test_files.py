"""The one door for files: what is refused on the way in, and what stays whole on the way out."""

import json
import os

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml

from study.cases.library import own_case
from study.errors import StudyError
from study.files import as_written, csv_text, read_file, replacing, write_file
from study.io import arrays_file, xml_file
from study.io.documents import DEEPEST, documents, parsed
from study.io.exact import read_exact
from study.io.limits import read_limits
from study.io.passages import passages
from study.io.recordings import read_samples
from study.io.sampled import breaches
from study.io.urdf import read_urdf
from study.problem import JointLimits, Problem


def refused(path, read=parsed):
    with pytest.raises(StudyError) as error:
        read(path)
    assert "\n" not in str(error.value)
    return str(error.value)


def written(tmp_path, name, text):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_a_pipe_and_an_endless_device_are_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    assert "no regular file" in refused(tmp_path / "pipe.yaml")
    (tmp_path / "zero.yaml").symlink_to("/dev/zero")
    assert "no regular file" in refused(tmp_path / "zero.yaml")


def test_a_file_above_the_limit_and_an_impossible_name_are_one_sentence(tmp_path):
    path = written(tmp_path, "big.csv", b"1" * 101)
    with pytest.raises(StudyError, match="larger than"):
        read_file(path, most=100)
    assert read_file(path, most=101) == b"1" * 101
    assert "too long" in refused(tmp_path / ("x" * 5000 + ".yaml"))


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path):
    path = written(tmp_path, "good.csv", "old")

    def fill_the_disk():
        with replacing(path) as part:
            part.write_text("half a li")
            raise OSError(28, "No space left on device")

    with pytest.raises(StudyError, match="No space"):
        fill_the_disk()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["good.csv"]


def test_a_new_file_takes_the_old_ones_place_rights_and_link(tmp_path):
    path = written(tmp_path, "good.csv", "old")
    path.chmod(0o640)
    (tmp_path / "link.csv").symlink_to(path)
    write_file(tmp_path / "link.csv", "new")
    assert (tmp_path / "link.csv").is_symlink()
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    with pytest.raises(StudyError, match="exists already"):
        write_file(path, "newer", overwrite=False)


def test_a_spreadsheet_takes_no_name_for_a_formula():
    names = ["=cmd|' /C calc'!A0", "@sum", "-2+3", "+x", "plain", "-0.5", "+1e-3", ""]
    cells = csv_text([names]).strip()
    assert cells.split(",")[0].strip('"').startswith("'=")
    assert [as_written(cell) for cell in ["'=a", "'plain", "a"]] == ["=a", "'plain", "a"]
    assert ",-0.5,+1e-3," in cells


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    {
        "double key in YAML": ("a.yaml", "limits: 1\nlimits: 2\n", "key 'limits' stands twice"),
        "double key in JSON": ("a.json", '{"a": 1, "a": 2}', "key 'a' stands twice"),
        "not a number in JSON": ("a.json", '{"a": NaN}', "NaN is no number"),
        "deep JSON": ("a.json", "[" * 100_000, "nested too deeply"),
        "deep YAML": ("a.yaml", "[" * (DEEPEST + 2) + "]" * (DEEPEST + 2), "nested too deeply"),
        "a number of thousands of digits": (
            "a.yaml",
            "a:\n- 0x" + "F" * 5000,
            "at line 2: a whole number has thousands of digits",
        ),
        "digits": ("a.json", "1" * 5000, "cannot be read"),
        "digits in YAML": ("a.yaml", "a: " + "1" * 5000, "cannot be read"),
        "bomb": (
            "a.yaml",
            "a0: &a0 [x,x,x,x,x,x,x,x,x,x]\n"
            + "".join(f"a{k}: &a{k} [{','.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 9)),
            "stands for too many values",
        ),
        "tag": ("a.yaml", "a: !!python/object:os.system {}\n", "could not determine a constructor"),
        **{
            f"tag on {text}": ("a.yaml", f"a:\n- {text}\n", f"is not valid YAML at line 2: {said}")
            for text, said in {
                "!!float ''": "'' cannot be read as float",
                "!!int +": "'+' cannot be read as int",
                "!!bool maybe": "'maybe' cannot be read as bool",
                "!!timestamp x": "'x' cannot be read as timestamp",
                "!degrees x": "'x' cannot be read as degrees",
                "2020-99-99": "'2020-99-99' cannot be read as timestamp",
            }.items()
        },
        "two documents": ("a.yaml", "a: 1\n---\nb: 2\n", "holds 2 documents"),
    }.values(),
)
def test_documents_that_are_refused(tmp_path, name, text, sentence):
    assert sentence in refused(written(tmp_path, name, text))


def test_documents_that_are_read(tmp_path):
    rows = [[1.0, 2.0]] * 3
    assert parsed(written(tmp_path, "shared.yaml", yaml.safe_dump({"rows": rows, "again": rows}))) == {
        "rows": rows,
        "again": rows,
    }
    assert documents(written(tmp_path, "many.yaml", "---\na: 1\n---\na: 2\n---\n")) == [{"a": 1}, {"a": 2}]
    assert parsed(written(tmp_path, "angle.yaml", "a: !degrees 180.0\nb: !radians 2\n")) == {"a": np.pi, "b": 2.0}


@pytest.mark.parametrize(
    "text",
    [
        b'time,a\n0,"' + b"1" * 200_000 + b'"\n1,2\n',
        b"time,a\n0,1e400\n1,2\n",
        b"time\ta\n0\t524289e319\n1\t.5\n",
        "a,b\n1,\ud7ff\n".encode("utf-16"),
    ],
)
def test_tables_that_are_refused(tmp_path, text):
    assert "file" in refused(written(tmp_path, "a.csv", text), read_samples)


@pytest.mark.parametrize(
    "content",
    [
        {"kind": []},
        {"kind": {}},
        {"kind": "parametric", "time": [[]], "position": [[]]},
        {"kind": "polynomial", "knots": [0, 10**400], "coefficients": [[[1]]], "waypoint_times": [0, 1]},
        {"kind": "polynomial", "knots": [0, 1], "coefficients": [[[1.0]] * 3000], "waypoint_times": [0, 1]},
    ],
)
def test_exact_files_that_are_refused(tmp_path, content):
    text = json.dumps({"format": "time-optimal-study trajectory 1", **content})
    assert "m.exact.json" in refused(written(tmp_path, "m.exact.json", text), read_exact)


@pytest.mark.parametrize("encoding", ["bogus", "utf-7", "idna", "rot13", "hex"])
def test_urdf_in_an_odd_encoding_is_one_sentence(tmp_path, encoding):
    text = f"<?xml version='1.0' encoding='{encoding}'?><robot name='r'/>"
    assert "a.urdf" in refused(written(tmp_path, "a.urdf", text), read_urdf)


@pytest.mark.parametrize(
    "entry",
    ["{max_velocity: true}", "{has_velocity_limits: 'false', max_velocity: 1}", f"{{max_velocity: {'9' * 400}}}"],
)
def test_limits_that_are_no_numbers_are_one_sentence(tmp_path, entry):
    path = written(tmp_path, "l.yaml", f"joint_limits:\n  elbow: {entry}\n")
    assert "joint 'elbow'" in refused(path, read_limits)


def archive(tmp_path, name, **arrays):
    np.savez_compressed(tmp_path / name, **arrays)
    return tmp_path / name


def test_a_small_archive_that_unpacks_to_more_than_is_read_is_one_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr(arrays_file, "MOST_BYTES", 10**6)
    assert "unpacked it is larger than" in refused(archive(tmp_path, "a.npz", q=np.zeros((10**5, 2))), read_samples)
    table = pa.table({"elbow": np.zeros(10**5), "wrist": np.zeros(10**5)})
    pq.write_table(table, tmp_path / "a.parquet")
    assert (tmp_path / "a.parquet").stat().st_size < 10_000
    assert "unpacked it is larger than" in refused(tmp_path / "a.parquet", read_samples)


def test_an_array_of_billions_of_empty_texts_is_one_sentence(tmp_path):
    head = "{'descr': '<U0', 'fortran_order': False, 'shape': (4000000000,), }".ljust(117).encode() + b"\n"
    (tmp_path / "a.npy").write_bytes(b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head)
    assert "unpacked it is larger than" in refused(tmp_path / "a.npy", read_samples)


def test_numbers_that_are_not_real_are_one_sentence(tmp_path):
    for kind in ("c16", "M8[s]", "S3"):
        path = archive(tmp_path, "a.npz", q=np.ones((3, 2)).astype(kind) if kind != "S3" else np.full((3, 2), b"a"))
        assert "no numbers" in refused(path, read_samples)
    path = archive(tmp_path, "m.npz", coefficients=np.ones((1, 2, 1), complex), knots=[0, 1], waypoint_times=[0, 1])
    assert "no real numbers" in refused(path, read_exact)


def test_a_damaged_text_in_a_table_is_one_sentence(tmp_path):
    pq.write_table(
        pa.table({"elbow": [0.0, 1.0], "said": ["abcdefgh", "b"]}), tmp_path / "a.parquet", compression="none"
    )
    content = (tmp_path / "a.parquet").read_bytes()
    path = written(tmp_path, "b.parquet", content.replace(b"abcdefgh", b"abcd\xe5fgh"))
    assert "no Parquet file that can be read" in refused(path, read_samples)


def test_samples_that_overflow_are_beyond_every_limit(tmp_path):
    path = written(tmp_path, "a.csv", "time,joint 1\n0,0\n1e-300,1e200\n1,1\n2,-1e308\n3,1e308\n")
    problem = Problem("p", np.array([[0.0], [1.0]]), JointLimits(np.ones(1), np.ones(1)))
    said = breaches(read_samples(path), problem, 0.0, "a.csv")
    assert [
        name
        for name in ("velocity", "acceleration")
        if any(f"{name} of joint 1 reaches inf" in sentence for sentence in said)
    ]
    knots = np.array([0.0, 1.0])
    with pytest.raises(StudyError, match="times the waypoints' span away"):
        passages(knots, np.array([[[0.0], [1e308]]]), problem.waypoints)


def test_a_pipe_beside_a_bag_and_in_its_place_is_one_sentence(tmp_path):
    pytest.importorskip("rosbags")
    os.mkfifo(tmp_path / "a.bag")
    assert "no regular file" in refused(tmp_path / "a.bag", read_samples)
    (tmp_path / "bag").mkdir()
    os.mkfifo(tmp_path / "bag" / "a.mcap")
    written(tmp_path, "bag/metadata.yaml", "rosbag2_bagfile_information: {}")
    assert "no regular file" in refused(tmp_path / "bag", read_samples)


XACRO = "<robot xmlns:xacro='http://ros.org/wiki/xacro' name='r'><joint name='${%s}' type='fixed'/></robot>"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("9**9**9", "has not expanded it after"),
        ("1 +", "xacro cannot expand it"),
        ("len([0] * 3 * 10**9)", "xacro cannot expand it"),
    ],
)
def test_macros_that_fail_or_never_end_are_one_sentence(tmp_path, monkeypatch, text, sentence):
    pytest.importorskip("xacro")
    monkeypatch.setattr(xml_file, "PATIENCE", 2.0 if "**9**" in text else 60.0)
    assert sentence in refused(written(tmp_path, "a.xacro", XACRO % text), read_urdf)


def test_a_sentence_is_one_line_whatever_others_say():
    assert str(StudyError("a file: first\n  second\r\n\x0bthird\u2028")) == "a file: first; second; third"


@pytest.mark.filterwarnings("error")
def test_waypoints_whose_span_overflows_are_refused_in_one_sentence_and_no_warning(tmp_path):
    written(tmp_path, "a.csv", "a,b\n1e308,0\n-1e308,1\n")
    with pytest.raises(StudyError, match="waypoint 1 is infinite or too large"):
        own_case({"units": "rad", "waypoints": "a.csv", "limits": {"velocity": 1}}, tmp_path / "case.yaml")
